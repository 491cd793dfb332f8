//! Recordings of other tools and of drones, turned into the CSV of SUMO's fcd-output, which replay then reads.
//!
//! They come without lanes and types: each road user gets a type of its class and size, and on a net the lane beneath it
//! that leads where it heads.

mod by_track;
mod classes;
mod detect;
mod fcd_row;
mod field;
mod format;
mod fzp;
mod guess;
mod headings;
mod inspect;
mod jumps;
mod kalman;
mod layouts;
mod mapped_table;
mod mapping;
mod matching;
mod meta;
mod missing_values;
mod said;
mod smooth;
mod sorted_rows;
mod spill;
mod table;
mod trj;
mod users;

use std::path::{Path, PathBuf};

use tempfile::TempPath;

use crate::input::replay::columns_of_fcd;
use crate::{Error, Result};
use closecall::traffic::net::Net;
use fcd_row::FcdWriter;
pub use format::RecordingFormat;
pub use inspect::inspect;
pub use kalman::USUAL_NOISE;
use mapped_table::Table;
pub use mapping::{NOISE, Origin as TrackOrigin, TrackOptions};
use matching::LaneFinder;
use said::Said;

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
    format: RecordingFormat,
    said: Said,
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
        matches!(self, Self::Converted(converted) if converted.format != RecordingFormat::Trj)
    }

    /// Whether sensors tracked its road users: it is not of a simulation.
    pub fn is_tracked(&self) -> bool {
        self.has_speeds_of_moments()
            && !matches!(self, Self::Converted(converted) if converted.format == RecordingFormat::Fzp)
    }

    /// What had to be assumed for lack of columns that it does not have at all, a line each.
    pub fn missing(&self) -> &[String] {
        match self {
            Self::Fcd(_) => &[],
            Self::Converted(converted) => &converted.said.missing,
        }
    }

    /// What had to be assumed because of what is in it, a line each.
    pub fn doubtful(&self) -> &[String] {
        match self {
            Self::Fcd(_) => &[],
            Self::Converted(converted) => &converted.said.doubtful,
        }
    }
}

/// Opens a recording: in the format that is asked for, or that its first bytes tell. Several files are tables of trajectories of one time
/// base. `stopped` is asked now and then whether to stop.
///
/// # Errors
/// An error that names the file, the row and the column, and what was expected there; [`Error::Stopped`].
pub fn open(
    paths: &[PathBuf],
    options: &TrackOptions,
    net: Option<&Net>,
    stopped: &mut dyn FnMut() -> bool,
) -> Result<Opened> {
    let formats = paths.iter().map(|path| match options.format {
        Some(format) => Ok(format),
        None if !options.columns.is_empty() => Ok(RecordingFormat::Table),
        None => detect::format_of(path),
    });
    let formats = formats.collect::<Result<Vec<_>>>()?;
    let (Some(path), Some(format)) = (paths.first(), formats.first().copied()) else {
        return Err(Error::Value("a recording is needed".to_owned()));
    };
    for (path, format) in paths.iter().zip(&formats) {
        let is_table = !matches!(format, RecordingFormat::Fcd | RecordingFormat::Trj | RecordingFormat::Fzp);
        if options.smooth.is_some() && !is_table {
            let message =
                "a simulation recorded it, so that its places have no noise: --smooth is for tables of trajectories";
            return Err(Error::content(path, message));
        }
        if paths.len() > 1 && !is_table {
            let name = format.name();
            let message =
                format!("several files may only be tables of trajectories, and this is {name} (closecall inspect)");
            return Err(Error::content(path, message));
        }
    }
    if format == RecordingFormat::Fcd {
        return Ok(Opened::Fcd(path.to_owned()));
    }
    let mut writer = FcdWriter::create(net.map(LaneFinder::new))?;
    let mut said = match format {
        RecordingFormat::Trj => trj::convert(path, net, &mut writer)?,
        RecordingFormat::Fzp => fzp::convert(path, &mut writer)?,
        _ => {
            let mut tables = Vec::new();
            for (path, format) in paths.iter().zip(formats) {
                tables.push(Table { path, mapping: layouts::mapping_of(format, options)?, names: table::names(path)? });
            }
            sorted_rows::convert(&tables, options.smooth, stopped, &mut writer)?
        }
    };
    said.doubtful.extend(writer.remarks());
    let (fcd, types) = writer.finish().map_err(|source| Error::file(path, source))?;
    Ok(Opened::Converted(Converted { fcd, types, format, said }))
}

/// The places of the columns that are read of a table with columns of these names.
///
/// # Errors
/// [`Error::Value`] for options that cannot be used, or a column that is missing.
pub fn columns_read(names: &[String], options: &TrackOptions) -> Result<Vec<usize>> {
    let known = || layouts::Layout::known(names).map(|layout| layout.format);
    let format =
        options.format.or_else(|| if options.columns.is_empty() { known() } else { Some(RecordingFormat::Table) });
    match format {
        Some(format) if ![RecordingFormat::Fcd, RecordingFormat::Trj, RecordingFormat::Fzp].contains(&format) => {
            let places = layouts::mapping_of(format, options)?.places(names, &[]).map_err(Error::Value)?;
            let mut read = places.read.into_iter().map(|(place, _)| place).collect::<Vec<_>>();
            // One column may be several things.
            read.sort_unstable();
            read.dedup();
            Ok(read)
        }
        _ => columns_of_fcd(names),
    }
}
