//! What has nothing to do with traffic: units, numbers, memory, threads, files.

pub(crate) mod decimal;
pub mod double_double;
pub(crate) mod golden_section;
pub(crate) mod input_file;
pub mod threads;
pub mod units;
