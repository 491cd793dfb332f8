//! Conflicts as a GeoPackage (OGC 12-128r19, version 1.3): a layer of points with the columns of the log, in SQLite.

use std::fs::File;
use std::path::{Path, PathBuf};

use rusqlite::types::{ToSqlOutput, ValueRef};
use rusqlite::{Connection, params};

use super::map_point::{Frame, place, well_known};
use crate::output::schema::{Column, ColumnType, LoggedConflict, Value};
use crate::util::output_file::{OutputFile, folder_of};
use crate::{Error, Result};

/// The tables that every GeoPackage has, empty but for its reference systems. Nothing in them tells the time of writing.
const TABLES: &str = r#"
PRAGMA application_id = 0x47504B47;
PRAGMA user_version = 10300;
PRAGMA journal_mode = OFF;
PRAGMA synchronous = OFF;
CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT NOT NULL, srs_id INTEGER NOT NULL PRIMARY KEY,
    organization TEXT NOT NULL, organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);
INSERT INTO gpkg_spatial_ref_sys VALUES
    ('Undefined cartesian SRS', -1, 'NONE', -1, 'undefined', 'the metres of the net'),
    ('Undefined geographic SRS', 0, 'NONE', 0, 'undefined', NULL),
    ('WGS 84 geodetic', 4326, 'EPSG', 4326, 'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563,
        AUTHORITY["EPSG","7030"]],AUTHORITY["EPSG","6326"]],PRIMEM["Greenwich",0,AUTHORITY["EPSG","8901"]],
        UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4326"]]', NULL);
CREATE TABLE gpkg_contents (table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT UNIQUE,
    description TEXT DEFAULT '', last_change DATETIME NOT NULL, min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE,
    srs_id INTEGER REFERENCES gpkg_spatial_ref_sys(srs_id));
CREATE TABLE gpkg_geometry_columns (table_name TEXT NOT NULL UNIQUE REFERENCES gpkg_contents(table_name),
    column_name TEXT NOT NULL, geometry_type_name TEXT NOT NULL, srs_id INTEGER NOT NULL, z TINYINT NOT NULL,
    m TINYINT NOT NULL, PRIMARY KEY (table_name, column_name));
"#;

/// A GeoPackage that is being written: beside its place first, as SQLite writes here and there.
pub struct GeoPackage {
    out: OutputFile,
    path: PathBuf,
    database: Connection,
    draft: tempfile::TempPath,
    columns: Vec<&'static Column>,
    insert: String,
    srs: i32,
    frame: Frame,
}

impl GeoPackage {
    /// Begins the file.
    pub fn create(path: &Path, columns: Vec<&'static Column>, frame: Frame) -> Result<Self> {
        let out = OutputFile::create(path)?;
        let draft = tempfile::Builder::new().prefix(".closecall-").tempfile_in(folder_of(path));
        let draft = draft.map_err(|source| Error::file(path, source))?.into_temp_path();
        let srs = if frame == Frame::Degrees { 4326 } else { -1 };
        let typed = columns.iter().map(|column| format!(", \"{}\" {}", column.name, sql_type(column.column_type)));
        let layer = format!(
            "{TABLES}
             CREATE TABLE conflicts (fid INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, geom POINT{});
             INSERT INTO gpkg_contents VALUES
                 ('conflicts', 'features', 'conflicts', '', '1970-01-01T00:00:00.000Z', NULL, NULL, NULL, NULL, {srs});
             INSERT INTO gpkg_geometry_columns VALUES ('conflicts', 'geom', 'POINT', {srs}, 0, 0);
             BEGIN;",
            typed.collect::<String>()
        );
        let database = Connection::open(&draft).and_then(|database| {
            database.execute_batch(&layer)?;
            Ok(database)
        });
        let database = database.map_err(|error| Error::content(path, error.to_string()))?;
        let insert = format!("INSERT INTO conflicts VALUES (NULL, ?{})", ", ?".repeat(columns.len()));
        Ok(Self { out, path: path.to_owned(), database, draft, columns, insert, srs, frame })
    }

    /// Appends a conflict.
    pub fn write(&mut self, conflict: &LoggedConflict) -> Result<()> {
        let geometry = place(conflict, self.frame).map(|place| self.geometry(place));
        let geometry = geometry.as_ref().map_or(ValueRef::Null, |bytes| ValueRef::Blob(bytes));
        let values = self.columns.iter().map(|column| sql_value((column.get)(conflict)));
        let row = std::iter::once(geometry).chain(values).map(ToSqlOutput::Borrowed);
        let inserted = self
            .database
            .prepare_cached(&self.insert)
            .and_then(|mut insert| insert.execute(rusqlite::params_from_iter(row)));
        inserted.map(drop).map_err(|error| self.unwritable(&error))
    }

    /// A point as a GeoPackage has it: a header, then well-known binary.
    fn geometry(&self, place: [f64; 2]) -> Vec<u8> {
        // Version 1; little-endian, no envelope, not empty.
        let mut bytes = b"GP\x00\x01".to_vec();
        bytes.extend(self.srs.to_le_bytes());
        bytes.extend(well_known(place));
        bytes
    }

    /// Completes the file.
    pub fn finish(self) -> Result<()> {
        let [x, y] = if self.frame == Frame::Degrees { ["lon", "lat"] } else { ["x", "y"] };
        let bounds = format!(
            "UPDATE gpkg_contents SET (min_x, min_y, max_x, max_y) =
             (SELECT min({x}), min({y}), max({x}), max({y}) FROM conflicts)"
        );
        let committed = self.database.execute(&bounds, params![]).and_then(|_| self.database.execute_batch("COMMIT"));
        committed.map_err(|error| self.unwritable(&error))?;
        let Self { mut out, path, database, draft, .. } = self;
        drop(database);
        let copied = File::open(&draft).and_then(|mut written| std::io::copy(&mut written, &mut out));
        copied.map_err(|source| Error::file(&path, source))?;
        out.finish()
    }

    fn unwritable(&self, error: &rusqlite::Error) -> Error {
        Error::content(&self.path, error.to_string())
    }
}

fn sql_type(column_type: ColumnType) -> &'static str {
    match column_type {
        ColumnType::Count => "INTEGER",
        ColumnType::Text => "TEXT",
        ColumnType::Number => "DOUBLE",
        ColumnType::Flag => "BOOLEAN",
    }
}

fn sql_value(value: Value<'_>) -> ValueRef<'_> {
    match value {
        Value::Count(count) => ValueRef::Integer(count as i64),
        Value::Number(number) => ValueRef::Real(number),
        Value::Flag(flag) => ValueRef::Integer(flag.into()),
        Value::Text("") | Value::Missing => ValueRef::Null,
        Value::Text(text) => ValueRef::Text(text.as_bytes()),
    }
}
