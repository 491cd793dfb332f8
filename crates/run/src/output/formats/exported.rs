//! A log as a file of another tool.

use std::path::Path;

use super::geojson::GeoJson;
use super::geoparquet::GeoParquet;
use super::gpkg::GeoPackage;
use super::map_point::Frame;
use super::poi::Poi;
use super::ssm::Ssm;
use crate::Result;
use crate::output::schema::{Column, LoggedConflict};

/// A format that a log can be exported to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ExportFormat {
    /// GeoJSON: points in degrees, for web maps and QGIS.
    #[value(name = "geojson")]
    GeoJson,
    /// GeoParquet: points and typed columns, for GeoPandas, DuckDB and QGIS.
    #[value(name = "geoparquet")]
    GeoParquet,
    /// GeoPackage: points and typed columns, for QGIS and other GIS.
    #[value(name = "gpkg")]
    GeoPackage,
    /// Points of interest, for sumo-gui (--additional-files) and netedit.
    Poi,
    /// The XML of SUMO's SSM device.
    Ssm,
}

impl ExportFormat {
    /// The usual ending of its files.
    pub fn ending(self) -> &'static str {
        match self {
            Self::GeoJson => "geojson",
            Self::GeoParquet => "geo.parquet",
            Self::GeoPackage => "gpkg",
            Self::Poi => "poi.xml",
            Self::Ssm => "ssm.xml",
        }
    }
}

/// A log that is being exported. Dropped before [`Exported::finish`], it leaves nothing behind.
pub enum Exported {
    /// As GeoJSON.
    GeoJson(GeoJson),
    /// As GeoParquet.
    GeoParquet(Box<GeoParquet>),
    /// As a GeoPackage.
    GeoPackage(Box<GeoPackage>),
    /// As points of interest.
    Poi(Poi),
    /// As the SSM device writes it.
    Ssm(Ssm),
}

impl Exported {
    /// Begins the file of a log with these columns and this first conflict.
    ///
    /// # Errors
    /// [`crate::Error::File`] that names what cannot be written; [`crate::Error::Value`] where the format cannot hold the log.
    pub fn create(
        path: &Path,
        format: ExportFormat,
        columns: Vec<&'static Column>,
        first: Option<&LoggedConflict>,
    ) -> Result<Self> {
        let frame = Frame::of(first);
        Ok(match format {
            ExportFormat::GeoJson => Self::GeoJson(GeoJson::create(path, columns, frame)?),
            ExportFormat::GeoParquet => Self::GeoParquet(Box::new(GeoParquet::create(path, columns, frame)?)),
            ExportFormat::GeoPackage => Self::GeoPackage(Box::new(GeoPackage::create(path, columns, frame)?)),
            ExportFormat::Poi => Self::Poi(Poi::create(path, columns)?),
            ExportFormat::Ssm => Self::Ssm(Ssm::create(path)?),
        })
    }

    /// Appends a conflict.
    ///
    /// # Errors
    /// [`crate::Error::File`] or [`crate::Error::Content`] that names the file.
    pub fn write(&mut self, conflict: LoggedConflict) -> Result<()> {
        match self {
            Self::GeoJson(file) => file.write(&conflict),
            Self::GeoParquet(file) => file.write(conflict),
            Self::GeoPackage(file) => file.write(&conflict),
            Self::Poi(file) => file.write(&conflict),
            Self::Ssm(file) => file.write_logged(&conflict),
        }
    }

    /// Completes the file.
    ///
    /// # Errors
    /// As [`Exported::write`].
    pub fn finish(self) -> Result<()> {
        match self {
            Self::GeoJson(file) => file.finish(),
            Self::GeoParquet(file) => file.finish(),
            Self::GeoPackage(file) => file.finish(),
            Self::Poi(file) => file.finish(),
            Self::Ssm(file) => file.finish(),
        }
    }
}
