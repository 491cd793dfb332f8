//! Log analysis: statistics, a report, pictures, files for other tools; and many runs.
//!
//! ```
//! use closecall_analysis::study::number::number;
//!
//! assert_eq!(number(0.012_34), "0.0123");
//! ```
//!
//! | module | what is in it |
//! |---|---|
//! | [`logged`] | logs read back |
//! | [`filter`] | how conflicts are selected, for all log readers |
//! | [`statistics`] | rates, quantiles, extremes, comparisons |
//! | [`dataset`], [`variants`] | conflicts of many runs, grouped by settings |
//! | [`report`], [`plot`], [`playback`] | the page, charts, clips as pictures |
//! | [`export`], [`rows_csv`] | files for other tools; tables |
//! | [`batch`] | sweeps, regression tests, conflicts extracted as scenarios |
//! | [`study`] | error against run time of a scenario |

pub mod batch;
pub mod dataset;
mod error;
pub mod export;
pub mod filter;
pub mod logged;
pub mod playback;
pub mod plot;
pub mod report;
pub mod rows_csv;
pub mod statistics;
pub mod study;
mod style;
pub mod variants;

pub use error::{Error, Result};
