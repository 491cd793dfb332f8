//! `closecall plot`: the report's charts as PNG or SVG, for papers.
//!
//! Map, time line and distributions become one file each, in the colours of the report's light page. The font is part of
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
use super::logged::{LostRows, Progress, check_keeps_logs};
use crate::{Error, Result};
use chart::{Chart, message};

/// Width and height of the map, in pixels.
const MAP_SIZE: (u32, u32) = (1600, 1200);
/// Width and height of the other charts, in pixels.
const CHART_SIZE: (u32, u32) = (1200, 700);

/// The format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum PictureFormat {
    /// Pixels.
    Png,
    /// Lines and text.
    Svg,
}

/// Draws the charts of the logs in `folders` into the folder `out`, which is created if necessary; returns the files, and
/// the logs that lack rows.
///
/// # Errors
/// Those of reading the logs, of an output that is one of them, and of writing a picture.
pub fn write(
    folders: &[PathBuf],
    net: Option<&Path>,
    out: &Path,
    format: PictureFormat,
    progress: &mut Progress,
) -> Result<(Vec<PathBuf>, Vec<LostRows>)> {
    let conflicts = dataset::read(folders, net, progress)?;
    fs::create_dir_all(out).map_err(|source| Error::file(out, source))?;
    font::register()?;
    let from = (&conflicts, net);
    let mut files = vec![picture(out, "map", format, MAP_SIZE, from, map::Map)?];
    files.push(picture(out, "time", format, CHART_SIZE, from, charts::TimeLine)?);
    for measure in &charts::MEASURES {
        files.push(picture(out, measure.name, format, CHART_SIZE, from, charts::Distribution(measure))?);
    }
    Ok((files, conflicts.lost))
}

/// Draws one chart into the file `name` with the format's extension.
fn picture(
    out: &Path,
    name: &str,
    format: PictureFormat,
    size: (u32, u32),
    (conflicts, net): (&Conflicts, Option<&Path>),
    chart: impl Chart,
) -> Result<PathBuf> {
    let path = out.join(match format {
        PictureFormat::Png => format!("{name}.png"),
        PictureFormat::Svg => format!("{name}.svg"),
    });
    check_keeps_logs(&path, &conflicts.logs, net)?;
    match format {
        PictureFormat::Png => file::png(&path, size, |area| on(&area, conflicts, &chart))?,
        PictureFormat::Svg => file::svg(&path, size, |area| on(&area, conflicts, &chart))?,
    }
    Ok(path)
}

fn on<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    conflicts: &Conflicts,
    chart: &impl Chart,
) -> std::result::Result<(), String> {
    area.fill(&WHITE).map_err(message)?;
    chart.draw(area, conflicts)?;
    area.present().map_err(message)
}
