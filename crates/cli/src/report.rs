//! `closecall report`: logs as one HTML page.

use std::path::{Path, PathBuf};

use clap::Args;

use super::error::{Error, Result};
use super::print::print;
use super::progress::CountBar;
use closecall::util::units::counted;
use closecall_analysis::filter::ConflictFilter;
use closecall_analysis::logged::check_none_lost;
use closecall_analysis::report::{self, TileUrl};

/// Which logs to show, and where to write the page.
#[derive(Args)]
pub(crate) struct ReportArgs {
    /// Log folders, or folders that contain log folders.
    #[arg(value_name = "LOG", required = true)]
    folders: Vec<PathBuf>,
    /// HTML file to write [default: report.html, or summary.html with --summary].
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Net for the map [default: the net file named in the first log].
    #[arg(short, long, value_name = "NET")]
    net: Option<PathBuf>,
    /// Print only errors.
    #[arg(short, long)]
    quiet: bool,
    /// Runs to compare with, such as those before a change: log folders, or folders that contain log folders.
    #[arg(long, value_name = "LOG", num_args = 1..)]
    against: Vec<PathBuf>,
    /// Write one page for people who decide, to print or save as PDF from a browser: where, why, and what to know.
    #[arg(long)]
    summary: bool,
    /// Background map: the page requests its tiles from this server. Without it a page sends no requests.
    #[arg(long, value_name = "URL", conflicts_with = "summary")]
    tiles: Option<TileUrl>,
    /// Folder that `closecall whatif` wrote: its roll-outs as sections of the page.
    #[arg(long, value_name = "DIR", conflicts_with = "summary")]
    whatif: Option<PathBuf>,
    /// How many of the worst conflicts play, as far as the log has their clips; each takes 3 to 26 kB of the page [default: 100,
    /// and at most 2 MB].
    #[arg(long, value_name = "N", conflicts_with = "summary")]
    clips: Option<usize>,
    #[command(flatten)]
    filter: ConflictFilter,
}

/// Writes the page and prints its size.
pub fn run(arguments: &ReportArgs) -> Result<()> {
    let mut bar = CountBar::new("conflicts", !arguments.quiet);
    let ReportArgs { folders, against, net, filter, summary, tiles, clips, whatif, .. } = arguments;
    let out = arguments.out.clone().unwrap_or_else(|| if *summary { "summary.html" } else { "report.html" }.into());
    if out.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("pdf")) {
        return Err(not_pdf(&out));
    }
    let (net, tiles) = (net.as_deref(), tiles.as_ref());
    let request = report::Request {
        folders,
        against,
        net,
        filter,
        is_summary: *summary,
        tiles,
        clips: *clips,
        whatif: whatif.as_deref(),
    };
    let mut progress = |read, all| bar.show(read, all);
    let made = report::write(&request, &out, &mut progress)?;
    drop(bar);
    let report::Made { runs, conflicts, set_aside, bytes, lost } = made;
    if !arguments.quiet {
        let size = bytes as f64 / 1e6;
        let (conflicts, runs) = (counted(conflicts, "conflict"), counted(runs as u64, "run"));
        print(format_args!("{conflicts} of {runs} in {} ({size:.1} MB)\n", out.display()))?;
        set_aside.map_or(Ok(()), |text| print(format_args!("{text}\n")))?;
    }
    Ok(check_none_lost(&lost)?)
}

/// That a page is HTML, and how it becomes a PDF file: a browser lays it out.
fn not_pdf(out: &Path) -> Error {
    let (page, out) = (out.with_extension("html"), out.display());
    let page = page.display();
    Error::Value(format!(
        "--out {out}: a report is HTML; write {page} and print it from a browser, or: chromium --headless \
         --no-pdf-header-footer --print-to-pdf={out} {page}"
    ))
}
