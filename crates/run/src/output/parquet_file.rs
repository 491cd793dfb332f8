//! A Parquet file with columns of the log, written as its rows come. It is there, whole, when it is finished.

use std::fmt;
use std::path::{Path, PathBuf};

use parquet::data_type::{ByteArray, ByteArrayType};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::writer::SerializedFileWriter;

use super::parquet_columns::{binary, fill, of_log, properties, schema, write_optional};
use super::schema::{Column, LoggedConflict};
use crate::Result;
use crate::util::output_file::OutputFile;
use crate::util::parquet_column::unreadable;

/// Rows of a row group, which are in memory until it is full: some 20 MB.
const GROUP: usize = 1 << 14;

/// A Parquet file that is being written. Dropped before [`ParquetFile::finish`], it leaves nothing behind.
pub(super) struct ParquetFile {
    path: PathBuf,
    columns: Vec<Column>,
    writer: SerializedFileWriter<OutputFile>,
    /// A column that is not of the log, after the others.
    added: Option<(&'static str, Binary)>,
    /// Those of the row group under way.
    rows: Vec<LoggedConflict>,
}

/// Bytes that a column has of a conflict.
pub(super) type Binary = fn(&LoggedConflict) -> Option<Vec<u8>>;

impl fmt::Debug for ParquetFile {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("ParquetFile").field("path", &self.path).finish_non_exhaustive()
    }
}

impl ParquetFile {
    pub fn create(path: &Path, columns: impl Iterator<Item = Column>) -> Result<Self> {
        Self::create_with(path, columns, None)
    }

    /// With a column of bytes after those of the log.
    pub(crate) fn create_with(
        path: &Path,
        columns: impl Iterator<Item = Column>,
        added: Option<(&'static str, Binary)>,
    ) -> Result<Self> {
        let columns = columns.collect::<Vec<_>>();
        let file = OutputFile::create(path)?;
        let writer = schema(columns.iter().map(of_log).chain(added.iter().map(|(name, _)| binary(name))))
            .and_then(|schema| SerializedFileWriter::new(file, schema, properties()));
        let writer = writer.map_err(|error| unreadable(path, &error))?;
        Ok(Self { path: path.to_owned(), columns, writer, added, rows: Vec::new() })
    }

    /// Adds a key to the file's metadata.
    pub(crate) fn describe(&mut self, key: &str, value: String) {
        self.writer.append_key_value_metadata(KeyValue::new(key.to_owned(), value));
    }

    pub(crate) fn write_row(&mut self, row: LoggedConflict) -> Result<()> {
        self.rows.push(row);
        if self.rows.len() < GROUP {
            return Ok(());
        }
        self.write_group().map_err(|error| unreadable(&self.path, &error))
    }

    fn write_group(&mut self) -> std::result::Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        for of_log in &self.columns {
            if let Some(mut column) = group.next_column()? {
                fill(&mut column, &self.rows, of_log)?;
                column.close()?;
            }
        }
        if let Some((_, of)) = self.added
            && let Some(mut column) = group.next_column()?
        {
            write_optional::<ByteArrayType>(&mut column, self.rows.iter().map(|row| of(row).map(ByteArray::from)))?;
            column.close()?;
        }
        self.rows.clear();
        group.close().map(drop)
    }

    /// Writes what is left and completes the file.
    pub fn finish(mut self) -> Result<()> {
        let written = if self.rows.is_empty() { Ok(()) } else { self.write_group() };
        let file = written.and_then(|()| self.writer.into_inner());
        file.map_err(|error| unreadable(&self.path, &error))?.finish()
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    use super::*;
    use crate::output::schema::{COLUMNS, ColumnType, Value};

    /// A row that has this number in each of its numbers.
    fn row(number: u64) -> LoggedConflict {
        let cell = |place: usize| {
            Ok(match (COLUMNS[place].name, COLUMNS[place].column_type) {
                ("kind", _) => Value::Text("side"),
                ("severity", _) => Value::Text("serious"),
                (_, ColumnType::Count) => Value::Count(number),
                (_, ColumnType::Number) => Value::Number(number as f64),
                (_, ColumnType::Flag) => Value::Flag(true),
                (name, ColumnType::Text) => Value::Text(name),
            })
        };
        LoggedConflict::from_cells(cell).unwrap()
    }

    #[test]
    fn every_row_is_there_across_row_groups() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows.parquet");
        for rows in [0, 3, GROUP as u64 + 10] {
            let columns = COLUMNS.iter().filter(|column| ["id", "lane", "gap"].contains(&column.name));
            let mut file = ParquetFile::create(&path, columns.copied()).unwrap();
            (0..rows).for_each(|number| file.write_row(row(number)).unwrap());
            assert!(file.rows.len() < GROUP);
            file.finish().unwrap();
            let read = SerializedFileReader::new(fs::File::open(&path).unwrap()).unwrap();
            let numbers = read.get_row_iter(None).unwrap().zip(0..).map(|(row, number)| {
                let row = row.unwrap().into_columns().into_iter().map(|(_, field)| field).collect::<Vec<_>>();
                assert_eq!(row, [Field::Long(number), Field::Double(number as f64), Field::Str("lane".to_owned())]);
            });
            assert_eq!(numbers.count() as u64, rows);
        }
    }

    #[test]
    fn a_file_that_is_not_finished_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let mut file = ParquetFile::create(&folder.path().join("rows.parquet"), COLUMNS.iter().copied()).unwrap();
        file.write_row(row(1)).unwrap();
        drop(file);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
