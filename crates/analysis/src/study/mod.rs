//! Error against run time: of a scenario, and what a page and a chart of any such study share.

pub mod error_over_time;
pub mod machine;
pub mod number;
pub mod pareto;
pub mod scenario;
