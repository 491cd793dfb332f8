//! What is made of logs: statistics, a report, pictures, files for other tools.

pub mod dataset;
pub mod export;
pub mod filter;
pub mod logged;
pub mod playback;
#[cfg(feature = "plot")]
pub mod plot;
pub mod report;
pub mod statistics;
mod style;
pub mod variants;
