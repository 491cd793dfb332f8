//! The file with each step of each conflict.

use serde::Serialize;

/// How the file with each step of each conflict is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum SeriesFormat {
    /// As text, while the run goes on.
    Csv,
    /// As Parquet, when the run ends.
    Parquet,
}

/// The file with each step of each conflict.
pub(super) const SERIES: &str = "series.csv";
/// The same as Parquet.
pub(super) const SERIES_PARQUET: &str = "series.parquet";
/// The same where it is asked for by the option's former name.
pub(super) const ENCOUNTERS: &str = "encounters.csv";
/// All of these.
pub const SERIES_FILES: [&str; 3] = [SERIES, SERIES_PARQUET, ENCOUNTERS];
