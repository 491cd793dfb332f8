//! fcd-output in Parquet, as SUMO writes it since 1.24: the columns of its CSV, with numbers as numbers.

use std::fs::File;
use std::path::{Path, PathBuf};

use super::clock;
use super::columns::Columns;
use super::fcd_attributes::{Attribute, Scope};
use super::names::Users;
use super::recorded_step::{RecordedStep, in_order};
use crate::util::header::Wanted;
use crate::util::parquet_rows::ParquetRows;
use crate::util::parquet_values::Value;
use crate::{Error, Result};
use closecall::util::units::Second;

/// A Parquet recording being read.
pub(super) struct ParquetRecording {
    path: PathBuf,
    /// The time is the first of its columns, then come those that matter.
    rows: ParquetRows,
    scope: Scope,
    columns: Columns,
    last: Option<Second>,
}

impl ParquetRecording {
    pub fn new(path: &Path, file: File, scope: Scope) -> Result<Self> {
        let mut rows = ParquetRows::open(path, file)?;
        let mut columns = Columns::of(path, &rows.names(), scope)?;
        columns.named.retain(|column| column.attribute.is_some());
        let kind =
            |attribute| if matches!(attribute, Some(Attribute::Text(_))) { Wanted::Text } else { Wanted::Number };
        let named = columns.named.iter().map(|column| (column.place, kind(column.attribute)));
        rows.want(&std::iter::once((columns.time, Wanted::Number)).chain(named).collect::<Vec<_>>())?;
        Ok(Self { path: path.to_owned(), rows, scope, columns, last: None })
    }

    pub fn next_step(&mut self, step: &mut RecordedStep, users: &mut Users) -> Result<bool> {
        let mut begun = false;
        while self.rows.has_row()? {
            let wrong = |message| Error::content(&self.path, format!("row {}: {message}", self.rows.number()));
            let time = match self.rows.value(0) {
                Value::Missing => None,
                Value::Text(text) => clock::time(text),
                Value::Number(number) => Some(number),
            };
            let time = time.ok_or_else(|| wrong("its time cannot be read".to_owned()))?;
            if begun && time != step.time {
                break;
            }
            if !begun {
                in_order(self.last, time).map_err(wrong)?;
                step.begin(time, users);
                begun = true;
            }
            let mut fields = self.scope.fields();
            for (number, column) in self.columns.named.iter().enumerate() {
                let Some(attribute) = column.attribute else { continue };
                match self.rows.value(number + 1) {
                    Value::Missing => continue,
                    Value::Text(text) => fields.set(attribute, text).map_err(wrong)?,
                    Value::Number(number) => fields.set_number(attribute, number).map_err(wrong)?,
                }
                fields.person |= column.person;
            }
            if self.columns.shared {
                fields.tell_apart();
            }
            if fields.is_user().map_err(wrong)? {
                step.add(&fields, users, "value in column").map_err(wrong)?;
            }
            self.rows.use_row();
        }
        if begun {
            step.end(users);
            self.last = Some(step.time);
        }
        Ok(begun)
    }
}
