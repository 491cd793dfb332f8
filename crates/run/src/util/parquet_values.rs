//! The values of one column of a Parquet file, batch by batch, as texts or as numbers, whatever the file stores them as.

use parquet::basic::{ConvertedType, LogicalType, Type as Physical};
use parquet::column::reader::ColumnReader;
use parquet::data_type::{
    ByteArray, ByteArrayType, DoubleType, FixedLenByteArrayType, FloatType, Int32Type, Int64Type,
};
use parquet::errors::ParquetError;
use parquet::file::reader::RowGroupReader;
use parquet::schema::types::ColumnDescriptor;

use super::header::Wanted;
use super::parquet_column::Batch;

/// The most digits of a decimal: more do not fit into 128 bits.
const DIGITS: i32 = 38;

/// A value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value<'a> {
    /// The file has null.
    Missing,
    /// A text.
    Text(&'a [u8]),
    /// A number.
    Number(f64),
}

/// What the stored values of a column are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meaning {
    Text,
    Float,
    /// Floats of 16 bits.
    Half,
    Signed,
    Unsigned,
    /// Whole numbers with this many decimals.
    Decimal(u32),
}

impl Meaning {
    /// That of a column.
    ///
    /// # Errors
    /// What it holds, if that is neither texts nor numbers.
    pub fn of(column: &ColumnDescriptor) -> std::result::Result<Self, String> {
        let is_half = column.logical_type_ref() == Some(&LogicalType::Float16);
        let is_empty = column.logical_type_ref() == Some(&LogicalType::Unknown);
        let converted = column.converted_type();
        Ok(match (column.physical_type(), converted) {
            _ if column.max_rep_level() > 0 => return Err("lists".to_owned()),
            (_, ConvertedType::DECIMAL) if column.type_precision() <= DIGITS => {
                Self::Decimal(u32::try_from(column.type_scale()).unwrap_or_default())
            }
            (Physical::INT32 | Physical::INT64, ConvertedType::NONE) if !is_empty => match column.logical_type_ref() {
                None | Some(LogicalType::Integer(_)) => Self::Signed,
                Some(_) => return Err("timestamps".to_owned()),
            },
            // All its values are null.
            (Physical::INT32 | Physical::INT64, ConvertedType::NONE) => Self::Signed,
            (
                Physical::INT32 | Physical::INT64,
                ConvertedType::INT_8 | ConvertedType::INT_16 | ConvertedType::INT_32 | ConvertedType::INT_64,
            ) => Self::Signed,
            (
                Physical::INT32 | Physical::INT64,
                ConvertedType::UINT_8 | ConvertedType::UINT_16 | ConvertedType::UINT_32 | ConvertedType::UINT_64,
            ) => Self::Unsigned,
            (Physical::FLOAT | Physical::DOUBLE, _) => Self::Float,
            (Physical::FIXED_LEN_BYTE_ARRAY, _) if is_half => Self::Half,
            (
                Physical::BYTE_ARRAY,
                ConvertedType::UTF8 | ConvertedType::ENUM | ConvertedType::JSON | ConvertedType::NONE,
            ) => Self::Text,
            (Physical::BOOLEAN, _) => return Err("booleans".to_owned()),
            (_, ConvertedType::DATE) => return Err("dates".to_owned()),
            (Physical::INT96, _) | (_, ConvertedType::TIMESTAMP_MILLIS | ConvertedType::TIMESTAMP_MICROS) => {
                return Err("timestamps".to_owned());
            }
            (physical, ConvertedType::NONE) => return Err(format!("values of type {physical}")),
            (_, converted) => return Err(format!("values of type {converted}")),
        })
    }
}

/// A column of a row group, and its values in the batch.
pub(super) struct Column {
    reader: Stored,
    wanted: Wanted,
    meaning: Meaning,
    /// Filled where the values are numbers that are wanted as texts.
    texts: Vec<Option<Vec<u8>>>,
}

/// The values of a batch as they are stored.
enum Stored {
    Int(Batch<Int32Type>),
    Long(Batch<Int64Type>),
    Float(Batch<FloatType>),
    Double(Batch<DoubleType>),
    Bytes(Batch<ByteArrayType>),
    Fixed(Batch<FixedLenByteArrayType>),
}

/// A value as it is stored.
enum Raw<'a> {
    Whole(i64),
    Float(f64),
    Bytes(&'a ByteArray),
}

impl Column {
    pub fn open(
        group: &dyn RowGroupReader,
        leaf: usize,
        wanted: Wanted,
        meaning: Meaning,
    ) -> std::result::Result<Self, ParquetError> {
        let reader = match group.get_column_reader(leaf)? {
            ColumnReader::Int32ColumnReader(reader) => Stored::Int(Batch::new(reader)),
            ColumnReader::Int64ColumnReader(reader) => Stored::Long(Batch::new(reader)),
            ColumnReader::FloatColumnReader(reader) => Stored::Float(Batch::new(reader)),
            ColumnReader::DoubleColumnReader(reader) => Stored::Double(Batch::new(reader)),
            ColumnReader::ByteArrayColumnReader(reader) => Stored::Bytes(Batch::new(reader)),
            ColumnReader::FixedLenByteArrayColumnReader(reader) => Stored::Fixed(Batch::new(reader)),
            _ => return Err(ParquetError::General("a column has another type than the file says".to_owned())),
        };
        Ok(Self { reader, wanted, meaning, texts: Vec::new() })
    }

