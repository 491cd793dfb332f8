//! What a `conflicts.parquet` holds besides its rows: its run's record, and what tells whether it is as it was written.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use parquet::basic::Type as Physical;
use parquet::file::reader::{FileReader, SerializedFileReader};
use serde::{Deserialize, Serialize};

use crate::{Error, Result};
use closecall::util::units::Second;
use closecall_run::output::input_hash::Hasher;
use closecall_run::output::schema::Column;
use closecall_run::util::{input_file, parquet_column};

/// The key of the text of `run.json` in the file's metadata.
pub(super) const RECORD_KEY: &str = "closecall.run.json";
/// The key of the fingerprint in the file's metadata.
pub(super) const FINGERPRINT_KEY: &str = "closecall.fingerprint";
/// The key of the run time in the file's metadata.
pub(super) const RUN_TIME_KEY: &str = "closecall.run_time";
/// The key of the [`digest`] in the file's metadata; files of earlier versions have none.
pub(super) const DIGEST_KEY: &str = "closecall.digest";

/// How many bytes the rows take, and the SHA-256 of these and of the texts of the metadata: pages have no checksums of
/// their own.
pub(super) fn digest(bytes: usize, mut rows: Hasher, metadata: [&str; 3]) -> String {
    metadata.iter().for_each(|text| rows.add(text));
    format!("{bytes} {}", rows.digits())
}

/// Whether the file is as it was written; none where it does not tell.
pub(super) fn is_as_written(path: &Path, file: &SerializedFileReader<File>) -> Result<Option<bool>> {
    let Some(known) = value(file, DIGEST_KEY) else { return Ok(None) };
    let bytes = known.split(' ').next().and_then(|bytes| bytes.parse::<u64>().ok()).unwrap_or_default();
    let mut rows = Hasher::default();
    let copied = std::io::copy(&mut input_file::file(path)?.take(bytes), &mut rows);
    copied.map_err(|source| Error::file(path, source))?;
    let metadata = [RECORD_KEY, FINGERPRINT_KEY, RUN_TIME_KEY].map(|key| value(file, key).unwrap_or_default());
    Ok(Some(digest(bytes as usize, rows, metadata.each_ref().map(String::as_str)) == known))
}

/// The value of a key in the file's metadata.
fn value(file: &SerializedFileReader<File>, key: &str) -> Option<String> {
    let pairs = file.metadata().file_metadata().key_value_metadata().into_iter().flatten();
    pairs.filter(|pair| pair.key == key).find_map(|pair| pair.value.clone())
}

/// What a `conflicts.parquet` holds besides its rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Packed {
    /// The text of `run.json`.
    pub record: String,
    /// The hash of what the run was asked for.
    pub fingerprint: String,
    /// The labels of the run, each with whether it is a number.
    pub labels: Vec<(String, bool)>,
    /// What the run took; files of earlier versions do not have it.
    pub run_time: Option<RunTime>,
}

/// What a run took, as the process that it was.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunTime {
    /// From its start to its end.
    pub wall: Second,
    /// Of all processors together.
    pub cpu: Second,
}

impl Packed {
    /// The text of `run.json` that a `conflicts.parquet` holds.
    ///
    /// # Errors
    /// As [`Packed::of`].
    pub(crate) fn record_of(path: &Path) -> Result<String> {
        Ok(Self::of(path)?.record)
    }

    /// Reads the metadata of a `conflicts.parquet`.
    ///
    /// # Errors
    /// [`Error::file`] where it cannot be read; [`Error::content`] where no sweep has written it.
    pub fn of(path: &Path) -> Result<Self> {
        let file = open(path)?;
        let metadata = file.metadata().file_metadata();
        let value = |key: &str| {
            value(&file, key)
                .ok_or_else(|| Error::content(path, format!("it is not a file of closecall sweep: {key} is missing")))
        };
        let columns = metadata.schema_descr().columns().iter();
        let labels = columns.filter(|column| Column::named(column.name()).is_none());
        Ok(Self {
            record: value(RECORD_KEY)?,
            fingerprint: value(FINGERPRINT_KEY)?,
            labels: labels
                .map(|column| (column.name().to_owned(), column.physical_type() != Physical::BYTE_ARRAY))
                .collect(),
            run_time: self::value(&file, RUN_TIME_KEY).and_then(|text| serde_json::from_str(&text).ok()),
        })
    }
}

/// Opens a Parquet file.
pub(super) fn open(path: &Path) -> Result<SerializedFileReader<File>> {
    let file = input_file::file(path)?;
    Ok(parquet_column::open(path, file)?)
}
