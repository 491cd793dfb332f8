//! A table of statistics: rows of cells, and their text.

/// A table with a title; the first cell of each row is its name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The title, unique, of a word or two.
    pub title: &'static str,
    /// The headings of the columns, with units.
    pub columns: Vec<&'static str>,
    /// The rows.
    pub rows: Vec<Vec<Cell>>,
    /// Lines below the table.
    pub notes: Vec<String>,
}

/// The contents of a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Text.
    Text(String),
    /// A number.
    Number(f64),
    /// A count.
    Count(u64),
    /// Empty: the value does not exist.
    None,
}

impl Cell {
    /// A number, or an empty cell.
    pub(crate) fn maybe(value: Option<f64>) -> Self {
        value.map_or(Self::None, Self::Number)
    }

    /// The text for people: four significant digits.
    pub fn rounded(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Count(count) => count.to_string(),
            Self::None => "–".to_owned(),
            Self::Number(number) => {
                let digits = if *number == 0.0 { 0.0 } else { number.abs().log10().floor() };
                format!("{number:.*}", (3.0 - digits).clamp(0.0, 6.0) as usize)
            }
        }
    }

    /// The text for programs: every digit.
    pub fn exact(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Count(count) => count.to_string(),
            Self::None => String::new(),
            Self::Number(number) => number.to_string(),
        }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}
