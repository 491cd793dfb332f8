//! `closecall export`: a log in the format of another tool.

use std::path::PathBuf;

use clap::Args;

use super::error::Result;
use super::print::print;
use super::progress::CountBar;
use closecall::util::units::counted;
use closecall_analysis::export;
use closecall_analysis::filter::ConflictFilter;
use closecall_analysis::logged::check_none_lost;
use closecall_run::output::formats::ExportFormat;

/// Which log to export, as what, and where to.
#[derive(Args)]
pub(crate) struct ExportArgs {
    /// Log folder.
    #[arg(value_name = "LOG")]
    folder: PathBuf,
    /// Format of the file. SSAM's trajectories (.trj) hold all vehicles, which a log does not: run and replay write them with
    /// --trj-output.
    #[arg(long, value_enum)]
    format: ExportFormat,
    /// File to write [default: conflicts in the log's folder, with the format's ending: conflicts.geojson, conflicts.poi.xml, …].
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print only errors.
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    filter: ConflictFilter,
}

/// Writes the file and prints its name.
pub fn run(arguments: ExportArgs) -> Result<()> {
    let ExportArgs { folder, format, out, quiet, filter } = arguments;
    let out = out.unwrap_or_else(|| folder.join(format!("conflicts.{}", format.ending())));
    let mut bar = CountBar::new("conflicts", !quiet);
    let made = export::write(&folder, format, &filter, &out, &mut |read, all| bar.show(read, all))?;
    drop(bar);
    if !quiet {
        let of = if filter.is_empty() { String::new() } else { format!(" of {}", made.all) };
        print(format_args!("{}{of} in {}\n", counted(made.conflicts, "conflict"), out.display()))?;
        made.set_aside.map_or(Ok(()), |text| print(format_args!("{text}\n")))?;
    }
    Ok(check_none_lost(made.lost.as_slice())?)
}
