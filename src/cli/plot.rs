//! `closecall plot`: the report's charts as pictures.

use std::path::PathBuf;

use clap::Args;

use super::say::say;
use crate::Result;
use crate::analysis::plot::{self, PictureFormat};

/// Which logs, and where the pictures go.
#[derive(Args)]
pub struct PlotArgs {
    /// Folders of logs: each a log itself, or a folder with logs in it.
    #[arg(value_name = "DIR", required = true)]
    folders: Vec<PathBuf>,
    /// Folder of the pictures.
    #[arg(short, long, value_name = "FOLDER", default_value = "plots")]
    out: PathBuf,
    /// Pixels or lines.
    #[arg(long, value_enum, default_value = "svg")]
    format: PictureFormat,
    /// The net for the map [default: where the first log says that it was].
    #[arg(short, long, value_name = "NET")]
    net: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(short, long)]
    quiet: bool,
}

/// Draws the pictures and names them.
pub fn run(arguments: &PlotArgs) -> Result<()> {
    let files = plot::write(&arguments.folders, arguments.net.as_deref(), &arguments.out, arguments.format)?;
    if !arguments.quiet {
        for file in files {
            say(format_args!("{}\n", file.display()))?;
        }
    }
    Ok(())
}
