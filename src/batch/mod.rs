//! Batches of runs: sweeps over seeds and options, and regression tests on fixed nets.

pub mod regress;
#[cfg(feature = "parquet")]
pub mod sweep;
