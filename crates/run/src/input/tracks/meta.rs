//! The files beside a table of tracks: `00_tracksMeta.csv` with the classes, `00_recordingMeta.csv` with the frame rate.

use std::path::{Path, PathBuf};

use rustc_hash::FxHashMap;

use super::table::{self, Cell};
use crate::Result;
use crate::util::header::{self, Wanted};

/// What the files beside a table say: the frames per second, and the classes of the road users by id.
#[derive(Default)]
pub(super) struct Meta {
    pub frame_rate: Option<f64>,
    /// None without such a file.
    pub class_of: Option<FxHashMap<String, String>>,
    /// What is doubtful, a line each.
    pub remarks: Vec<String>,
}

/// Reads those of the files beside `00_tracks.csv` that exist.
pub(super) fn read_meta(path: &Path) -> Result<Meta> {
    let mut meta = Meta::default();
    if let Some(file) = beside(path, "recordingMeta") {
        let begin = |names: &[String]| Ok(vec![(column(names, &["frameRate"])?, Wanted::Number)]);
        let remark = table::read(&file, begin, |cells| {
            let found = cells.first().map(Cell::number).transpose()?.flatten();
            meta.frame_rate =
                Some(found.filter(|rate| *rate > 0.0).ok_or("column frameRate: a number above 0 is needed")?);
            Ok(true)
        })?;
        meta.remarks.extend(remark);
    }
    if let Some(file) = beside(path, "tracksMeta") {
        let begin = |names: &[String]| {
            let columns = [column(names, &["trackId", "id"])?, column(names, &["class"])?];
            Ok(columns.map(|place| (place, Wanted::Text)).to_vec())
        };
        let mut class_of = FxHashMap::default();
        let remark = table::read(&file, begin, |cells| {
            let text = |place: usize| cells.get(place).map(|cell| cell.text().into_owned()).unwrap_or_default();
            class_of.insert(text(0), text(1));
            Ok(true)
        })?;
        meta.remarks.extend(remark);
        meta.class_of = Some(class_of);
    }
    Ok(meta)
}

fn column(names: &[String], wanted: &[&str]) -> std::result::Result<usize, String> {
    for name in wanted {
        if let Some(place) = header::any_case(names, name)? {
            return Ok(place);
        }
    }
    Err(format!("it has no column {}", wanted.join(" or ")))
}

/// A file of the same recording, if it is there.
pub(super) fn beside(path: &Path, what: &str) -> Option<PathBuf> {
    Some(path.with_file_name(name_beside(path, what)?)).filter(|file| file.is_file())
}

/// The name of a file of the same recording; none where the name of the table does not tell it.
pub(super) fn name_beside(path: &Path, what: &str) -> Option<String> {
    let (before, after) = path.file_name()?.to_str()?.split_once("tracks")?;
    Some(format!("{before}{what}{after}"))
}
