//! Batches of runs: sweeps over seeds and options, regression tests on fixed nets, the runs that cut a conflict out, and those
//! that ask what would have happened otherwise.

pub mod extract;
pub mod pool;
pub mod rare;
pub mod regress;
pub mod sweep;
pub mod whatif;
