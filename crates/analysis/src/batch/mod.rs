//! Batches of runs: sweeps over seeds and options, regression tests on fixed nets, and the runs that cut a conflict out.

pub mod extract;
pub mod pool;
pub mod regress;
pub mod sweep;