    pub fn read(&mut self, rows: usize) -> std::result::Result<usize, ParquetError> {
        let read = match &mut self.reader {
            Stored::Int(batch) => batch.read(rows),
            Stored::Long(batch) => batch.read(rows),
            Stored::Float(batch) => batch.read(rows),
            Stored::Double(batch) => batch.read(rows),
            Stored::Bytes(batch) => batch.read(rows),
            Stored::Fixed(batch) => batch.read(rows),
        }?;
        if self.wanted == Wanted::Text && self.meaning != Meaning::Text {
            self.texts = (0..read).map(|row| self.raw(row).map(|raw| self.meaning.text(&raw).into_bytes())).collect();
        }
        Ok(read)
    }

    #[inline]
    fn raw(&self, row: usize) -> Option<Raw<'_>> {
        match &self.reader {
            Stored::Int(batch) => batch.get(row).map(|number| match self.meaning {
                Meaning::Unsigned => Raw::Whole(i64::from(*number as u32)),
                _ => Raw::Whole(i64::from(*number)),
            }),
            Stored::Long(batch) => batch.get(row).map(|number| Raw::Whole(*number)),
            Stored::Float(batch) => batch.get(row).map(|number| Raw::Float(f64::from(*number))),
            Stored::Double(batch) => batch.get(row).map(|number| Raw::Float(*number)),
            Stored::Bytes(batch) => batch.get(row).map(Raw::Bytes),
            Stored::Fixed(batch) => batch.get(row).map(|bytes| Raw::Bytes(bytes)),
        }
    }

    #[inline]
    pub fn value(&self, row: usize) -> Value<'_> {
        if let Some(text) = self.texts.get(row) {
            return text.as_deref().map_or(Value::Missing, Value::Text);
        }
        match self.raw(row) {
            None => Value::Missing,
            Some(Raw::Bytes(bytes)) if self.meaning == Meaning::Text => Value::Text(bytes.data()),
            Some(raw) => Value::Number(self.meaning.number(&raw)),
        }
    }
}

impl Meaning {
    /// A stored value as a number.
    #[inline]
    fn number(self, raw: &Raw) -> f64 {
        match (self, raw) {
            (Self::Float, Raw::Float(number)) => *number,
            (Self::Signed, Raw::Whole(number)) => *number as f64,
            (Self::Unsigned, Raw::Whole(number)) => *number as u64 as f64,
            // A decimal is rounded once, as its text is.
            _ => self.text(raw).parse().unwrap_or(f64::NAN),
        }
    }

    /// A stored value as a text, with all its digits.
    fn text(self, raw: &Raw) -> String {
        match (self, raw) {
            (Self::Decimal(scale), raw) => decimal(raw.mantissa(), scale),
            (Self::Half, Raw::Bytes(bytes)) => bytes.data().first_chunk().map_or(f64::NAN, |it| half(*it)).to_string(),
            (Self::Unsigned, Raw::Whole(number)) => (*number as u64).to_string(),
            (_, Raw::Whole(number)) => number.to_string(),
            (_, Raw::Float(number)) => number.to_string(),
            (_, Raw::Bytes(bytes)) => String::from_utf8_lossy(bytes.data()).into_owned(),
        }
    }
}

impl Raw<'_> {
    /// The whole number that a decimal is stored as: in bytes, the highest first.
    fn mantissa(&self) -> i128 {
        match self {
            Self::Whole(number) => i128::from(*number),
            Self::Float(number) => *number as i128,
            Self::Bytes(bytes) => {
                let sign = if bytes.data().first().is_some_and(|first| *first > i8::MAX as u8) { -1 } else { 0 };
                bytes.data().iter().fold(sign, |number, byte| number << 8 | i128::from(*byte))
            }
        }
    }
}

/// A whole number with its last digits behind the point.
fn decimal(mantissa: i128, scale: u32) -> String {
    let scale = scale as usize;
    let digits = format!("{:0>width$}", mantissa.unsigned_abs(), width = scale + 1);
    let (whole, decimals) = digits.split_at(digits.len() - scale);
    let sign = if mantissa < 0 { "-" } else { "" };
    format!("{sign}{whole}{}{decimals}", if scale > 0 { "." } else { "" })
}

/// A float of 16 bits (IEEE 754 binary16), its lowest byte first.
fn half(bytes: [u8; 2]) -> f64 {
    let bits = u16::from_le_bytes(bytes);
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f64::from(bits & 0x3ff));
    let size = match exponent {
        0 => fraction * 2_f64.powi(-24),
        0x1f if fraction == 0.0 => f64::INFINITY,
        0x1f => f64::NAN,
        _ => (1024.0 + fraction) * 2_f64.powi(exponent - 25),
    };
    if bits >> 15 == 1 { -size } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_and_halves_are_the_numbers_that_they_stand_for() {
        assert_eq!(
            [(12_000, 3), (-5, 2), (7, 0), (i128::MIN, 38)].map(|(it, scale)| decimal(it, scale)),
            ["12.000", "-0.05", "7", "-1.70141183460469231731687303715884105728"]
        );
        assert_eq!(Raw::Bytes(&ByteArray::from(vec![0xff, 0x85])).mantissa(), -123);
        for (bits, number) in [(0x4a00, 12.0), (0xc580, -5.5), (0x0001, 2_f64.powi(-24)), (0x7bff, 65_504.0)] {
            assert_eq!(half(u16::to_le_bytes(bits)), number);
        }
        assert!(half([0, 0x7c]).is_infinite() && half([1, 0x7c]).is_nan());
    }
}
