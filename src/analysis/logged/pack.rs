//! A log as one Parquet file, for a data set of many runs.

use std::fs::{self, File};
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, ConvertedType, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;
use serde::{Deserialize, Serialize};

use super::conflicts::LoggedConflict;
use super::fields::{FIELDS, Field};
use super::parquet::{FINGERPRINT_KEY, RECORD_KEY, unreadable};
use super::reader::ConflictReader;
use super::run::record;
use crate::output::log::CONFLICT_COLUMNS;
use crate::{Error, Result};

/// So many rows are a row group: what is in memory while one is written.
const GROUP: usize = 1 << 16;

/// A column that is the same in all rows of a run, and tells it from the others of a sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Label {
    /// The column's name.
    pub name: String,
    /// Its value in this run.
    pub value: LabelValue,
}

/// The value of a [`Label`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum LabelValue {
    /// A whole number.
    Count(u32),
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
}

/// Writes a log with its `run.json` as the Parquet file `out`, whole or not at all.
///
/// # Errors
/// Those of reading the log; [`Error::File`] or [`Error::Content`] where `out` cannot be written.
pub fn pack(folder: &Path, labels: &[Label], fingerprint: &str, out: &Path) -> Result<()> {
    let conflicts = ConflictReader::open(folder)?.with_snapshots();
    let (_, record) = record(folder)?;
    let within = out.parent().unwrap_or(Path::new(""));
    fs::create_dir_all(within).map_err(|source| Error::file(within, source))?;
    // Hidden, so that nobody takes it for a part of the data set; its own name, should two write the same run.
    let draft = tempfile::Builder::new().prefix(".conflicts-").tempfile_in(within);
    let draft = draft.map_err(|source| Error::file(within, source))?;
    let file = draft.as_file().try_clone().map_err(|source| Error::file(out, source))?;
    let metadata = vec![
        KeyValue::new(RECORD_KEY.to_owned(), record),
        KeyValue::new(FINGERPRINT_KEY.to_owned(), fingerprint.to_owned()),
    ];
    write(file, conflicts, labels, metadata).map_err(|fault| match fault {
        Fault::Own(error) => error,
        Fault::Parquet(error) => unreadable(out, &error),
    })?;
    readable_by_all(draft.path()).map_err(|source| Error::file(out, source))?;
    draft.persist(out).map(|_| ()).map_err(|error| Error::file(out, error.error))
}

