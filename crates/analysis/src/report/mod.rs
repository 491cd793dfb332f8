//! `closecall report`: turns logs into one HTML page that needs nothing but a browser.
//!
//! The page is a template (`page.html`) with its style, the chart library, the data as JSON columns, and the scripts
//! that draw them. All of them are in one file, which works offline and sends nothing anywhere.

mod clips;
mod contact;
mod data;
mod faults;
mod movements;
mod page_net;
mod reading;
mod remarks;
mod streets;

use std::path::{Path, PathBuf};

use super::dataset::read;
use super::filter::ConflictFilter;
use super::logged::{LostRows, Progress, check_keeps_logs};
use super::statistics::Effects;
use super::style;
use closecall_run::Result;
use closecall_run::util::output_file::OutputFile;

/// The template, with a mark for each part.
const PAGE: &str = include_str!("page.html");
/// The parts of the page with their marks, in the order of the page.
const STYLE: &str = "{{style}}";
const DATA: &str = "{{data}}";
const LIBRARY: (&str, &str) = ("{{library}}", include_str!("vendor/echarts.min.js"));
const SCRIPTS: &str = "{{scripts}}";
/// The page's own scripts, each after those that it needs.
const OWN_SCRIPTS: [&str; 22] = [
    include_str!("script/data.js"),
    include_str!("script/filter.js"),
    include_str!("script/scope.js"),
    include_str!("script/colours.js"),
    include_str!("script/roads.js"),
    include_str!("script/words.js"),
    include_str!("script/density.js"),
    include_str!("script/signs.js"),
    include_str!("script/map.js"),
    include_str!("script/faults.js"),
    include_str!("script/charts.js"),
    include_str!("script/movements.js"),
    include_str!("script/spots.js"),
    include_str!("script/verdict.js"),
    include_str!("script/clip.js"),
    include_str!("script/curves.js"),
    include_str!("script/player.js"),
    include_str!("script/tables.js"),
    include_str!("script/opened.js"),
    include_str!("script/against.js"),
    include_str!("script/export.js"),
    include_str!("script/page.js"),
];

/// The size of a report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Made {
    /// The number of logs.
    pub runs: usize,
    /// The number of conflicts in the logs.
    pub conflicts: u64,
    /// How many others are none of traffic's, and why, in words.
    pub set_aside: Option<String>,
    /// The size of the page in bytes.
    pub bytes: usize,
    /// The logs that lack rows.
    pub lost: Vec<LostRows>,
}

/// What a report is made of.
#[derive(Clone, Debug)]
pub struct Request<'a> {
    /// Logs, or folders of logs.
    pub folders: &'a [PathBuf],
    /// Those to compare with; empty for no comparison.
    pub against: &'a [PathBuf],
    /// The net; none for the one in the first log.
    pub net: Option<&'a Path>,
    /// Which conflicts count.
    pub filter: &'a ConflictFilter,
}

/// Writes a report to `out`.
///
/// # Errors
/// Those of reading the logs, of an output that is one of them, and of writing `out`.
pub fn write(request: &Request, out: &Path, progress: &mut Progress) -> Result<Made> {
    let Request { folders, against, net, filter } = *request;
    check_keeps_logs(out, &[folders, against].concat(), net)?;
    let conflicts = read(folders, net, filter, progress)?;
    let runs = conflicts.logs.len();
    let (seen, set_aside) = (conflicts.seen, conflicts.set_aside.clone());
    let mut lost = conflicts.lost.clone();
    let before = if against.is_empty() {
        None
    } else {
        let (effects, lost_before) = Effects::of(folders, against, filter, progress)?;
        lost.extend(lost_before.into_iter().filter(|rows| !conflicts.lost.contains(rows)));
        Some(data::before(&effects, &read(against, net, filter, progress)?))
    };
    let data = data::json(conflicts, before)?;
    let mut file = OutputFile::create(out)?;
    let mut bytes = 0;
    page(&data, |part| {
        bytes += part.len();
        file.append(part.as_bytes())
    })?;
    file.finish()?;
    Ok(Made { runs, conflicts: seen, set_aside, bytes, lost })
}

/// Writes the page, each mark replaced by its part. The parts themselves are not searched for marks, since an id may look like
/// one.
fn page(data: &str, mut write: impl FnMut(&str) -> Result<()>) -> Result<()> {
    let scripts = OWN_SCRIPTS.concat();
    let style = style::sheet();
    let mut rest = PAGE;
    for (mark, part) in [(STYLE, &*style), (DATA, data), LIBRARY, (SCRIPTS, &scripts)] {
        let (before, after) = rest.split_once(mark).unwrap_or((rest, ""));
        write(before)?;
        write(part)?;
        rest = after;
    }
    write(rest)
}

#[cfg(test)]
mod tests {
    use crate::report::*;

    #[test]
    fn every_part_has_one_mark_and_ends_no_script() {
        for mark in [STYLE, DATA, LIBRARY.0, SCRIPTS] {
            assert_eq!(PAGE.matches(mark).count(), 1, "{mark}");
        }
        for script in OWN_SCRIPTS.iter().chain([&LIBRARY.1]) {
            assert!(!script.contains("</script"));
        }
    }

    #[test]
    fn data_that_looks_like_a_mark_stays_data() {
        let mut text = String::new();
        page("[\"{{scripts}}\"]", |part| {
            text += part;
            Ok(())
        })
        .unwrap();
        assert!(text.contains("[\"{{scripts}}\"]"));
    }
}
