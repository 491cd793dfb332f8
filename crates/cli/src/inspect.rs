//! `closecall inspect`: identifies a recording.

use std::path::PathBuf;

use clap::Args;

use super::error::Result;
use super::print::print;
use closecall_run::input::tracks;

/// Which file to look at.
#[derive(Args)]
pub(crate) struct InspectArgs {
    /// Recording.
    #[arg(value_name = "FILE")]
    file: PathBuf,
}

/// Prints what the file is, what it lacks, and the command that replays it.
pub fn run(arguments: &InspectArgs) -> Result<()> {
    print(tracks::inspect(&arguments.file)?)
}
