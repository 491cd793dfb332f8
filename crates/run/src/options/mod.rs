//! The settings of a run: those of the method, and those of its log.
//!
//! A TOML key or a Python keyword is the long option with underscores, and all three use the same parser
//! ([`RunOptions::from_settings`]).

mod named_values;
pub mod old_names;
mod series_format;
mod toml_file;
mod word;

use std::path::PathBuf;

use closecall::options::{ClipLevel, Options, duration};
use closecall::util::units::Second;
use serde::Serialize;

use crate::Result;
use series_format::{ENCOUNTERS, SERIES, SERIES_PARQUET};

pub use series_format::{SERIES_FILES, SeriesFormat};
pub use toml_file::OptionsFile;

/// The settings of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, clap::Args)]
pub struct RunOptions {
    /// Those of the method.
    #[command(flatten)]
    #[serde(flatten)]
    pub model: Options,
    /// Those of what is counted and written.
    #[command(flatten)]
    #[serde(flatten)]
    pub log: LogOptions,
}

/// What a run counts and writes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, clap::Args)]
#[command(next_help_heading = "Log")]
pub struct LogOptions {
    /// Types of the SUMO polygons that are static obstacles.
    #[arg(long, value_name = "TYPE,…", value_delimiter = ',')]
    pub obstacles: Vec<String>,
    /// Log only conflicts on the edges, lanes and junctions of this SUMO selection file.
    #[arg(long, value_name = "FILE")]
    pub filter: Option<PathBuf>,
    /// Count traffic and log conflicts only after this time from the begin, in s.
    #[arg(long, value_name = "S", default_value_t = 0.0, value_parser = duration)]
    pub warmup: Second,
    /// Also write series.csv, with a row per step of each logged conflict; `--log-series=parquet` writes series.parquet.
    #[arg(long, value_name = "FORMAT", num_args = 0..=1, require_equals = true, default_missing_value = "csv")]
    pub log_series: Option<SeriesFormat>,
    /// The former name of `log_series`; the file is then called encounters.csv.
    #[arg(long, hide = true)]
    #[serde(skip)]
    pub log_encounters: bool,
    /// Record the road users around each conflict of at least this severity in clips.jsonl.gz: `closecall clip` and `closecall
    /// show` play it.
    #[arg(long, value_enum, value_name = "SEVERITY", default_value_t)]
    #[serde(skip_serializing_if = "ClipLevel::is_default")]
    pub log_clips: ClipLevel,
}

impl LogOptions {
    /// The name of the file with each step of each conflict; none where it is not wanted.
    pub(crate) fn series_file(&self) -> Option<&'static str> {
        match self.log_series {
            Some(SeriesFormat::Csv) => Some(SERIES),
            Some(SeriesFormat::Parquet) => Some(SERIES_PARQUET),
            None => self.log_encounters.then_some(ENCOUNTERS),
        }
    }
}

impl RunOptions {
    /// Sets what only a TOML file can: its tables of types and drivers.
    pub fn set_tables(&mut self, file: OptionsFile) {
        self.model.types = file.types;
        self.model.driver_options = file.driver;
    }

    /// Checks that the options are consistent.
    ///
    /// # Errors
    /// Those of [`Options::checked`].
    pub fn checked(self) -> Result<Self> {
        Ok(Self { model: self.model.checked()?, ..self })
    }
}

impl From<Options> for RunOptions {
    fn from(model: Options) -> Self {
        Self { model, ..Self::default() }
    }
}
