//! Helpers that know nothing of traffic: units, numbers, threads.

pub mod double_double;
pub mod golden_section;
pub mod index;
pub mod limits;
pub mod remark;
pub mod threads;
pub mod units;
pub mod variants;
