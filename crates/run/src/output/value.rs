//! One value of a log: what a CSV cell, a Parquet column and a field of a conflict have in common.

use ecow::EcoString;

use crate::util::decimal;
use closecall::detection::kind::{Kind, Severity};

/// How the values of a column are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnType {
    /// A whole number.
    Count,
    /// An id, a name or a path; empty where there is none.
    Text,
    /// A finite number, or none.
    Number,
    /// Yes, no, or none.
    Flag,
}

/// One value of a column.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[serde(untagged)]
pub enum Value<'a> {
    /// A whole number.
    Count(u64),
    /// A text.
    Text(&'a str),
    /// A number.
    Number(f64),
    /// Yes or no.
    Flag(bool),
    /// None.
    Missing,
}

impl ColumnType {
    /// The value that a cell of a CSV file holds.
    ///
    /// # Errors
    /// That it does not fit this type.
    pub fn parse(self, cell: &str) -> Result<Value<'_>, String> {
        match self {
            Self::Text => Ok(Value::Text(cell)),
            Self::Number | Self::Flag if cell.is_empty() => Ok(Value::Missing),
            Self::Number => cell.parse().map_err(|_| unfit(cell, "a number")).and_then(Value::finite),
            Self::Count => cell.parse().map(Value::Count).map_err(|_| unfit(cell, "a whole number")),
            Self::Flag => cell.parse().map(Value::Flag).map_err(|_| unfit(cell, "true or false")),
        }
    }
}

impl<'a> Value<'a> {
    /// A number of a log. It is finite, since infinite values and NaN would spoil every quantile that follows.
    ///
    /// # Errors
    /// That it is not finite.
    pub fn finite(number: f64) -> Result<Self, String> {
        if number.is_finite() { Ok(Self::Number(number)) } else { Err(format!("{number} is not a finite number")) }
    }

    fn unfit(self, wanted: &str) -> String {
        unfit(self.text(&mut String::new()), wanted)
    }

    /// The text of a CSV cell, written to `buffer` where it does not exist yet; a number has at most six decimals.
    pub fn text(self, buffer: &'a mut String) -> &'a str {
        match self {
            Self::Text(text) => text,
            Self::Number(number) => decimal::shortest(number, buffer),
            Self::Flag(true) => "true",
            Self::Flag(false) => "false",
            Self::Missing => "",
            Self::Count(count) => {
                buffer.clear();
                buffer.push_str(&count.to_string());
                buffer
            }
        }
    }
}

/// The type of a field of [`super::schema::LoggedConflict`].
pub(super) trait Field: Sized {
    const TYPE: ColumnType;

    fn value(&self) -> Value<'_>;

    /// The field with this value; an error where it has to have one, or one of another type.
    fn from_value(value: Value) -> Result<Self, String>;

    fn set(&mut self, value: Value) -> Result<(), String> {
        *self = Self::from_value(value)?;
        Ok(())
    }
}

impl Field for u64 {
    const TYPE: ColumnType = ColumnType::Count;

    fn value(&self) -> Value<'_> {
        Value::Count(*self)
    }

    fn from_value(value: Value) -> Result<Self, String> {
        if let Value::Count(count) = value { Ok(count) } else { Err(value.unfit("a whole number")) }
    }
}

impl Field for EcoString {
    const TYPE: ColumnType = ColumnType::Text;

    fn value(&self) -> Value<'_> {
        Value::Text(self)
    }

    fn from_value(value: Value) -> Result<Self, String> {
        match value {
            Value::Text(text) => Ok(text.into()),
            Value::Missing => Ok(Self::new()),
            _ => Err(value.unfit("a text")),
        }
    }

    /// Keeps the memory that it has.
    fn set(&mut self, value: Value) -> Result<(), String> {
        self.clear();
        match value {
            Value::Text(text) => self.push_str(text),
            Value::Missing => {}
            _ => return Err(value.unfit("a text")),
        }
        Ok(())
    }
}

impl Field for f64 {
    const TYPE: ColumnType = ColumnType::Number;

    fn value(&self) -> Value<'_> {
        Value::Number(*self)
    }

    fn from_value(value: Value) -> Result<Self, String> {
        if let Value::Number(number) = value { Ok(number) } else { Err(value.unfit("a number")) }
    }
}

impl Field for Option<f64> {
    const TYPE: ColumnType = ColumnType::Number;

    fn value(&self) -> Value<'_> {
        self.map_or(Value::Missing, Value::Number)
    }

    fn from_value(value: Value) -> Result<Self, String> {
        if value == Value::Missing { Ok(None) } else { f64::from_value(value).map(Some) }
    }
}

impl Field for bool {
    const TYPE: ColumnType = ColumnType::Flag;

    fn value(&self) -> Value<'_> {
        Value::Flag(*self)
    }

    fn from_value(value: Value) -> Result<Self, String> {
        if let Value::Flag(flag) = value { Ok(flag) } else { Err(value.unfit("true or false")) }
    }
}

impl Field for Option<bool> {
    const TYPE: ColumnType = ColumnType::Flag;

    fn value(&self) -> Value<'_> {
        self.map_or(Value::Missing, Value::Flag)
    }

    fn from_value(value: Value) -> Result<Self, String> {
        if value == Value::Missing { Ok(None) } else { bool::from_value(value).map(Some) }
    }
}

impl Field for Kind {
    const TYPE: ColumnType = ColumnType::Text;

    fn value(&self) -> Value<'_> {
        Value::Text(self.name())
    }

    fn from_value(value: Value) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|kind| value == Value::Text(kind.name()));
        found.ok_or_else(|| value.unfit("a kind"))
    }
}

impl Field for Severity {
    const TYPE: ColumnType = ColumnType::Text;

    fn value(&self) -> Value<'_> {
        Value::Text(self.name())
    }

    fn from_value(value: Value) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|severity| value == Value::Text(severity.name()));
        found.ok_or_else(|| value.unfit("a severity"))
    }
}

fn unfit(cell: &str, wanted: &str) -> String {
    format!("\"{cell}\" is not {wanted}")
}
