//! What is made of logs: statistics, a report, pictures.

pub mod dataset;
pub mod logged;
pub mod plot;
pub mod report;
pub mod statistics;
