//! A column of a Parquet file, batch by batch.

use std::fs::File;
use std::path::Path;

use parquet::basic::Compression;
use parquet::column::reader::ColumnReaderImpl;
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};

use crate::Error;
use crate::util::panics::{self, caught};

/// The values of a batch; none where the file has null.
pub struct Batch<T: DataType> {
    reader: ColumnReaderImpl<T>,
    values: Vec<Option<T::T>>,
    /// What the library reads into: the values that are not null, and which are.
    present: Vec<T::T>,
    levels: Vec<i16>,
}

impl<T: DataType> Batch<T> {
    /// The column that the reader reads; no batch is read yet.
    pub fn new(reader: ColumnReaderImpl<T>) -> Self {
        Self { reader, values: Vec::new(), present: Vec::new(), levels: Vec::new() }
    }

    /// Reads the next rows; returns how many were read.
    ///
    /// # Errors
    /// Those of the reader.
    pub fn read(&mut self, rows: usize) -> Result<usize, ParquetError> {
        let Self { reader, values, present, levels } = self;
        present.clear();
        levels.clear();
        let (read, ..) = reader.read_records(rows, Some(levels), None, present)?;
        let mut present = present.drain(..);
        values.clear();
        // A column that cannot be null has no levels.
        values.extend((0..read).map(|row| if levels.get(row) == Some(&0) { None } else { present.next() }));
        Ok(read)
    }

    /// Passes over the next rows; returns over how many.
    ///
    /// # Errors
    /// Those of the reader.
    pub fn skip(&mut self, rows: usize) -> Result<usize, ParquetError> {
        self.reader.skip_records(rows)
    }

    /// The value in a row of the batch.
    pub fn get(&self, row: usize) -> Option<&T::T> {
        self.values.get(row)?.as_ref()
    }
}

/// Reads a part of a Parquet file. On damaged files the library panics too.
///
/// # Errors
/// [`Error::Content`] for the library's error or panic.
pub fn guarded<T>(path: &Path, read: impl FnOnce() -> Result<T, ParquetError>) -> crate::Result<T> {
    match caught(read) {
        Ok(read) => read.map_err(|error| unreadable(path, &error)),
        Err(_) => Err(Error::content(path, format!("it is damaged: {}", panics::last()))),
    }
}

/// Opens a Parquet file.
///
/// # Errors
/// [`Error::Content`] where the file is not Parquet, or is compressed in a way that cannot be read.
pub fn open(path: &Path, file: File) -> crate::Result<SerializedFileReader<File>> {
    let file = guarded(path, || SerializedFileReader::new(file))?;
    let columns = file.metadata().row_groups().iter().flat_map(|group| group.columns());
    let is_read =
        |it: &Compression| matches!(it, Compression::UNCOMPRESSED | Compression::SNAPPY | Compression::GZIP(_));
    match columns.map(|column| column.compression()).find(|compression| !is_read(compression)) {
        Some(compression) => {
            let compression = compression.to_string().to_lowercase();
            let message = format!(
                "it is compressed by {compression}; closecall reads Parquet without compression, or with snappy or gzip \
                 (of SUMO: --output.compression)"
            );
            Err(Error::content(path, message))
        }
        None => Ok(file),
    }
}

/// The library's error in one line.
pub fn unreadable(path: &Path, error: &ParquetError) -> Error {
    Error::content(path, error.to_string().lines().map(str::trim).collect::<Vec<_>>().join(" "))
}
