//! Identifies a file, lists what it lacks, and gives the command that replays it.

use std::fmt::Write;
use std::path::Path;

use super::detect::{format_of, is_markup};
use super::format::RecordingFormat;
use super::guess::{Guess, guess};
use super::layouts::Layout;
use super::mapping::Mapping;
use super::meta::beside;
use super::table;
use crate::Result;
use crate::input::replay::recording::Recording;
use crate::input::scenario_kind::SumoFile;

/// Identifies a file, with what it lacks and the command that replays it.
///
/// # Errors
/// [`crate::Error::File`] where it cannot be read; the errors of a recording that is broken at its beginning.
pub fn inspect(path: &Path) -> Result<String> {
    let file = path.display();
    if let Some(known) = SumoFile::of(path).filter(|known| *known != SumoFile::Recording) {
        return Ok(format!("{file}: {}\n{}\n", known.name(), known.advice(path)));
    }
    let mut text = String::new();
    // Writing to a String cannot fail.
    match format_of(path)? {
        RecordingFormat::Fcd => match Recording::open(path) {
            Ok(_) => {
                _ = writeln!(text, "{file}: SUMO's fcd-output");
                _ = writeln!(text, "closecall replay {file} --net NET");
            }
            Err(error) => {
                // A table of no known layout, or no recording.
                let Ok(names) = table::names(path) else { return Err(error) };
                if is_markup(path)? {
                    return Err(error);
                }
                unknown(&mut text, path, &names)?;
            }
        },
        RecordingFormat::Trj => {
            _ = writeln!(text, "{file}: SSAM's trajectories (.trj)");
            _ = writeln!(text, "missing: types, persons");
            _ = writeln!(text, "closecall replay {file} --path arc");
        }
        RecordingFormat::Fzp => {
            _ = writeln!(text, "{file}: Vissim's vehicle record (.fzp)");
            _ = writeln!(text, "closecall replay {file} --path arc");
        }
        format => layout(&mut text, path, format)?,
    }
    Ok(text)
}

fn layout(text: &mut String, path: &Path, format: RecordingFormat) -> Result<()> {
    let Some(layout) = Layout::of(format) else { return Ok(()) };
    let names = table::names(path)?;
    _ = writeln!(text, "{}: {} tracks, by its columns", path.display(), layout.name);
    _ = writeln!(text, "columns: {}", layout.columns.split(',').map(str::trim).collect::<Vec<_>>().join(","));
    let mapping = Mapping::parse(layout.columns);
    let mut lacking = mapping.iter().flat_map(|mapping| mapping.lacking(&names)).map(str::to_owned).collect::<Vec<_>>();
    let mut rate = "";
    if layout.has_meta {
        if beside(path, "tracksMeta").is_some() {
            lacking.retain(|name| name != "class");
        } else {
            lacking.push("the file tracksMeta beside it, with the classes".to_owned());
        }
        if beside(path, "recordingMeta").is_none() {
            lacking.push("the file recordingMeta beside it, with the frame rate".to_owned());
            rate = " --frame-rate 25";
        }
    }
    if !lacking.is_empty() {
        _ = writeln!(text, "missing: {}", lacking.join(", "));
    }
    let name = format.name();
    _ = writeln!(text, "closecall replay {} --format {name}{rate} --path arc", path.display());
    Ok(())
}

/// A table of no known layout: a guess by the names of its columns and its first rows.
fn unknown(text: &mut String, path: &Path, names: &[String]) -> Result<()> {
    _ = writeln!(text, "{}: a table of no known layout, with the columns {}", path.display(), names.join(", "));
    let Guess { columns, missing, frame_rate } = guess(path, names)?;
    if !missing.is_empty() {
        _ = writeln!(text, "missing: {}: name their columns where the command says COLUMN", missing.join(", "));
    }
    match frame_rate {
        Some((rate, true)) => _ = writeln!(text, "frames: the speeds show {rate} a second"),
        Some((rate, false)) => _ = writeln!(text, "missing: the frames per second: {rate} is a guess"),
        None => {}
    }
    let rate = frame_rate.map_or(String::new(), |(rate, _)| format!(" --frame-rate {rate}"));
    // Brackets and blanks mean something to a shell.
    let is_plain = columns.chars().all(|it| it.is_alphanumeric() || "=,_.-".contains(it));
    let columns = if is_plain { columns } else { format!("'{columns}'") };
    _ = writeln!(text, "closecall replay {} --columns {columns}{rate} --path arc", path.display());
    Ok(())
}
