//! What `closecall run` and `closecall replay` share: the options, the log's folder, and what is printed at the end.

use std::path::{Path, PathBuf};

use clap::Args;

use super::ending;
use super::error::Result;
use super::files::{default_folder, kept, print_if_elsewhere};
use closecall_analysis::logged::pack_in_place;
use closecall_run::RunOptions;
use closecall_run::output::folder::LogFolder;
use closecall_run::output::formats::LogFormat;
use closecall_run::output::formats::OutputFiles;
use closecall_run::output::summary::Summary;

/// The name of the log's default folder.
const LOG: &str = "closecall-out";

/// Whether a run wants a new folder.
fn is_auto(out: &Path) -> bool {
    out == Path::new("auto")
}

/// How to check a scenario or a recording, and what to write.
#[derive(Args)]
#[command(next_help_heading = "Run")]
pub(super) struct CheckArgs {
    /// TOML file with options.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    #[command(flatten)]
    pub options: RunOptions,
    /// Folder for the log [default: closecall-out next to the scenario or recording, or else in the working directory].
    /// An earlier log is moved to its folder earlier; auto makes a new folder beside the default one.
    #[arg(short, long, value_name = "DIR", help_heading = "Output")]
    out: Option<PathBuf>,
    /// Print only errors.
    #[arg(short, long, help_heading = "Output")]
    pub quiet: bool,
    /// List the skipped tests, and the time each part took.
    #[arg(long, help_heading = "Output")]
    explain: bool,
    #[command(flatten)]
    pub outputs: OutputFiles,
}

impl CheckArgs {
    /// The folder for the log of this scenario or recording.
    pub(crate) fn log_folder(&self, input: &Path) -> PathBuf {
        self.out.clone().filter(|out| !is_auto(out)).unwrap_or_else(|| default_folder(input, LOG))
    }

    /// The same folder, or a new one where that is wanted, for this run alone.
    ///
    /// # Errors
    /// Where another run writes there, or nothing can be written.
    pub fn claim(&self, folder: &Path) -> Result<LogFolder> {
        let is_new = self.out.as_deref().is_some_and(is_auto);
        Ok(if is_new { LogFolder::claim_new(folder) } else { LogFolder::claim(folder) }?)
    }

    /// The options.
    ///
    /// # Errors
    /// Where a value is out of range, or one file would be written over another.
    pub fn checked(&self, log: &Path) -> Result<RunOptions> {
        let options = self.options.clone().checked()?;
        self.outputs.check(&kept(self.config.as_deref(), &options, log))?;
        Ok(options)
    }

    /// Completes the log in the format that was asked for.
    ///
    /// # Errors
    /// Those of writing the log anew.
    pub fn complete(&self, log: &Path) -> Result<()> {
        if self.outputs.log_format == LogFormat::Parquet {
            pack_in_place(log)?;
        }
        Ok(())
    }

    /// Completes the log in the format that was asked for, and prints what was found in a scenario or recording, unless only
    /// errors are wanted.
    ///
    /// # Errors
    /// Those of writing the log anew.
    pub fn finish(&self, summary: &Summary, input: &Path, log: &Path) -> Result<()> {
        self.complete(log)?;
        if self.quiet {
            return Ok(());
        }
        if self.out.is_none() {
            print_if_elsewhere(log, input, LOG)?;
        }
        ending::print_summary(summary, log, self.explain)
    }
}
