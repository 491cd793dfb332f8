//! What a file is taken for, what it lacks, and the command that replays it.

use std::fmt::Write;
use std::path::Path;

use super::detect::format_of;
use super::format::RecordingFormat;
use super::layouts::Layout;
use super::mapping::{Mapping, has};
use super::meta::beside;
use super::table;
use crate::Result;
use crate::input::replay::recording::Recording;

/// Columns that are often called like this, by what `--columns` calls them: a guess for a table of no known layout.
const USUAL: [(&str, &[&str]); 10] = [
    ("id", &["id", "track_id", "trackid", "vehicle_id", "object_id", "agent_id"]),
    ("time", &["time", "t", "timestamp", "seconds"]),
    ("frame", &["frame", "frame_id", "frameid", "framenum"]),
    ("x", &["x", "x_m", "xcenter", "x_center", "pos_x", "utm_x"]),
    ("y", &["y", "y_m", "ycenter", "y_center", "pos_y", "utm_y"]),
    ("heading", &["heading", "heading_rad", "yaw", "psi_rad", "orientation"]),
    ("speed", &["speed", "v", "velocity"]),
    ("length", &["length", "l"]),
    ("width", &["width", "w"]),
    ("class", &["class", "type", "agent_type", "category"]),
];

/// Tells what a file is taken for, what it lacks, and the command that replays it.
///
/// # Errors
/// [`crate::Error::File`] where it cannot be read; the errors of a recording that is broken at its beginning.
pub fn inspect(path: &Path) -> Result<String> {
    let file = path.display();
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
                unknown(&mut text, path, &names);
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
    let name = name(format);
    _ = writeln!(text, "closecall replay {} --format {name}{rate} --path arc", path.display());
    Ok(())
}

/// The name of a format on the command line.
fn name(format: RecordingFormat) -> &'static str {
    match format {
        RecordingFormat::Fcd => "fcd",
        RecordingFormat::Trj => "trj",
        RecordingFormat::Fzp => "fzp",
        RecordingFormat::Table => "table",
        RecordingFormat::InD => "inD",
        RecordingFormat::HighD => "highD",
        RecordingFormat::Ngsim => "ngsim",
        RecordingFormat::Interaction => "interaction",
        RecordingFormat::Sind => "sind",
        RecordingFormat::CitySim => "citysim",
        RecordingFormat::OmegaPrime => "omega-prime",
    }
}

/// A table of no known layout: a guess by the names of its columns.
fn unknown(text: &mut String, path: &Path, names: &[String]) {
    _ = writeln!(text, "{}: a table of no known layout, with the columns {}", path.display(), names.join(", "));
    let usual =
        |wanted: &[&str]| names.iter().find(|name| wanted.iter().any(|wanted| name.eq_ignore_ascii_case(wanted)));
    let guessed = USUAL.iter().map(|(key, wanted)| (*key, usual(wanted)));
    let has_time = has(names, "time") || usual(USUAL[1].1).is_some();
    let guessed = guessed.filter(|(key, _)| *key != "frame" || !has_time);
    let needed = |key: &str| ["id", "x", "y"].contains(&key) || key == if has_time { "time" } else { "frame" };
    let mut columns = Vec::new();
    let mut missing = Vec::new();
    for (key, found) in guessed {
        match found {
            Some(name) => columns.push(format!("{key}={name}")),
            None if needed(key) => {
                columns.push(format!("{key}=COLUMN"));
                missing.push(key);
            }
            None => {}
        }
    }
    if !missing.is_empty() {
        _ = writeln!(text, "missing: {}: name their columns where the command says COLUMN", missing.join(", "));
    }
    let rate = if has_time { "" } else { " --frame-rate 25" };
    _ = writeln!(text, "closecall replay {} --columns {}{rate} --path arc", path.display(), columns.join(","));
}
