//! SUMO's fcd-output, step by step: XML or CSV, plain or gzipped, in memory that does not grow with the file.

use std::io::BufRead;
use std::path::Path;

use super::csv::CsvRecording;
use super::names::Users;
use super::rows::{Extent, Row, Step};
use super::source::Source;
use super::xml::XmlRecording;
use crate::{Error, Result};

/// A recording that is being read.
pub struct Recording {
    format: Format,
    users: Users,
}

enum Format {
    Xml(Box<XmlRecording>),
    Csv(Box<CsvRecording>),
}

impl Recording {
    /// Opens a recording; its first bytes say whether it is XML or CSV.
    ///
    /// # Errors
    /// An error that names the file: unreadable, empty, no fcd-output, a column that is missing.
    pub fn open(path: &Path) -> Result<Self> {
        Self::from_source(path, crate::util::input_file::open(path)?, Extent::All)
    }

    /// Opens a recording for its lanes only: a step has rows of those who came into the scene or onto another lane, and
    /// all types and numbers in them are empty.
    pub(super) fn open_for_lanes(path: &Path) -> Result<Self> {
        Self::from_source(path, crate::util::input_file::open(path)?, Extent::Lanes)
    }

    /// The recording in a text; `path` is what errors call it.
    ///
    /// # Errors
    /// As [`Recording::open`] has them.
    pub fn parse(path: &Path, text: impl Into<Vec<u8>>) -> Result<Self> {
        Self::from_source(path, Box::new(std::io::Cursor::new(text.into())), Extent::All)
    }

    fn from_source(path: &Path, reader: Box<dyn BufRead>, extent: Extent) -> Result<Self> {
        const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
        let mut source = Source::new(reader);
        let first = loop {
            let rest = source.rest();
            let text = rest.strip_prefix(BYTE_ORDER_MARK).unwrap_or(rest);
            let first = text.iter().copied().find(|byte| !byte.is_ascii_whitespace());
            if first.is_some() && rest.len() >= BYTE_ORDER_MARK.len() {
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
            Some(b'<') => Format::Xml(Box::new(XmlRecording::new(path, source, extent)?)),
            Some(_) => Format::Csv(Box::new(CsvRecording::new(path, source, extent)?)),
        };
        Ok(Self { format, users: Users::default() })
    }

    /// Reads the next step; `false` where the recording ends.
    ///
    /// # Errors
    /// [`Error::CutShort`] where the file ends before its format does, [`Error::Line`] for what is not as it should be.
    pub fn next_step(&mut self, step: &mut Step) -> Result<bool> {
        match &mut self.format {
            Format::Xml(recording) => recording.next_step(step, &mut self.users),
            Format::Csv(recording) => recording.next_step(step, &mut self.users),
        }
    }

    /// SUMO's id of a road user of the last step read, or of those who had just gone then.
    pub fn id(&self, user: u32) -> &str {
        self.users.id(user)
    }

    /// SUMO's id of a type; empty where it is not given.
    pub fn type_name(&self, row: &Row) -> &str {
        self.users.types.text(row.type_name)
    }

    /// The id of a lane by [`Row::lane`]; empty where it is not given.
    pub fn lane(&self, lane: u32) -> &str {
        self.users.lanes.text(lane)
    }
}
