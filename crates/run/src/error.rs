//! Errors: each names the file, the place in it and what is wrong there.

use std::path::{Path, PathBuf};

/// The result of the library's functions.
pub type Result<T> = std::result::Result<T, Error>;

/// A time in s as people write it: sums of steps differ from it by rounding.
fn in_microseconds(time: f64) -> f64 {
    (time * 1e6).round() / 1e6
}

/// An error of closecall. Its `Display` is one line for standard error.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file or folder cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The content of a file is wrong at a line.
    #[error("{}, line {line}: {message}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: u64,
        /// What is wrong there.
        message: String,
    },
    /// The content of a file is wrong as a whole.
    #[error("{}: {message}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// A recording ends early; the steps before that were checked.
    #[error("{}: cut short after time {} s: {message}", path.display(), in_microseconds(*time))]
    CutShort {
        /// The file.
        path: PathBuf,
        /// The last complete step.
        time: f64,
        /// Where and how it ends.
        message: String,
    },
    /// The method refuses what it was given.
    #[error(transparent)]
    Method(#[from] closecall::Error),
    /// A value of a caller or an option is out of range.
    #[error("{0}")]
    Value(String),
    /// A step that cannot be checked; the steps before it were.
    #[error("at {} s: {message}", in_microseconds(*time))]
    Step {
        /// The simulated time.
        time: f64,
        /// What is wrong in it.
        message: String,
    },
    /// A panic: a fault of closecall itself.
    #[error("internal error: {0}; please report this line with the command and its input")]
    Internal(String),
    /// SUMO refused to start: its configuration, net or demand cannot be used.
    #[error("{}: SUMO says: {message}", path.display())]
    Refused {
        /// The SUMO configuration.
        path: PathBuf,
        /// SUMO's message.
        message: String,
    },
    /// SUMO failed while it ran.
    #[error("SUMO failed at {} s: {message}", in_microseconds(*time))]
    Failed {
        /// The simulated time that was reached.
        time: f64,
        /// SUMO's message.
        message: String,
    },
    /// The user ended the run.
    #[error("interrupted at {} s; the log has all conflicts so far", in_microseconds(*time))]
    Interrupted {
        /// The simulated time that was reached.
        time: f64,
    },
    /// The user ended a command before it had a result.
    #[error("interrupted; nothing was compared or written")]
    Stopped,
}

impl Error {
    /// An unusable file, with the error of the operating system.
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

    /// A step that cannot be checked.
    pub fn step(time: f64, message: impl Into<String>) -> Self {
        Self::Step { time, message: message.into() }
    }
}
