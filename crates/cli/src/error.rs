//! The errors of a command; `exit_status.rs` has the status with which each ends it.

/// The result of a command.
pub type Result<T> = std::result::Result<T, Error>;

/// An error of a command. Its `Display` is one line for standard error.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A run or a recording failed, or a file cannot be used.
    #[error(transparent)]
    Run(#[from] closecall_run::Error),
    /// The analysis of logs failed.
    #[error(transparent)]
    Analysis(closecall_analysis::Error),
    /// A word of the command line cannot be used.
    #[error("{0}")]
    Value(String),
    /// How many of all measured values exceed their bounds.
    #[error("{0} of {1} bounds are exceeded")]
    Exceeded(usize, usize),
    /// The user ended a sweep: how many of all runs are done.
    #[error("interrupted after {0} of {1} runs; repeat the command to continue")]
    Paused(usize, usize),
    /// The user ended the checks of several recordings: how many of all are complete.
    #[error("interrupted after {0} of {1} recordings; each log has all conflicts so far")]
    InterruptedEach(u64, u64),
}

impl From<closecall_analysis::Error> for Error {
    fn from(error: closecall_analysis::Error) -> Self {
        match error {
            closecall_analysis::Error::Run(error) => Self::Run(error),
            own => Self::Analysis(own),
        }
    }
}

impl From<closecall::Error> for Error {
    fn from(error: closecall::Error) -> Self {
        Self::Run(error.into())
    }
}
