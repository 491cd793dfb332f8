//! The exit status of a command that ends with an error.

use closecall_analysis::Error as AnalysisError;
use closecall_run::Error as RunError;

use super::error::Error;

/// SUMO failed during the run, or a bound was exceeded.
const FAILED: u8 = 1;
/// Every other unusable input.
const UNUSABLE: u8 = 2;
/// A recording was cut short, or a log lacks rows.
const INCOMPLETE: u8 = 3;
/// closecall itself is at fault: `EX_SOFTWARE` of sysexits.h.
const INTERNAL: u8 = 70;
/// The user interrupted it: the convention of shells, 128 + SIGINT.
const INTERRUPTED: u8 = 130;

impl Error {
    /// The exit status of a command that ends with this error.
    pub(super) fn exit_status(&self) -> u8 {
        match self {
            Self::Exceeded(..) | Self::Run(RunError::Failed { .. }) => FAILED,
            Self::Analysis(AnalysisError::Lost(_)) | Self::Run(RunError::CutShort { .. }) => INCOMPLETE,
            Self::Run(RunError::Internal(_)) => INTERNAL,
            Self::Paused(..)
            | Self::InterruptedEach(..)
            | Self::Run(RunError::Interrupted { .. } | RunError::Stopped) => INTERRUPTED,
            Self::Run(_) | Self::Analysis(_) | Self::Value(_) => UNUSABLE,
        }
    }
}
