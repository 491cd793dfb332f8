//! The one way to report what went wrong: an error names the file, the place in it and what is wrong there.

use std::path::{Path, PathBuf};

/// What the library's functions return.
pub type Result<T> = std::result::Result<T, Error>;

/// Why closecall could not do what it was asked to do.
///
/// Its `Display` is one line, fit for standard error.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file or folder cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// A file's content is not what it should be.
    #[error("{}, line {line}: {message}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: u64,
        /// What is wrong there.
        message: String,
    },
    /// A file as a whole is not what it should be.
    #[error("{}: {message}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// A recording ends before its format says so; what came before it was checked.
    #[error("{}: cut short after time {time} s: {message}", path.display())]
    CutShort {
        /// The file.
        path: PathBuf,
        /// The last complete step.
        time: f64,
        /// Where and how it ends.
        message: String,
    },
    /// A value that a caller or an option gives is out of its range.
    #[error("{0}")]
    Value(String),
    /// What was measured does not keep a bound that it should.
    #[error("{0}")]
    Exceeded(String),
    /// SUMO refused to start: its configuration, net or demand cannot be used.
    #[error("{}: SUMO says: {message}", path.display())]
    Refused {
        /// The SUMO configuration.
        path: PathBuf,
        /// What SUMO says.
        message: String,
    },
    /// SUMO failed while it ran.
    #[error("SUMO failed at {time} s: {message}")]
    Failed {
        /// The simulated time that was reached.
        time: f64,
        /// What SUMO says.
        message: String,
    },
    /// The user ended the run.
    #[error("interrupted at {time} s; what was found so far is in the log")]
    Interrupted {
        /// The simulated time that was reached.
        time: f64,
    },
    /// The user ended a command before it had come to a result.
    #[error("interrupted; nothing was compared or written")]
    Stopped,
    /// The user ended a sweep.
    #[error("interrupted after {done} of {all} runs; the same command continues there")]
    Paused {
        /// The runs that have ended.
        done: usize,
        /// All runs.
        all: usize,
    },
}

impl Error {
    /// An unusable file, with what the operating system says of it.
    pub fn file(path: &Path, source: std::io::Error) -> Self {
        Self::File { path: path.to_owned(), source }
    }

    /// Wrong content at a line of a file.
    pub fn line(path: &Path, line: u64, message: impl Into<String>) -> Self {
        Self::Line { path: path.to_owned(), line, message: message.into() }
    }

    /// Wrong content of a file as a whole.
    pub fn content(path: &Path, message: impl Into<String>) -> Self {
        Self::Content { path: path.to_owned(), message: message.into() }
    }

    /// The exit status of a command that ends with this error: 1 where SUMO failed in mid-run or a bound was exceeded, 3 where a
    /// recording was cut short, 130 where the user interrupted it, 2 for every other input that cannot be used.
    pub fn exit_status(&self) -> u8 {
        match self {
            Self::Failed { .. } | Self::Exceeded(_) => 1,
            Self::CutShort { .. } => 3,
            // As shells say it: 128 + SIGINT.
            Self::Interrupted { .. } | Self::Stopped | Self::Paused { .. } => 130,
            _ => 2,
        }
    }
}
