//! A table of statistics: rows of cells, and how a cell is printed.

/// A table with a title; the first cell of a row says what the row is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// A word or two, unique.
    pub title: &'static str,
    /// What the columns are, with their units.
    pub columns: Vec<&'static str>,
    /// The rows.
    pub rows: Vec<Vec<Cell>>,
    /// What is to be said below the table.
    pub notes: Vec<String>,
}

/// What stands in a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A word.
    Text(String),
    /// A number.
    Number(f64),
    /// A count.
    Count(u64),
    /// Nothing: there is no such value.
    None,
}

impl Cell {
    /// The number, if there is one.
    pub fn maybe(value: Option<f64>) -> Self {
        value.map_or(Self::None, Self::Number)
    }

    /// For people: four significant digits.
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

    /// For programs: every digit.
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
