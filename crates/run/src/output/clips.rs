//! `clips.jsonl.gz`: where the road users around severe conflicts were, a line of JSON for each conflict that has a clip.
//!
//! It is compressed because the thousands of numbers in a clip resemble each other. Like other files without rows, it appears
//! whole when the run ends, if there are clips.

use std::io::{BufWriter, Write};
use std::path::PathBuf;

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::util::output_file::OutputFile;
use crate::{Error, Result};
use closecall::events::Clip;

/// The name of the file.
pub const CLIPS: &str = "clips.jsonl.gz";

/// What the compressor gets at once, in bytes: each time it clears its tables, which takes as long as compressing some kilobytes.
const BLOCK: usize = 1 << 16;

/// The file of a run's clips.
#[derive(Debug)]
pub(crate) struct ClipsFile {
    path: PathBuf,
    /// None before the first clip.
    file: Option<BufWriter<GzEncoder<OutputFile>>>,
    count: u64,
}

impl ClipsFile {
    /// A file at this path, once there is a clip.
    pub fn new(path: PathBuf) -> Self {
        Self { path, file: None, count: 0 }
    }

    /// The number of its clips.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Appends a clip.
    ///
    /// # Errors
    /// [`Error::File`] that names the file.
    pub fn append(&mut self, clip: &Clip) -> Result<()> {
        let Self { path, file, count } = self;
        let file = match file {
            Some(file) => file,
            None => {
                let compressed = GzEncoder::new(OutputFile::create(path)?, Compression::fast());
                file.insert(BufWriter::with_capacity(BLOCK, compressed))
            }
        };
        let written = serde_json::to_writer(&mut *file, clip).map_err(std::io::Error::from);
        written.and_then(|()| file.write_all(b"\n")).map_err(|source| Error::file(path, source))?;
        *count += 1;
        Ok(())
    }

    /// Completes the file.
    ///
    /// # Errors
    /// [`Error::File`] that names the file.
    pub fn finish(&mut self) -> Result<()> {
        let Some(file) = self.file.take() else { return Ok(()) };
        let fault = |source| Error::file(&self.path, source);
        let compressed = file.into_inner().map_err(|error| fault(error.into_error()))?;
        compressed.finish().map_err(fault)?.finish()
    }
}
