//! `closecall report`: turns logs into one HTML page that needs nothing but a browser.
//!
//! The page is a template (`page.html`) with its style, the chart library, the data as JSON columns, and the scripts
//! that draw them. All of them are in one file, which works offline and sends nothing anywhere. `--summary` writes another
//! template (`summary.html`) with the scripts that it needs.

mod approaches;
mod clips;
mod columns;
mod contact;
mod data;
mod faults;
mod movements;
mod page_net;
mod reading;
mod remarks;
mod sink;
mod streets;
mod tiles;

use std::path::{Path, PathBuf};

use super::batch::whatif::sections;
use super::dataset::read;
use super::filter::ConflictFilter;
use super::logged::{LostRows, Progress, check_keeps_logs};
use super::statistics::Effects;
use super::style;
use crate::Result;
use closecall_run::util::output_file::OutputFile;
use data::{Data, Details};
use sink::Sink;

pub use tiles::TileUrl;

/// The marks of a template, each replaced by its part, in the order of the page.
const TILES: &str = "{{tiles}}";
const STYLE: &str = "{{style}}";
const WHAT_IF: &str = "{{whatif}}";
const DATA: &str = "{{data}}";
const LIBRARY: &str = "{{library}}";
const SCRIPTS: &str = "{{scripts}}";

/// A page: its template, and its own scripts, each after those that it needs.
struct Page {
    template: &'static str,
    library: Option<&'static str>,
    /// Whether the screen shows it as it is printed.
    is_sheet: bool,
    scripts: &'static [&'static str],
}

/// The report: map, charts, tables, playback.
const REPORT: Page = Page {
    template: include_str!("page.html"),
    library: Some(include_str!("vendor/echarts.min.js")),
    is_sheet: false,
    scripts: &[
        include_str!("script/data.js"),
        include_str!("script/filter.js"),
        include_str!("script/scope.js"),
        include_str!("script/colours.js"),
        include_str!("script/roads.js"),
        include_str!("script/road_series.js"),
        include_str!("script/tiles.js"),
        include_str!("script/words.js"),
        include_str!("script/density.js"),
        include_str!("script/signs.js"),
        include_str!("script/map.js"),
        include_str!("script/faults.js"),
        include_str!("script/charts.js"),
        include_str!("script/movements.js"),
        include_str!("script/intervals.js"),
        include_str!("script/spots.js"),
        include_str!("script/verdict.js"),
        include_str!("script/clip.js"),
        include_str!("script/curves.js"),
        include_str!("script/player.js"),
        include_str!("script/tables.js"),
        include_str!("script/opened.js"),
        include_str!("script/against.js"),
        include_str!("script/export.js"),
        include_str!("script/header.js"),
        include_str!("script/page.js"),
    ],
};

/// One page to print, for people who decide. Its sentences are those of the report.
const SUMMARY: Page = Page {
    template: include_str!("summary.html"),
    library: None,
    is_sheet: true,
    scripts: &[
        include_str!("script/data.js"),
        include_str!("script/filter.js"),
        include_str!("script/scope.js"),
        include_str!("script/colours.js"),
        include_str!("script/roads.js"),
        include_str!("script/words.js"),
        include_str!("script/movements.js"),
        include_str!("script/intervals.js"),
        include_str!("script/spots.js"),
        include_str!("script/verdict.js"),
        include_str!("script/clip.js"),
        include_str!("script/tables.js"),
        include_str!("script/header.js"),
        include_str!("script/summary.js"),
    ],
};

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

/// The inputs of a report.
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
    /// Whether to write one page for people who decide, instead of the report.
    pub is_summary: bool,
    /// The server of the background map; none for a page that sends no requests.
    pub tiles: Option<&'a TileUrl>,
    /// The folder of roll-outs to show; none for none.
    pub whatif: Option<&'a Path>,
    /// How many of the worst conflicts play; none for as many as keep the page small.
    pub clips: Option<usize>,
}

/// Writes a report to `out`.
///
/// # Errors
/// Those of reading the logs, of an output that is one of them, and of writing `out`.
pub fn write(request: &Request, out: &Path, progress: &mut Progress) -> Result<Made> {
    let Request { folders, against, net, filter, is_summary, tiles, clips, whatif } = *request;
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
    let (shown, details) = if is_summary { (SUMMARY, Details::SUMMARY) } else { (REPORT, Details::REPORT) };
    let details = clips.map_or(details, |clips| details.with_clips(clips));
    let data = Data::of(conflicts, before, details, tiles)?;
    let whatif = whatif.map_or_else(|| Ok(String::new()), sections)?;
    let mut file = OutputFile::create(out)?;
    let mut bytes = 0;
    page(&shown, tiles, &whatif, |to| data.write(to), &mut |part| {
        bytes += part.len();
        Ok(file.append(part)?)
    })?;
    file.finish()?;
    Ok(Made { runs, conflicts: seen, set_aside, bytes, lost })
}

/// Writes the page, each mark replaced by its part. The parts themselves are not searched for marks, since an id may look like
/// one.
fn page(
    page: &Page,
    tiles: Option<&TileUrl>,
    whatif: &str,
    data: impl FnOnce(&mut Sink) -> Result<()>,
    to: &mut Sink,
) -> Result<()> {
    let style = if page.is_sheet { style::sheet().replace("@media print", "@media all") } else { style::sheet() };
    // The policy of the page lets it ask this server only.
    let tiles = tiles.map_or_else(String::new, |tiles| format!(" {}", tiles.origin()));
    let (head, tail) = page.template.split_once(DATA).unwrap_or((page.template, ""));
    fill(head, &[(TILES, &tiles), (STYLE, &style), (WHAT_IF, whatif)], to)?;
    data(to)?;
    fill(tail, &[(LIBRARY, page.library.unwrap_or_default()), (SCRIPTS, &page.scripts.concat())], to)
}

/// Writes a part of a template; marks that it does not have are skipped.
fn fill(template: &str, parts: &[(&str, &str)], to: &mut Sink) -> Result<()> {
    let mut rest = template;
    for (mark, part) in parts {
        if let Some((before, after)) = rest.split_once(mark) {
            to(before.as_bytes())?;
            to(part.as_bytes())?;
            rest = after;
        }
    }
    to(rest.as_bytes())
}

#[cfg(test)]
mod tests {
    use crate::report::*;

    #[test]
    fn every_part_has_one_mark_and_ends_no_script() {
        for page in [REPORT, SUMMARY] {
            for mark in [STYLE, DATA, SCRIPTS] {
                assert_eq!(page.template.matches(mark).count(), 1, "{mark}");
            }
            assert_eq!(page.template.matches(LIBRARY).count(), page.library.iter().count());
            for script in page.scripts.iter().chain(&page.library) {
                assert!(!script.contains("</script"));
            }
        }
    }

    #[test]
    fn data_that_looks_like_a_mark_stays_data() {
        let mut text = Vec::new();
        let data = |to: &mut Sink| to(b"[\"{{scripts}}\"]");
        page(&REPORT, None, "", data, &mut |part| {
            text.extend_from_slice(part);
            Ok(())
        })
        .unwrap();
        assert!(String::from_utf8(text).unwrap().contains("[\"{{scripts}}\"]"));
    }
}
