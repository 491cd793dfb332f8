//! A column of a row group, of which rows are read or passed over.

use std::ops::Range;

use parquet::column::reader::ColumnReader;
use parquet::data_type::{BoolType, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::reader::RowGroupReader;

use closecall_run::output::schema::Value;
use closecall_run::util::parquet_column::Batch;

/// A column of a row group.
pub(crate) struct GroupColumn {
    place: usize,
    /// What was read last; none before its first rows.
    batch: Option<ColumnBatch>,
    /// Rows of the group that were read or passed over.
    rows: usize,
}

impl GroupColumn {
    pub fn new(place: usize) -> Self {
        Self { place, batch: None, rows: 0 }
    }

    /// Reads these rows of the group, unless they are those that were read last.
    pub fn read(&mut self, group: &dyn RowGroupReader, rows: &Range<usize>) -> Result<(), ParquetError> {
        let batch = match &mut self.batch {
            Some(batch) => batch,
            none => none.insert(ColumnBatch::new(group.get_column_reader(self.place)?)?),
        };
        if self.rows == rows.end {
            return Ok(());
        }
        let (before, wanted) = (rows.start - self.rows, rows.len());
        self.rows = rows.end;
        if batch.skip(before)? != before || batch.read(wanted)? != wanted {
            return Err(ParquetError::General("its columns differ in length".to_owned()));
        }
        Ok(())
    }

    /// The value in one of the rows that were read last, counted from their first.
    pub fn value(&self, row: usize) -> Result<Value<'_>, String> {
        self.batch.as_ref().map_or(Ok(Value::Missing), |batch| batch.value(row))
    }
}

/// The reader of a column, and its values in the batch.
enum ColumnBatch {
    Count(Batch<Int64Type>),
    Text(Batch<ByteArrayType>),
    Number(Batch<DoubleType>),
    Flag(Batch<BoolType>),
}

impl ColumnBatch {
    fn new(reader: ColumnReader) -> Result<Self, ParquetError> {
        Ok(match reader {
            ColumnReader::Int64ColumnReader(reader) => Self::Count(Batch::new(reader)),
            ColumnReader::ByteArrayColumnReader(reader) => Self::Text(Batch::new(reader)),
            ColumnReader::DoubleColumnReader(reader) => Self::Number(Batch::new(reader)),
            ColumnReader::BoolColumnReader(reader) => Self::Flag(Batch::new(reader)),
            _ => return Err(ParquetError::General("a column has another type than that of a log".to_owned())),
        })
    }

    fn skip(&mut self, rows: usize) -> Result<usize, ParquetError> {
        match self {
            Self::Count(batch) => batch.skip(rows),
            Self::Text(batch) => batch.skip(rows),
            Self::Number(batch) => batch.skip(rows),
            Self::Flag(batch) => batch.skip(rows),
        }
    }

    fn read(&mut self, rows: usize) -> Result<usize, ParquetError> {
        match self {
            Self::Count(batch) => batch.read(rows),
            Self::Text(batch) => batch.read(rows),
            Self::Number(batch) => batch.read(rows),
            Self::Flag(batch) => batch.read(rows),
        }
    }

    /// The value in a row of the batch.
    fn value(&self, row: usize) -> Result<Value<'_>, String> {
        let value = match self {
            Self::Count(batch) => batch
                .get(row)
                .map(|&count| u64::try_from(count).map(Value::Count).map_err(|_| format!("{count} is below 0"))),
            Self::Text(batch) => {
                batch.get(row).map(|text| text.as_utf8().map(Value::Text).map_err(|_| "it is not UTF-8".to_owned()))
            }
            Self::Number(batch) => batch.get(row).map(|&number| Value::finite(number)),
            Self::Flag(batch) => batch.get(row).map(|&flag| Ok(Value::Flag(flag))),
        };
        value.unwrap_or(Ok(Value::Missing))
    }
}
