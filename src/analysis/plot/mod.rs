//! `closecall plot`: the report's charts as PNG or SVG, for papers.
//!
//! Map, time line and distributions, each a file, with the colours of the report's light page. The font is within the
//! crate: the same pictures on every machine.

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
use crate::{Error, Result};
use chart::{Chart, said};

/// Width and height of a map.
const MAP_SIZE: (u32, u32) = (1600, 1200);
/// Width and height of any other chart.
const CHART_SIZE: (u32, u32) = (1200, 700);

/// What sort of picture to write.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// Pixels.
    Png,
    /// Lines and text.
    Svg,
}

/// Draws the charts of the logs in `folders` into `out`, which is made where it is not there; returns the files.
///
/// # Errors
/// As [`dataset::read`] has them, and [`Error::File`] where a picture cannot be written.
pub fn write(folders: &[PathBuf], net: Option<&Path>, out: &Path, format: Format) -> Result<Vec<PathBuf>> {
    let conflicts = dataset::read(folders, net)?;
    fs::create_dir_all(out).map_err(|source| Error::file(out, source))?;
    font::register()?;
    let mut files = vec![picture(out, "map", format, MAP_SIZE, &conflicts, map::Map)?];
    files.push(picture(out, "time", format, CHART_SIZE, &conflicts, charts::TimeLine)?);
    for measure in &charts::MEASURES {
        files.push(picture(out, measure.name, format, CHART_SIZE, &conflicts, charts::Distribution(measure))?);
    }
    Ok(files)
}

/// Draws one chart into a file of its name.
fn picture(
    out: &Path,
    name: &str,
    format: Format,
    size: (u32, u32),
    conflicts: &Conflicts,
    chart: impl Chart,
) -> Result<PathBuf> {
    let path = out.join(match format {
        Format::Png => format!("{name}.png"),
        Format::Svg => format!("{name}.svg"),
    });
    match format {
        Format::Png => file::png(&path, size, |area| on(&area, conflicts, &chart))?,
        Format::Svg => file::svg(&path, size, |area| on(&area, conflicts, &chart))?,
    }
    Ok(path)
}

fn on<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    conflicts: &Conflicts,
    chart: &impl Chart,
) -> std::result::Result<(), String> {
    area.fill(&WHITE).map_err(said)?;
    chart.draw(area, conflicts)?;
    area.present().map_err(said)
}
