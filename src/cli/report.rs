//! `closecall report`: logs as one HTML page.

use std::path::PathBuf;

use clap::Args;

use super::say::say;
use crate::Result;
use crate::analysis::report;
use crate::util::units::counted;

/// Which logs, and where the page goes.
#[derive(Args)]
pub struct ReportArgs {
    /// Folders of logs: each a log itself, or a folder with logs in it.
    #[arg(value_name = "DIR", required = true)]
    folders: Vec<PathBuf>,
    /// The page.
    #[arg(short, long, value_name = "FILE", default_value = "report.html")]
    out: PathBuf,
    /// The net for the map [default: where the first log says that it was].
    #[arg(short, long, value_name = "NET")]
    net: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(short, long)]
    quiet: bool,
}

/// Makes the page and says how large it is.
pub fn run(arguments: &ReportArgs) -> Result<()> {
    let made = report::write(&arguments.folders, arguments.net.as_deref(), &arguments.out)?;
    if !arguments.quiet {
        let report::Made { runs, conflicts, bytes } = made;
        let size = bytes as f64 / 1e6;
        let (conflicts, runs) = (counted(conflicts, "conflict"), counted(runs as u64, "run"));
        say(format_args!("{conflicts} of {runs} in {} ({size:.1} MB)\n", arguments.out.display()))?;
    }
    Ok(())
}
