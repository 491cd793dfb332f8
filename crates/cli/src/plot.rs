//! `closecall plot`: the charts of the report as image files.

use std::path::PathBuf;

use clap::Args;

use super::error::Result;
use super::print::print;
use super::progress::CountBar;
use closecall_analysis::filter::ConflictFilter;
use closecall_analysis::logged::check_none_lost;
use closecall_analysis::plot::{self, PictureFormat, PictureStyle};

/// Which logs to draw, and where to.
#[derive(Args)]
pub(crate) struct PlotArgs {
    /// Log folders, or folders that contain log folders.
    #[arg(value_name = "LOG", required = true)]
    folders: Vec<PathBuf>,
    /// Folder for the images.
    #[arg(short, long, value_name = "DIR", default_value = "plots")]
    out: PathBuf,
    /// File format of the images.
    #[arg(long, value_enum, default_value = "svg")]
    format: PictureFormat,
    /// What the images are for.
    #[arg(long, value_enum, default_value = "screen")]
    style: PictureStyle,
    /// Net for the map [default: the net file named in the first log].
    #[arg(short, long, value_name = "NET")]
    net: Option<PathBuf>,
    /// Print only errors.
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    filter: ConflictFilter,
}

/// Draws the charts and prints the files' names.
pub fn run(arguments: &PlotArgs) -> Result<()> {
    let PlotArgs { folders, out, format, net, quiet, filter, style } = arguments;
    let mut bar = CountBar::new("conflicts", !quiet);
    let plot::Made { files, set_aside, lost } =
        plot::write(folders, net.as_deref(), filter, (out, *format, *style), &mut |read, all| bar.show(read, all))?;
    drop(bar);
    if !quiet {
        for file in files {
            print(format_args!("{}\n", file.display()))?;
        }
        set_aside.map_or(Ok(()), |text| print(format_args!("{text}\n")))?;
    }
    Ok(check_none_lost(&lost)?)
}
