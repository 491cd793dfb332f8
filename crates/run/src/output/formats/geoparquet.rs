//! Conflicts as GeoParquet 1.1: the columns of the log, and a column of points. Its metadata is written here, by hand, until
//! the crates `geoparquet` and `parquet` share a version of Arrow.

use std::path::Path;

use serde_json::{Value as Json, json};

use super::map_point::{Frame, place, well_known};
use crate::Result;
use crate::output::parquet_file::ParquetFile;
use crate::output::schema::{Column, LoggedConflict};

/// The column of points.
const GEOMETRY: &str = "geometry";

/// A GeoParquet file that is being written.
pub struct GeoParquet {
    file: ParquetFile,
    frame: Frame,
}

impl GeoParquet {
    /// Begins the file.
    pub fn create(path: &Path, columns: Vec<&'static Column>, frame: Frame) -> Result<Self> {
        let geometry = match frame {
            Frame::Degrees => |conflict: &LoggedConflict| place(conflict, Frame::Degrees).map(well_known),
            Frame::Metres => |conflict: &LoggedConflict| place(conflict, Frame::Metres).map(well_known),
        };
        let file = ParquetFile::create_with(path, columns.into_iter().copied(), Some((GEOMETRY, geometry)))?;
        Ok(Self { file, frame })
    }

    /// Appends a conflict.
    pub fn write(&mut self, conflict: LoggedConflict) -> Result<()> {
        self.file.write_row(conflict)
    }

    /// Completes the file.
    pub fn finish(mut self) -> Result<()> {
        let mut column = json!({"encoding": "WKB", "geometry_types": ["Point"]});
        if self.frame == Frame::Metres {
            // Without this key, places are in degrees.
            column["crs"] = Json::Null;
        }
        let metadata = json!({"version": "1.1.0", "primary_column": GEOMETRY, "columns": {GEOMETRY: column}});
        self.file.describe("geo", metadata.to_string());
        self.file.finish()
    }
}
