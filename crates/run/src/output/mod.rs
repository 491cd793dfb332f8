//! What a run writes: its log, its record, and files for other tools.

pub mod clips;
mod context;
mod csv_file;
pub mod earlier_log;
pub mod folder;
pub mod font;
pub mod formats;
pub mod input_hash;
pub mod log;
pub mod logged_measures;
pub mod net_faults_csv;
pub mod overlaps;
pub mod palette;
pub mod parquet_columns;
mod parquet_file;
mod place;
pub mod rank;
pub mod record;
pub mod sample_conflict;
pub mod schema;
mod series;
pub mod summary;
mod value;
