//! What cannot be made of logs.

use std::path::{Path, PathBuf};

use closecall::util::units::Second;

/// The result of the library's functions.
pub type Result<T> = std::result::Result<T, Error>;

/// An error of the analysis of logs. Its `Display` is one line for standard error.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file cannot be used, a run cannot be repeated, or the user interrupted it.
    #[error(transparent)]
    Run(#[from] closecall_run::Error),
    /// No folder of a log is named.
    #[error("no log folder is named")]
    NoLog,
    /// A log has no conflict of this id.
    #[error("{} has no conflict {}", .0.display(), .1)]
    NoConflict(PathBuf, u64),
    /// A log has fewer conflicts than this place among the worst, namely these.
    #[error("--worst {}: {} has {}", .1, .0.display(), .2)]
    NoWorst(PathBuf, usize, String),
    /// A conflict of a log has no clip, and why.
    #[error("conflict {} of {} has no clip: {}", .1, .0.display(), .2)]
    NoClip(PathBuf, u64, String),
    /// A log lacks rows that its run counted; what is there was used.
    #[error("{0}")]
    Lost(String),
    /// An output would replace one of its inputs.
    #[error("--out would be written over {}", .0.display())]
    WouldReplace(PathBuf),
    /// The period of a filter ends before it begins.
    #[error("--from {0} is after --to {1}: no conflict is in between")]
    EmptyPeriod(Second, Second),
    /// The runs in these folders differ in these options, but are to be one side of a comparison.
    #[error("{0}: the runs differ in {1}: for --against name those of one variant")]
    SeveralVariants(String, String),
    /// An option is varied twice.
    #[error("{0} is varied twice")]
    VariedTwice(String),
    /// A sweep has more runs than this.
    #[error("that would be more than {0} runs")]
    TooManyRuns(usize),
    /// Two runs of a sweep have the same name.
    #[error("two runs would both be called {0}")]
    SameName(String),
    /// The number of a run that a sweep does not have, and how many it has.
    #[error("no run has the number {0}: they are 1 to {1}")]
    NoRun(usize, usize),
    /// The run of a seed failed, and why.
    #[error("seed {0}: {1}")]
    Seed(u32, String),
    /// A value cannot be used.
    #[error("{0}")]
    Value(String),
}

impl Error {
    /// An unusable file, with the error of the operating system.
    pub fn file(path: &Path, source: std::io::Error) -> Self {
        closecall_run::Error::file(path, source).into()
    }

    /// Wrong content at a line of a file.
    pub fn line(path: &Path, line: u64, message: impl Into<String>) -> Self {
        closecall_run::Error::line(path, line, message).into()
    }

    /// Wrong content of a file as a whole.
    pub fn content(path: &Path, message: impl Into<String>) -> Self {
        closecall_run::Error::content(path, message).into()
    }
}
