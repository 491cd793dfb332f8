//! Conflicts as GeoJSON (RFC 7946): a point for each, in degrees, with the columns of the log as its properties.

use std::path::Path;

use serde_json::{Map, Value as Json, json};

use super::map_point::{Frame, place};
use crate::output::schema::{Column, LoggedConflict, Value};
use crate::util::output_file::OutputFile;
use crate::{Error, Result};

/// A GeoJSON file that is being written.
pub struct GeoJson {
    file: OutputFile,
    columns: Vec<&'static Column>,
    has_any: bool,
}

impl GeoJson {
    /// Begins the file.
    ///
    /// # Errors
    /// [`Error::Value`] where places are not in degrees: the format knows nothing else.
    pub fn create(path: &Path, columns: Vec<&'static Column>, frame: Frame) -> Result<Self> {
        if frame == Frame::Metres {
            let why = "GeoJSON needs degrees, but the log has no lon and lat: its net has no projection that is known \
                       (geoparquet and gpkg keep the net's metres)";
            return Err(Error::Value(why.to_owned()));
        }
        let mut file = OutputFile::create(path)?;
        file.append(b"{\"type\":\"FeatureCollection\",\"features\":[")?;
        Ok(Self { file, columns, has_any: false })
    }

    /// Appends a conflict, on a line of its own.
    pub fn write(&mut self, conflict: &LoggedConflict) -> Result<()> {
        let value = |column: &Column| match (column.get)(conflict) {
            Value::Text("") => Json::Null,
            value => json!(value),
        };
        let properties = self.columns.iter().map(|column| (column.name.to_owned(), value(column)));
        let point = place(conflict, Frame::Degrees).map(|place| json!({"type": "Point", "coordinates": place}));
        let feature = json!({
            "type": "Feature",
            "id": conflict.id,
            "geometry": point,
            "properties": Json::Object(properties.collect::<Map<_, _>>()),
        });
        self.file.append(if self.has_any { b",\n" } else { b"\n" })?;
        self.has_any = true;
        self.file.append(feature.to_string().as_bytes())
    }

    /// Completes the file.
    pub fn finish(mut self) -> Result<()> {
        self.file.append(b"\n]}\n")?;
        self.file.finish()
    }
}
