//! Files: opening and reading them, and writing them whole.

pub mod csv_safe;
pub mod decimal;
pub mod header;
pub mod input_file;
pub mod output_file;
pub mod panics;
pub mod parquet_column;
pub mod parquet_rows;
pub mod parquet_values;
mod read_ahead;
pub mod xml_text;
