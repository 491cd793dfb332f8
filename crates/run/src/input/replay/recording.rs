//! SUMO's fcd-output, step by step: XML, CSV or Parquet, plain or gzipped. Its memory does not grow with the file.

use std::io::{BufRead, Read};
use std::path::Path;

use super::csv::CsvRecording;
use super::fcd_attributes::Scope;
use super::names::Users;
use super::parquet::ParquetRecording;
use super::recorded_step::{RecordedRow, RecordedStep};
use super::source::ByteWindow;
use super::xml::XmlRecording;
use crate::util::input_file;
use crate::{Error, Result};

/// A recording being read.
pub struct Recording {
    format: Format,
    pub(super) users: Users,
}

enum Format {
    Xml(Box<XmlRecording>),
    Csv(Box<CsvRecording>),
    Parquet(Box<ParquetRecording>),
}

/// The first bytes of a Parquet file.
const PARQUET: &[u8; 4] = b"PAR1";

impl Recording {
    /// Opens a recording; its first bytes decide whether it is XML, CSV or Parquet.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be read, [`Error::Content`] if it is empty, not an fcd-output, or lacks a column.
    pub fn open(path: &Path) -> Result<Self> {
        Self::from_file(path, Scope::All)
    }

    /// Opens a recording for its lanes only. A step then has rows only for road users that entered the scene or changed
    /// lanes, with empty types, and no numbers but the place and the angle.
    pub(super) fn open_for_lanes(path: &Path) -> Result<Self> {
        Self::from_file(path, Scope::Lanes)
    }

    /// Opens a recording in memory; errors call it `path`.
    ///
    /// # Errors
    /// As [`Recording::open`].
    pub fn parse(path: &Path, text: impl Into<Vec<u8>>) -> Result<Self> {
        Self::from_source(path, Box::new(std::io::Cursor::new(text.into())), Scope::All)
    }

    fn from_file(path: &Path, scope: Scope) -> Result<Self> {
        let reader = input_file::open(path)?;
        let unusable = |error| Error::file(path, error);
        let mut file = input_file::file(path)?;
        let mut first = [0; PARQUET.len()];
        if file.read(&mut first).map_err(unusable)? == first.len() && first == *PARQUET {
            let format = Format::Parquet(Box::new(ParquetRecording::new(path, file, scope)?));
            return Ok(Self { format, users: Users::default() });
        }
        Self::from_source(path, reader, scope)
    }

    fn from_source(path: &Path, reader: Box<dyn BufRead + Send>, scope: Scope) -> Result<Self> {
        const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
        let mut source = ByteWindow::new(reader);
        let first = loop {
            let rest = source.rest();
            let text = rest.strip_prefix(BYTE_ORDER_MARK).unwrap_or(rest);
            let first = text.iter().copied().find(|byte| !byte.is_ascii_whitespace());
            if first.is_some() && rest.len() >= PARQUET.len() {
                break first;
            }
            if !source.more().map_err(|error| Error::file(path, error))? {
                break first;
            }
        };
        if source.rest().starts_with(BYTE_ORDER_MARK) {
            source.consume(BYTE_ORDER_MARK.len());
        }
        let format = match first {
            None => return Err(Error::content(path, "the file is empty")),
            Some(b'<') => Format::Xml(Box::new(XmlRecording::new(path, source, scope)?)),
            // Parquet is not read from front to back.
            Some(_) if source.rest().starts_with(PARQUET) => {
                let file = source.into_file().map_err(|error| Error::file(path, error))?;
                Format::Parquet(Box::new(ParquetRecording::new(path, file, scope)?))
            }
            Some(_) => Format::Csv(Box::new(CsvRecording::new(path, source, scope)?)),
        };
        Ok(Self { format, users: Users::default() })
    }

    /// Reads the next step; `false` at the end of the recording.
    ///
    /// # Errors
    /// [`Error::CutShort`] if the file ends before its format does, [`Error::Line`] for a row that cannot be used.
    pub fn next_step(&mut self, step: &mut RecordedStep) -> Result<bool> {
        match &mut self.format {
            Format::Xml(recording) => recording.next_step(step, &mut self.users),
            Format::Csv(recording) => recording.next_step(step, &mut self.users),
            Format::Parquet(recording) => recording.next_step(step, &mut self.users),
        }
    }

    /// Lets the next row of a road user be read although it stays on its lane, if only the lanes are read.
    pub(super) fn forget_lane(&mut self, user: u32) {
        self.users.forget_lane(user);
    }

    /// SUMO's id of a road user that is in the last step read or had just left in it.
    pub fn id(&self, user: u32) -> &str {
        self.users.id(user)
    }

    /// SUMO's id of a row's type; empty if it is not given.
    pub fn type_name(&self, row: &RecordedRow) -> &str {
        self.users.types.text(row.type_name)
    }

    /// The id of a lane, or of a person's edge, by [`RecordedRow::lane`]; empty if it is not given.
    pub fn lane(&self, lane: u32) -> &str {
        self.users.lanes.text(lane)
    }
}
