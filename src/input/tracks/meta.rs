//! The files beside a table of tracks: `00_tracksMeta.csv` with the classes, `00_recordingMeta.csv` with the frame rate.

use std::path::{Path, PathBuf};

use rustc_hash::FxHashMap;

use super::table::{self, Cell};
use crate::Result;

/// What the files beside a table say: the frames per second, and the classes of the road users by id.
#[derive(Default)]
pub(super) struct Meta {
    pub frame_rate: Option<f64>,
    pub class_of: FxHashMap<String, String>,
}

/// Reads those of the files beside `00_tracks.csv` that exist.
pub(super) fn read_meta(path: &Path) -> Result<Meta> {
    let mut meta = Meta::default();
    if let Some(file) = beside(path, "recordingMeta") {
        let place = std::cell::Cell::new(0);
        let begin = |names: &[String]| column(names, &["frameRate"]).map(|found| place.set(found));
        table::read(&file, begin, |cells| {
            let found = cells.get(place.get()).map(Cell::number).transpose()?.flatten();
            meta.frame_rate =
                Some(found.filter(|rate| *rate > 0.0).ok_or("column frameRate: a number above 0 is needed")?);
            Ok(())
        })?;
    }
    if let Some(file) = beside(path, "tracksMeta") {
        let places = std::cell::Cell::new([0, 0]);
        let begin = |names: &[String]| {
            places.set([column(names, &["trackId", "id"])?, column(names, &["class"])?]);
            Ok(())
        };
        table::read(&file, begin, |cells| {
            let text = |place: usize| cells.get(place).map(|cell| cell.text().into_owned()).unwrap_or_default();
            meta.class_of.insert(text(places.get()[0]), text(places.get()[1]));
            Ok(())
        })?;
    }
    Ok(meta)
}

fn column(names: &[String], wanted: &[&str]) -> std::result::Result<usize, String> {
    let place = names.iter().position(|name| wanted.iter().any(|wanted| name.eq_ignore_ascii_case(wanted)));
    place.ok_or_else(|| format!("it has no column {}", wanted.join(" or ")))
}

/// A file of the same recording, if it is there.
pub(super) fn beside(path: &Path, what: &str) -> Option<PathBuf> {
    let name = path.file_name()?.to_str()?;
    let (before, after) = name.split_once("tracks")?;
    Some(path.with_file_name(format!("{before}{what}{after}"))).filter(|file| file.is_file())
}
