//! The rows of a Parquet file, of which only the wanted columns are read: each as texts or as numbers, whatever the file
//! stores them as. What is neither is refused by the column's name.

use std::fs::File;
use std::path::{Path, PathBuf};

use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};

use super::header::Wanted;
use super::parquet_column::{self, guarded};
use super::parquet_values::{Column, Meaning, Value};
use crate::{Error, Result};

/// Rows in memory at once.
const BATCH: usize = 4096;

/// A file being read.
pub(crate) struct ParquetRows {
    path: PathBuf,
    file: SerializedFileReader<File>,
    /// The columns that are read: the place of each among the leaves of the file, and what its values are.
    wanted: Vec<(usize, Wanted, Meaning)>,
    columns: Vec<Column>,
    next_group: usize,
    /// Rows of the group that are not in the batch or before it.
    left: usize,
    /// Rows of the batch, and how many of them were used.
    batch: usize,
    used: usize,
    /// Rows of the batches before.
    before: u64,
}

impl ParquetRows {
    /// Opens a file; no column is wanted yet.
    ///
    /// # Errors
    /// Those of [`parquet_column::open`].
    pub fn open(path: &Path, file: File) -> Result<Self> {
        let file = parquet_column::open(path, file)?;
        Ok(Self {
            path: path.to_owned(),
            file,
            wanted: Vec::new(),
            columns: Vec::new(),
            next_group: 0,
            left: 0,
            batch: 0,
            used: 0,
            before: 0,
        })
    }

    /// The names of the columns.
    pub fn names(&self) -> Vec<String> {
        let fields = self.file.metadata().file_metadata().schema_descr().root_schema().get_fields();
        fields.iter().map(|field| field.name().to_owned()).collect()
    }

    /// Wants these columns, by their places among the names.
    ///
    /// # Errors
    /// [`Error::Content`] that names a column whose values are neither texts nor numbers.
    pub(crate) fn want(&mut self, columns: &[(usize, Wanted)]) -> Result<()> {
        let schema = self.file.metadata().file_metadata().schema_descr();
        let fields = schema.root_schema().get_fields();
        for (place, wanted) in columns {
            let Some(field) = fields.get(*place) else { continue };
            let leaf = schema.columns().iter().position(|leaf| leaf.path().parts() == [field.name()]);
            let found = leaf.map_or(Err("lists or structs".to_owned()), |leaf| {
                Meaning::of(&schema.column(leaf)).map(|meaning| (leaf, *wanted, meaning))
            });
            self.wanted.push(found.map_err(|what| {
                let message = format!("column {} holds {what}; texts or numbers are needed", field.name());
                Error::content(&self.path, message)
            })?);
        }
        Ok(())
    }

    /// Whether there is a row that was not used; the next batch is read where all of the last were.
    ///
    /// # Errors
    /// [`Error::Content`] where the file is damaged.
    pub(crate) fn has_row(&mut self) -> Result<bool> {
        if self.used < self.batch {
            return Ok(true);
        }
        let path = self.path.clone();
        guarded(&path, || self.next_batch())
    }

    /// The number of the row, from 1.
    pub fn number(&self) -> u64 {
        self.before + self.used as u64 + 1
    }

    /// The row's value of one of the wanted columns.
    #[inline]
    pub fn value(&self, column: usize) -> Value<'_> {
        self.columns.get(column).map_or(Value::Missing, |column| column.value(self.used))
    }

    /// Passes on to the next row.
    pub(crate) fn use_row(&mut self) {
        self.used += 1;
    }

    fn next_batch(&mut self) -> std::result::Result<bool, ParquetError> {
        while self.used == self.batch {
            if self.left == 0 && !self.open_group()? {
                return Ok(false);
            }
            self.before += self.batch as u64;
            self.batch = self.left.min(BATCH);
            self.used = 0;
            self.left -= self.batch;
            for column in &mut self.columns {
                if column.read(self.batch)? != self.batch {
                    return Err(ParquetError::General("its columns differ in length".to_owned()));
                }
            }
        }
        Ok(true)
    }

    /// Opens the columns of the next row group; whether there is one.
    fn open_group(&mut self) -> std::result::Result<bool, ParquetError> {
        if self.next_group == self.file.num_row_groups() {
            return Ok(false);
        }
        let group = self.file.get_row_group(self.next_group)?;
        self.next_group += 1;
        self.left = usize::try_from(group.metadata().num_rows()).unwrap_or_default();
        let open = |(leaf, wanted, meaning): &(usize, Wanted, Meaning)| Column::open(&*group, *leaf, *wanted, *meaning);
        self.columns = self.wanted.iter().map(open).collect::<std::result::Result<_, _>>()?;
        Ok(true)
    }
}
