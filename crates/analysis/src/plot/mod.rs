//! `closecall plot`: the report's charts as PNG or SVG, for papers.
//!
//! Map, time line and distributions become one file each, in the colours of the report's light page, for a screen or for
//! the column of a paper. The font is part of
//! the crate, so the pictures are the same on every machine.

mod chart;
mod charts;
pub(crate) mod file;
pub(crate) mod font;
mod map;

use std::fs;
use std::path::{Path, PathBuf};

use plotters::coord::Shift;
use plotters::prelude::{DrawingArea, DrawingBackend, WHITE};

use super::dataset::{self, Conflicts};
use super::filter::ConflictFilter;
use super::logged::{LostRows, Progress, check_keeps_logs};
use crate::{Error, Result};
use chart::{Chart, message};

pub use chart::PictureStyle;

/// Width and height of the map, and of the other charts, in pixels.
const SIZES: [(u32, u32); 2] = [(1600, 1200), (1200, 740)];
/// The same in a paper.
const SIZES_IN_PAPER: [(u32, u32); 2] = [(PictureStyle::WIDTH, 1240), (PictureStyle::WIDTH, 1040)];

/// The format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum PictureFormat {
    /// Pixels.
    Png,
    /// Lines and text.
    Svg,
}

/// What was drawn.
#[derive(Clone, Debug)]
pub struct Made {
    /// The pictures.
    pub files: Vec<PathBuf>,
    /// How many conflicts are none of traffic's, and why, in words.
    pub set_aside: Option<String>,
    /// The logs that lack rows.
    pub lost: Vec<LostRows>,
}

/// Draws the charts of the logs in `folders` into the folder `out`, which is created if necessary.
///
/// # Errors
/// Those of reading the logs, of an output that is one of them, and of writing a picture.
pub fn write(
    folders: &[PathBuf],
    net: Option<&Path>,
    filter: &ConflictFilter,
    (out, format, style): (&Path, PictureFormat, PictureStyle),
    progress: &mut Progress,
) -> Result<Made> {
    if (format, style) == (PictureFormat::Png, PictureStyle::Paper) {
        return Err(Error::Value(
            "--style paper is for --format svg: a paper's pictures are lines, not pixels".to_owned(),
        ));
    }
    let conflicts = dataset::read(folders, net, filter, progress)?;
    fs::create_dir_all(out).map_err(|source| Error::file(out, source))?;
    font::register()?;
    let [map, chart] = if style == PictureStyle::Paper { SIZES_IN_PAPER } else { SIZES };
    let from = (&conflicts, net);
    let mut files = vec![picture((out, "map"), (format, style, map), from, map::Map)?];
    files.push(picture((out, "time"), (format, style, chart), from, charts::TimeLine)?);
    for measure in &charts::MEASURES {
        files.push(picture((out, measure.name), (format, style, chart), from, charts::Distribution(measure))?);
    }
    Ok(Made { files, set_aside: conflicts.set_aside, lost: conflicts.lost })
}

/// Draws one chart into the file `name` with the format's extension.
fn picture(
    (out, name): (&Path, &str),
    (format, style, size): (PictureFormat, PictureStyle, (u32, u32)),
    (conflicts, net): (&Conflicts, Option<&Path>),
    chart: impl Chart,
) -> Result<PathBuf> {
    let path = out.join(match format {
        PictureFormat::Png => format!("{name}.png"),
        PictureFormat::Svg => format!("{name}.svg"),
    });
    check_keeps_logs(&path, &conflicts.logs, net)?;
    match format {
        PictureFormat::Png => file::png(&path, size, |area| on(&area, conflicts, style, &chart))?,
        PictureFormat::Svg => {
            let width = (style == PictureStyle::Paper).then_some(PictureStyle::COLUMN);
            file::svg(&path, size, width, |area| on(&area, conflicts, style, &chart))?;
        }
    }
    Ok(path)
}

fn on<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    conflicts: &Conflicts,
    style: PictureStyle,
    chart: &impl Chart,
) -> std::result::Result<(), String> {
    area.fill(&WHITE).map_err(message)?;
    chart.draw(area, conflicts, style)?;
    area.present().map_err(message)
}
