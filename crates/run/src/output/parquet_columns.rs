//! Columns of the log as columns of a Parquet file. What is missing and an empty text are null.

use std::sync::Arc;

use parquet::basic::{Compression, ConvertedType, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedColumnWriter;
use parquet::schema::types::{Type, TypePtr};

use super::schema::{Column, ColumnType, LoggedConflict, Value};

type Result<T> = std::result::Result<T, ParquetError>;

/// How the files of closecall are compressed.
pub fn properties() -> Arc<WriterProperties> {
    Arc::new(WriterProperties::builder().set_compression(Compression::SNAPPY).build())
}

/// The schema of a file with these columns.
pub fn schema(columns: impl Iterator<Item = Result<TypePtr>>) -> Result<TypePtr> {
    let columns = columns.collect::<Result<_>>()?;
    Type::group_type_builder("conflict").with_fields(columns).build().map(Arc::new)
}

/// A column of the log in the schema.
pub fn of_log(column: &Column) -> Result<TypePtr> {
    let repetition = match column.column_type {
        ColumnType::Count => Repetition::REQUIRED,
        ColumnType::Text | ColumnType::Number | ColumnType::Flag => Repetition::OPTIONAL,
    };
    typed(column.name, physical(column.column_type), repetition)
}

/// A column in the schema.
pub fn typed(name: &str, physical: Physical, repetition: Repetition) -> Result<TypePtr> {
    let column = Type::primitive_type_builder(name, physical).with_repetition(repetition);
    let column = if physical == Physical::BYTE_ARRAY {
        column.with_logical_type(Some(LogicalType::String)).with_converted_type(ConvertedType::UTF8)
    } else {
        column
    };
    column.build().map(Arc::new)
}

/// A column of bytes in the schema, which may be missing.
pub fn binary(name: &str) -> Result<TypePtr> {
    let column = Type::primitive_type_builder(name, Physical::BYTE_ARRAY).with_repetition(Repetition::OPTIONAL);
    column.build().map(Arc::new)
}

/// How Parquet stores a column.
pub fn physical(column_type: ColumnType) -> Physical {
    match column_type {
        ColumnType::Count => Physical::INT64,
        ColumnType::Text => Physical::BYTE_ARRAY,
        ColumnType::Number => Physical::DOUBLE,
        ColumnType::Flag => Physical::BOOLEAN,
    }
}

/// Writes a column of the log.
pub fn fill(column: &mut SerializedColumnWriter<'_>, rows: &[LoggedConflict], of_log: &Column) -> Result<()> {
    let values = rows.iter().map(of_log.get);
    match of_log.column_type {
        ColumnType::Count => {
            let counts =
                values.filter_map(|value| if let Value::Count(count) = value { Some(count as i64) } else { None });
            column.typed::<Int64Type>().write_batch(&counts.collect::<Vec<_>>(), None, None)?;
        }
        ColumnType::Flag => {
            let flags = values.map(|value| if let Value::Flag(flag) = value { Some(flag) } else { None });
            write_optional::<BoolType>(column, flags)?;
        }
        ColumnType::Number => {
            let numbers = values.map(|value| if let Value::Number(number) = value { Some(number) } else { None });
            write_optional::<DoubleType>(column, numbers)?;
        }
        ColumnType::Text => {
            let texts = values.map(|value| match value {
                Value::Text(text) if !text.is_empty() => Some(ByteArray::from(text)),
                _ => None,
            });
            write_optional::<ByteArrayType>(column, texts)?;
        }
    }
    Ok(())
}

/// Writes values that may be missing.
pub(crate) fn write_optional<T: DataType>(
    column: &mut SerializedColumnWriter<'_>,
    values: impl Iterator<Item = Option<T::T>>,
) -> Result<()> {
    let mut levels = Vec::new();
    let present = values.inspect(|value| levels.push(i16::from(value.is_some()))).flatten().collect::<Vec<_>>();
    column.typed::<T>().write_batch(&present, Some(&levels), None)?;
    Ok(())
}
