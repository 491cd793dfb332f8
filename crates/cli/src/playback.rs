//! `closecall clip` and `closecall show`: a conflict of a log, played.

use std::path::{Path, PathBuf};

use clap::Args;

use super::error::Result;
use super::print::{print, value};
use super::selector::SelectorArgs;
use super::sumo::{FilmRequest, ShowRequest, Sumo, no_sumo};
use closecall_analysis::logged::check_keeps_logs;
use closecall_analysis::playback::{Playback, stills, svg};
use closecall_run::output::font::FONT;
use closecall_run::util::output_file;

/// Pictures a second of a film: two for each of the steps of 0.1 s that most runs have.
const RATE: u32 = 20;

/// Which conflict, and on what to draw it.
#[derive(Args)]
struct Choice {
    #[command(flatten)]
    conflict: SelectorArgs,
    /// Net [default: the net file named in the log].
    #[arg(short, long, value_name = "NET")]
    net: Option<PathBuf>,
}

impl Choice {
    fn find(&self) -> Result<Playback> {
        Ok(Playback::find(&self.conflict.folder, self.conflict.which(), self.net.as_deref())?)
    }
}

/// Which conflict to draw, and where to.
#[derive(Args)]
pub(crate) struct ClipArgs {
    #[command(flatten)]
    choice: Choice,
    /// File to write: .svg, an animated picture that browsers play, or a film, .webp or .mp4 (`closecall[video]`).
    #[arg(short, long, value_name = "FILE", default_value = "clip.svg")]
    out: PathBuf,
    /// Print only errors.
    #[arg(short, long)]
    quiet: bool,
}

/// Which conflict to show, and how.
#[derive(Args)]
pub(crate) struct ShowArgs {
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
pub fn clip(arguments: &ClipArgs, sumo: Option<Sumo>) -> Result<()> {
    let ClipArgs { choice, out, quiet } = arguments;
    let format = Format::of(out)?;
    check_keeps_logs(out, std::slice::from_ref(&choice.conflict.folder), choice.net.as_deref())?;
    let playback = choice.find()?;
    let bytes = match format {
        Format::Svg => svg(&playback).into_bytes(),
        Format::Film(format) => film(&playback, format, sumo)?,
    };
    if !quiet {
        playback.notes.iter().for_each(|note| eprintln!("closecall: {note}"));
    }
    output_file::write(out, &bytes)?;
    if *quiet {
        return Ok(());
    }
    let conflict = &playback.conflict;
    print(format_args!("conflict {} at {} s in {}{}\n", conflict.id, conflict.time, out.display(), format.hint()))
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
    Ok((sumo.show)(&ShowRequest { scene, label: arguments.label, quit_on_end: arguments.quit_on_end })?)
}

fn film(playback: &Playback, format: &'static str, sumo: Option<Sumo>) -> Result<Vec<u8>> {
    let Some(sumo) = sumo else {
        return Err(value(
            "this binary was built without Python, which makes films; `pip install 'closecall[video]'` gives one that can",
        ));
    };
    let pictures = stills(playback, f64::from(RATE));
    Ok((sumo.film)(&FilmRequest { pictures, rate: RATE, format, font: FONT })?)
}

/// What a clip is written as.
#[derive(Clone, Copy)]
enum Format {
    Svg,
    Film(&'static str),
}

impl Format {
    /// That of a file's extension.
    fn of(out: &Path) -> Result<Self> {
        match out.extension().and_then(|extension| extension.to_str()) {
            Some("svg") => Ok(Self::Svg),
            Some("webp") => Ok(Self::Film("webp")),
            Some("mp4") => Ok(Self::Film("mp4")),
            _ => Err(value(format!("{}: a clip is a .svg, which browsers play, a .webp or an .mp4", out.display()))),
        }
    }

    fn hint(self) -> &'static str {
        match self {
            Self::Svg => "; a browser plays it",
            Self::Film(_) => "",
        }
    }
}
