//! Helpers that know nothing of traffic: units, numbers, threads, files.

pub(crate) mod csv_safe;
pub(crate) mod decimal;
pub mod double_double;
pub(crate) mod golden_section;
pub(crate) mod header;
pub(crate) mod input_file;
pub mod limits;
pub mod output_file;
pub mod panics;
#[cfg(feature = "parquet")]
pub mod parquet_column;
#[cfg(feature = "parquet")]
pub(crate) mod parquet_rows;
#[cfg(feature = "parquet")]
pub(crate) mod parquet_values;
mod read_ahead;
pub mod threads;
pub mod units;
pub mod xml_text;
