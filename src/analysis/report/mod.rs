//! `closecall report`: logs become one HTML page that needs nothing but a browser.
//!
//! The page is a template (`page.html`) with its style, the chart library, the data as JSON columns, and the scripts
//! that draw them, all within the file: it works offline and sends nothing anywhere.

mod data;
mod roads;

use std::fs;
use std::path::{Path, PathBuf};

use super::dataset::read;
use crate::{Error, Result};

/// The page, with a mark for each part.
const PAGE: &str = include_str!("page.html");
/// The parts of the page, each with its mark, in the order of the page.
const STYLE: (&str, &str) = ("{{style}}", include_str!("report.css"));
const DATA: &str = "{{data}}";
const LIBRARY: (&str, &str) = ("{{library}}", include_str!("vendor/echarts.min.js"));
const SCRIPTS: &str = "{{scripts}}";
/// The page's own scripts, in the order in which they need each other.
const OWN_SCRIPTS: [&str; 8] = [
    include_str!("script/data.js"),
    include_str!("script/colours.js"),
    include_str!("script/roads.js"),
    include_str!("script/map.js"),
    include_str!("script/charts.js"),
    include_str!("script/words.js"),
    include_str!("script/tables.js"),
    include_str!("script/page.js"),
];

/// What a report was made of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Made {
    /// How many logs.
    pub runs: usize,
    /// How many conflicts are in them.
    pub conflicts: u64,
    /// Size of the page in bytes.
    pub bytes: usize,
}

/// Writes the report of the logs in `folders`: each a log itself, or a folder of logs.
///
/// The net is read from `net`, or from where the first log says it was.
///
/// # Errors
/// As [`fn@read`] has them, and [`Error::File`] where `out` cannot be written.
pub fn write(folders: &[PathBuf], net: Option<&Path>, out: &Path) -> Result<Made> {
    let conflicts = read(folders, net)?;
    let (runs, seen) = (conflicts.logs.len(), conflicts.seen);
    let page = page(&data::json(conflicts));
    fs::write(out, &page).map_err(|source| Error::file(out, source))?;
    Ok(Made { runs, conflicts: seen, bytes: page.len() })
}

/// Puts the parts where their marks are. What a part holds is not looked at again: ids may look like a mark.
fn page(data: &str) -> String {
    let scripts = OWN_SCRIPTS.concat();
    let mut page = String::with_capacity(data.len() + LIBRARY.1.len() + (1 << 17));
    let mut rest = PAGE;
    for (mark, part) in [STYLE, (DATA, data), LIBRARY, (SCRIPTS, &scripts)] {
        let (before, after) = rest.split_once(mark).unwrap_or((rest, ""));
        page.extend([before, part]);
        rest = after;
    }
    page + rest
}

#[cfg(test)]
mod tests {
    use crate::analysis::report::*;

    #[test]
    fn every_part_has_its_place_on_the_page_and_ends_no_script() {
        for mark in [STYLE.0, DATA, LIBRARY.0, SCRIPTS] {
            assert_eq!(PAGE.matches(mark).count(), 1, "{mark}");
        }
        for script in OWN_SCRIPTS.iter().chain([&LIBRARY.1]) {
            assert!(!script.contains("</script"));
        }
    }

    #[test]
    fn data_that_look_like_a_mark_stay_data() {
        assert!(page("[\"{{scripts}}\"]").contains("[\"{{scripts}}\"]"));
    }
}
