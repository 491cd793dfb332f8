//! Conflicts as columns. They take half of the memory of as many [`LoggedConflict`]s: an optional number takes no more than
//! another, and a word that repeats is there once.

use ecow::EcoString;
use rustc_hash::FxHashMap;

use crate::{Error, Result};
use closecall_run::output::schema::{COLUMNS, Column, ColumnType, LoggedConflict, Presence, Value};

/// The text columns whose values hardly repeat, besides those of snapshots.
const IDS: [&str; 2] = ["ego", "foe"];

/// Rows of a log's columns, written and read in any order.
#[derive(Debug)]
pub(crate) struct ConflictTable([Cells; COLUMNS.len()]);

/// One column, up to the last row that has a value.
#[derive(Debug)]
enum Cells {
    Counts(Vec<u64>),
    /// NaN where there is none, which no log has.
    Numbers(Vec<f64>),
    Flags(Vec<Option<bool>>),
    Texts(Vec<EcoString>),
    Words(Vec<u32>, Words),
}

/// Texts that repeat, each once; the first is empty.
#[derive(Debug)]
struct Words {
    list: Vec<EcoString>,
    places: FxHashMap<EcoString, u32>,
    /// The place of the last word: most words repeat the one before.
    last: u32,
}

impl Words {
    fn place(&mut self, word: &str) -> u32 {
        if self.list[self.last as usize] != word {
            self.last = self.places.get(word).copied().unwrap_or_else(|| {
                let place = self.list.len() as u32;
                self.list.push(word.into());
                self.places.insert(word.into(), place);
                place
            });
        }
        self.last
    }
}

impl Cells {
    fn of(column: &Column) -> Self {
        match column.column_type {
            ColumnType::Count => Self::Counts(Vec::new()),
            ColumnType::Number => Self::Numbers(Vec::new()),
            ColumnType::Flag => Self::Flags(Vec::new()),
            ColumnType::Text if column.presence == Presence::Snapshot || IDS.contains(&column.name) => {
                Self::Texts(Vec::new())
            }
            ColumnType::Text => {
                let empty = EcoString::new();
                let places = FxHashMap::from_iter([(empty.clone(), 0)]);
                Self::Words(Vec::new(), Words { list: vec![empty], places, last: 0 })
            }
        }
    }

    fn set(&mut self, row: usize, value: Value) {
        match (self, value) {
            (Self::Counts(all), Value::Count(count)) => put(all, row, count, 0),
            (Self::Numbers(all), Value::Number(number)) => put(all, row, number, f64::NAN),
            (Self::Flags(all), Value::Flag(flag)) => put(all, row, Some(flag), None),
            (Self::Texts(all), Value::Text(text)) if !text.is_empty() => put(all, row, text.into(), EcoString::new()),
            (Self::Words(all, words), Value::Text(word)) if !word.is_empty() => put(all, row, words.place(word), 0),
            (Self::Counts(all), _) => clear(all, row, 0),
            (Self::Numbers(all), _) => clear(all, row, f64::NAN),
            (Self::Flags(all), _) => clear(all, row, None),
            (Self::Texts(all), _) => clear(all, row, EcoString::new()),
            (Self::Words(all, _), _) => clear(all, row, 0),
        }
    }

    fn get(&self, row: usize) -> Value<'_> {
        match self {
            Self::Counts(all) => Value::Count(all.get(row).copied().unwrap_or_default()),
            Self::Numbers(all) => {
                all.get(row).filter(|number| !number.is_nan()).map_or(Value::Missing, |number| Value::Number(*number))
            }
            Self::Flags(all) => all.get(row).copied().flatten().map_or(Value::Missing, Value::Flag),
            Self::Texts(all) => Value::Text(all.get(row).map_or("", EcoString::as_str)),
            Self::Words(all, words) => Value::Text(all.get(row).map_or("", |place| &words.list[*place as usize])),
        }
    }
}

/// Sets a value; rows before it that never had one have `none`.
fn put<T: Clone>(all: &mut Vec<T>, row: usize, value: T, none: T) {
    if all.len() <= row {
        all.resize(row + 1, none);
    }
    all[row] = value;
}

/// Removes a value.
fn clear<T>(all: &mut [T], row: usize, none: T) {
    if let Some(there) = all.get_mut(row) {
        *there = none;
    }
}

impl Default for ConflictTable {
    fn default() -> Self {
        Self(COLUMNS.each_ref().map(Cells::of))
    }
}

impl ConflictTable {
    /// Puts a conflict into a row, over what is there.
    pub fn set(&mut self, row: u32, conflict: &LoggedConflict) {
        for (cells, column) in self.0.iter_mut().zip(&COLUMNS) {
            cells.set(row as usize, (column.get)(conflict));
        }
    }

    /// The conflict of a row.
    ///
    /// # Errors
    /// That no conflict was put there.
    pub fn conflict(&self, row: u32) -> Result<LoggedConflict> {
        LoggedConflict::from_cells(|column| Ok(self.0[column].get(row as usize))).map_err(Error::Value)
    }

    /// The numbers of a column by their rows; none where it has no numbers.
    pub fn numbers<'a>(&'a self, column: &str) -> impl Fn(u32) -> Option<f64> + use<'a> {
        let cells = self.column(column);
        move |row| match cells?.get(row as usize) {
            Value::Number(number) => Some(number),
            _ => None,
        }
    }

    /// The texts of a column by their rows; empty where it has no texts.
    pub fn texts<'a>(&'a self, column: &str) -> impl Fn(u32) -> &'a str + use<'a> {
        let cells = self.column(column);
        move |row| match cells.map(|cells| cells.get(row as usize)) {
            Some(Value::Text(text)) => text,
            _ => "",
        }
    }

    /// The flags of a column by their rows; none where it has no flags.
    pub fn flags<'a>(&'a self, column: &str) -> impl Fn(u32) -> Option<bool> + use<'a> {
        let cells = self.column(column);
        move |row| match cells?.get(row as usize) {
            Value::Flag(flag) => Some(flag),
            _ => None,
        }
    }

    fn column(&self, name: &str) -> Option<&Cells> {
        let found = COLUMNS.iter().zip(&self.0).find(|(column, _)| column.name == name).map(|(_, cells)| cells);
        debug_assert!(found.is_some(), "a log has no column {name}");
        found
    }
}