/// Temporary files are their owner's alone; a data set is read by others too.
#[cfg(unix)]
fn readable_by_all(path: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(path, fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn readable_by_all(_: &Path) -> std::io::Result<()> {
    Ok(())
}

enum Fault {
    Own(Error),
    Parquet(ParquetError),
}

impl From<ParquetError> for Fault {
    fn from(error: ParquetError) -> Self {
        Self::Parquet(error)
    }
}

fn write(
    file: File,
    mut conflicts: ConflictReader,
    labels: &[Label],
    metadata: Vec<KeyValue>,
) -> std::result::Result<(), Fault> {
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY);
    let properties = properties.set_key_value_metadata(Some(metadata)).build();
    let mut writer = SerializedFileWriter::new(file, Arc::new(schema(labels)?), Arc::new(properties))?;
    let mut rows = Vec::with_capacity(1024);
    loop {
        rows.clear();
        for conflict in conflicts.by_ref().take(GROUP) {
            rows.push(conflict.map_err(Fault::Own)?);
        }
        if rows.is_empty() {
            break;
        }
        let mut group = writer.next_row_group()?;
        let mut written = 0;
        while let Some(mut column) = group.next_column()? {
            match FIELDS.get(written) {
                Some(field) => fill(&mut column, &rows, *field)?,
                None => repeat(&mut column, rows.len(), &labels[written - FIELDS.len()].value)?,
            }
            column.close()?;
            written += 1;
        }
        group.close()?;
    }
    writer.close()?;
    Ok(())
}

fn schema(labels: &[Label]) -> std::result::Result<Type, ParquetError> {
    let column = |name: &str, physical: Physical, repetition: Repetition| {
        let column = Type::primitive_type_builder(name, physical).with_repetition(repetition);
        let column = if physical == Physical::BYTE_ARRAY {
            column.with_logical_type(Some(LogicalType::String)).with_converted_type(ConvertedType::UTF8)
        } else {
            column
        };
        column.build().map(Arc::new)
    };
    let mut columns = Vec::with_capacity(FIELDS.len() + labels.len());
    for (name, field) in CONFLICT_COLUMNS.into_iter().zip(FIELDS) {
        let repetition = match field {
            Field::Count(_) | Field::Flag(_) => Repetition::REQUIRED,
            Field::Text(_) | Field::Number(_) => Repetition::OPTIONAL,
        };
        columns.push(column(name, field.physical(), repetition)?);
    }
    for label in labels {
        let physical = match label.value {
            LabelValue::Count(_) => Physical::INT64,
            LabelValue::Number(_) => Physical::DOUBLE,
            LabelValue::Text(_) => Physical::BYTE_ARRAY,
        };
        columns.push(column(&label.name, physical, Repetition::REQUIRED)?);
    }
    Type::group_type_builder("conflict").with_fields(columns).build()
}

/// Writes a column of the log.
fn fill(
    column: &mut SerializedColumnWriter<'_>,
    rows: &[LoggedConflict],
    field: Field,
) -> std::result::Result<(), ParquetError> {
    match field {
        Field::Count(of) => {
            let values = rows.iter().map(of).collect::<Vec<_>>();
            column.typed::<Int64Type>().write_batch(&values, None, None)?;
        }
        Field::Flag(of) => {
            let values = rows.iter().map(of).collect::<Vec<_>>();
            column.typed::<BoolType>().write_batch(&values, None, None)?;
        }
        Field::Number(of) => {
            let levels = rows.iter().map(|row| i16::from(of(row).is_some())).collect::<Vec<_>>();
            let values = rows.iter().filter_map(of).collect::<Vec<_>>();
            column.typed::<DoubleType>().write_batch(&values, Some(&levels), None)?;
        }
        Field::Text(of) => {
            let levels = rows.iter().map(|row| i16::from(!of(row).is_empty())).collect::<Vec<_>>();
            let texts = rows.iter().map(of).filter(|text| !text.is_empty());
            let values = texts.map(ByteArray::from).collect::<Vec<_>>();
            column.typed::<ByteArrayType>().write_batch(&values, Some(&levels), None)?;
        }
    }
    Ok(())
}

/// Writes a column that is the same in all rows.
fn repeat(
    column: &mut SerializedColumnWriter<'_>,
    rows: usize,
    value: &LabelValue,
) -> std::result::Result<(), ParquetError> {
    match value {
        LabelValue::Count(count) => {
            column.typed::<Int64Type>().write_batch(&vec![i64::from(*count); rows], None, None)?;
        }
        LabelValue::Number(number) => {
            column.typed::<DoubleType>().write_batch(&vec![*number; rows], None, None)?;
        }
        LabelValue::Text(text) => {
            column.typed::<ByteArrayType>().write_batch(&vec![ByteArray::from(text.as_str()); rows], None, None)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::analysis::logged::pack::*;
    use crate::analysis::logged::{PARQUET, Packed};
    use crate::output::log::{CONFLICTS, RUN};

    fn labels() -> [Label; 3] {
        [
            ("option_epsilon", LabelValue::Number(0.5)),
            ("sumo_x", LabelValue::Text("y".to_owned())),
            ("seed", LabelValue::Count(7)),
        ]
        .map(|(name, value)| Label { name: name.to_owned(), value })
    }

    fn packed(name: &str, rows: usize) -> (Vec<LoggedConflict>, Vec<LoggedConflict>, Packed) {
        let folder = std::env::temp_dir().join(format!("closecall-pack-{name}-{}", std::process::id()));
        fs::create_dir_all(folder.join("log")).unwrap();
        let mut text = CONFLICT_COLUMNS.join(",") + "\n";
        for id in 1..=rows {
            let (ttc, lane) = if id % 3 == 0 { ("", "") } else { ("1.25", ":J_0_1") };
            text += &format!("{id},\"a,{id}\",b,side,serious,0,1,0.5,1,3,-2.25,0.4,{ttc},3.5,,2,10,5,1.57,7,8,{lane},");
            text += &format!("{},car,truck,1,2,0.5,5,1.8,1 2 3 4,5,6,1,0,0,\n", id % 2 == 0);
        }
        fs::write(folder.join("log").join(CONFLICTS), text).unwrap();
        fs::write(folder.join("log").join(RUN), "{}\n").unwrap();
        pack(&folder.join("log"), &labels(), "abc", &folder.join("p").join(PARQUET)).unwrap();
        assert_eq!(fs::read_dir(folder.join("p")).unwrap().count(), 1, "a draft is left");
        let read = |folder: &Path| {
            let reader = ConflictReader::open(folder).unwrap().with_snapshots();
            assert_eq!(reader.columns(), CONFLICT_COLUMNS);
            reader.collect::<Result<Vec<_>>>().unwrap()
        };
        let both = (read(&folder.join("log")), read(&folder.join("p")));
        let beside = Packed::of(&folder.join("p").join(PARQUET)).unwrap();
        fs::remove_dir_all(folder).unwrap();
        (both.0, both.1, beside)
    }

    #[test]
    fn what_is_packed_is_what_was_logged_also_across_row_groups() {
        for rows in [0, 1, 5000, GROUP + 10] {
            let (logged, packed, beside) = packed(&format!("rows{rows}"), rows);
            assert_eq!(logged.len(), rows);
            assert_eq!(logged, packed);
            assert_eq!((beside.record.as_str(), beside.fingerprint.as_str()), ("{}\n", "abc"));
            let names = beside.labels.iter().map(|(name, number)| (name.as_str(), *number)).collect::<Vec<_>>();
            assert_eq!(names, [("option_epsilon", true), ("sumo_x", false), ("seed", true)]);
        }
    }

    #[test]
    fn a_file_that_is_cut_short_is_named() {
        let path = std::env::temp_dir().join(format!("closecall-cut-{}", std::process::id()));
        fs::write(&path, "PAR1 and no more").unwrap();
        let message = Packed::of(&path).unwrap_err().to_string();
        fs::remove_file(&path).unwrap();
        assert!(message.contains("closecall-cut-") && !message.contains('\n'), "{message}");
    }
}
