//! Recordings of other tools and of drones, turned into the CSV of SUMO's fcd-output, which replay then reads.
//!
//! They come without lanes and types: each road user gets a type of its class and size, and on a net the lane beneath it
//! that leads where it heads.

mod detect;
mod format;
mod fzp;
mod inspect;
mod jumps;
mod layouts;
mod mapping;
mod matching;
mod meta;
mod rows;
mod sample;
mod smooth;
mod spill;
mod table;
mod trj;

use std::path::{Path, PathBuf};

use tempfile::TempPath;

use crate::traffic::net::Net;
use crate::{Error, Result};
pub use format::RecordingFormat;
pub use inspect::inspect;
pub use mapping::{NOISE, Origin as TrackOrigin, TrackOptions};
use matching::LaneFinder;
use sample::FcdWriter;
pub use smooth::USUAL_NOISE;

/// A recording as files that replay reads; they are gone when it is dropped.
#[derive(Debug)]
pub enum Opened {
    /// It is SUMO's already.
    Fcd(PathBuf),
    /// It was turned into SUMO's.
    Converted(Converted),
}

/// A recording that was turned into SUMO's fcd-output, and its types into an additional file.
#[derive(Debug)]
pub struct Converted {
    fcd: TempPath,
    types: TempPath,
    /// Whether each of its speeds is that of its moment, not the mean of a step.
    has_speeds_of_moments: bool,
    /// What had to be assumed, a line each.
    pub remarks: Vec<String>,
}

impl Opened {
    /// The fcd-output.
    pub fn recording(&self) -> &Path {
        match self {
            Self::Fcd(path) => path,
            Self::Converted(converted) => &converted.fcd,
        }
    }

    /// The file of its types, if they are not SUMO's.
    pub fn types(&self) -> Option<PathBuf> {
        match self {
            Self::Fcd(_) => None,
            Self::Converted(converted) => Some(converted.types.to_path_buf()),
        }
    }

    /// Whether each of its speeds is that of its moment: it was measured, or Vissim simulated it. Other simulations may move vehicles
    /// by the speed of a step's end.
    pub fn has_speeds_of_moments(&self) -> bool {
        matches!(self, Self::Converted(converted) if converted.has_speeds_of_moments)
    }

    /// What had to be assumed, a line each.
    pub fn remarks(&self) -> &[String] {
        match self {
            Self::Fcd(_) => &[],
            Self::Converted(converted) => &converted.remarks,
        }
    }
}

/// Opens a recording: in the format that is asked for, or that its first bytes tell.
///
/// # Errors
/// An error that names the file, the row and the column, and what was expected there.
pub fn open(path: &Path, options: &TrackOptions, net: Option<&Net>) -> Result<Opened> {
    let format = match options.format {
        Some(format) => format,
        None if !options.columns.is_empty() => RecordingFormat::Table,
        None => detect::format_of(path)?,
    };
    if let (Some(_), RecordingFormat::Fcd | RecordingFormat::Trj | RecordingFormat::Fzp) = (options.smooth, format) {
        let message =
            "a simulation recorded it, so that its places have no noise: --smooth is for tables of trajectories";
        return Err(Error::content(path, message));
    }
    if format == RecordingFormat::Fcd {
        return Ok(Opened::Fcd(path.to_owned()));
    }
    let mut writer = FcdWriter::create(net.map(LaneFinder::new))?;
    let remarks = match format {
        RecordingFormat::Trj => trj::convert(path, net, &mut writer)?,
        RecordingFormat::Fzp => fzp::convert(path, &mut writer)?,
        _ => rows::convert(path, &layouts::mapping_of(format, options)?, options.smooth, &mut writer)?,
    };
    let (fcd, types) = writer.finish().map_err(|source| Error::file(path, source))?;
    let has_speeds_of_moments = format != RecordingFormat::Trj;
    Ok(Opened::Converted(Converted { fcd, types, has_speeds_of_moments, remarks }))
}
