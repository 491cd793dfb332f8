//! `closecall clip` and `closecall show`: a conflict of a log, played.

use std::path::{Path, PathBuf};

use clap::Args;

use super::say::{say, value};
use super::sumo::{ShowRequest, Sumo, no_sumo};
use super::which::WhichArgs;
use crate::Result;
use crate::analysis::logged::check_keeps_logs;
use crate::analysis::playback::{Playback, svg};
use crate::util::output_file;

/// Which conflict, and on what to draw it.
#[derive(Args)]
struct Choice {
    #[command(flatten)]
    conflict: WhichArgs,
    /// Net [default: the net file named in the log].
    #[arg(short, long, value_name = "NET")]
    net: Option<PathBuf>,
}

impl Choice {
    fn find(&self) -> Result<Playback> {
        Playback::find(&self.conflict.folder, self.conflict.which(), self.net.as_deref())
    }
}

/// Which conflict to draw, and where to.
#[derive(Args)]
pub struct ClipArgs {
    #[command(flatten)]
    choice: Choice,
    /// SVG file to write.
    #[arg(short, long, value_name = "FILE", default_value = "clip.svg")]
    out: PathBuf,
    /// Print only errors.
    #[arg(short, long)]
    quiet: bool,
}

/// Which conflict to show, and how.
#[derive(Args)]
pub struct ShowArgs {
    #[command(flatten)]
    choice: Choice,
    /// Write the kind and the time left beside the conflict.
    #[arg(long)]
    label: bool,
    /// Close sumo-gui at the end, and do not halt at the worst step.
    #[arg(long)]
    quit_on_end: bool,
}

/// Draws the clip and prints the file's name.
pub fn clip(arguments: &ClipArgs) -> Result<()> {
    let ClipArgs { choice, out, quiet } = arguments;
    check_is_svg(out)?;
    check_keeps_logs(out, std::slice::from_ref(&choice.conflict.folder), choice.net.as_deref())?;
    let playback = choice.find()?;
    if !quiet {
        playback.notes.iter().for_each(|note| eprintln!("closecall: {note}"));
    }
    output_file::write(out, svg(&playback).as_bytes())?;
    if *quiet {
        return Ok(());
    }
    let conflict = &playback.conflict;
    say(format_args!("conflict {} at {} s in {}; a browser plays it\n", conflict.id, conflict.time, out.display()))
}

/// Shows the clip in sumo-gui.
pub fn show(arguments: &ShowArgs, sumo: Option<Sumo>) -> Result<()> {
    let Some(sumo) = sumo else { return no_sumo() };
    let playback = arguments.choice.find()?;
    if playback.net.is_none() {
        return Err(value("sumo-gui shows nothing without a net; --net gives one, and closecall clip needs none"));
    }
    playback.notes.iter().for_each(|note| eprintln!("closecall: {note}"));
    let scene = serde_json::to_string(&playback.show()).map_err(|error| value(error.to_string()))?;
    (sumo.show)(&ShowRequest { scene, label: arguments.label, quit_on_end: arguments.quit_on_end })
}

fn check_is_svg(out: &Path) -> Result<()> {
    match out.extension().and_then(|extension| extension.to_str()) {
        Some("svg") => Ok(()),
        _ => Err(value(format!(
            "{}: a clip is an SVG, which browsers play; name the file .svg. Screen recorders make films of it",
            out.display()
        ))),
    }
}
