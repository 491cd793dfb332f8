//! `whatif.html`, and the same as a section of the report: for each conflict the answer, the paths of all roll-outs over each
//! other, and two clips. All of it is read back from the folder of the results.

use std::path::Path;

use super::answer::Answer;
use super::arms::{ERROR, name_of};
use crate::batch::sweep::{log_of, series_of};
use crate::dataset::nets;
use crate::logged::{ConflictReader, ConflictSelector, record};
use crate::playback::{DrawnPath, Playback, overlay, svg};
use crate::{Error, Result, style};
use closecall::geometry::Point;
use closecall::traffic::net::Net;
use closecall_run::run::roll_out::{Outcome, ROLL_OUT};
use closecall_run::util::output_file;
use closecall_run::util::xml_text::escaped;

/// The table and the page in the folder of the results, and the data set of the run that saves the states.
pub(super) const TABLE: &str = "whatif.csv";
pub(super) const PAGE: &str = "whatif.html";
pub(super) const ORIGINAL: &str = "original";

/// Colours of paths: of both where they strike each other, of the ego and of the foe where not.
const STRUCK: &str = "#d00000";
const EGO: &str = "#0077b6";
const FOE: &str = "#ffb703";

/// What the pictures show.
const LEGEND: &str =
    "Paths of all roll-outs: ego blue, foe yellow; red where one of the two is struck, with a ring at the contact.";

/// Writes the page of the results in a folder, with a line about what was asked.
///
/// # Errors
/// Those of [`sections`], and of writing it.
pub(super) fn write(folder: &Path, asked: &str) -> Result<()> {
    let (style, asked, sections) = (style::sheet(), escaped(asked), sections(folder)?);
    let page = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>What if – closecall</title>\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <meta name=\"color-scheme\" content=\"light dark\"><style>{style}</style></head><body>\n\
         <header><h1>What if</h1><p>{asked}</p></header>\n<main>\n{sections}</main></body></html>\n"
    );
    Ok(output_file::write(&folder.join(PAGE), page.as_bytes())?)
}

/// A section of HTML for each conflict in a folder of results.
///
/// # Errors
/// [`Error::file`] or [`Error::content`] where a file of the folder is missing, or is not as `closecall whatif` writes it.
pub fn sections(folder: &Path) -> Result<String> {
    let table = folder.join(TABLE);
    closecall_run::util::input_file::file(&table)?;
    let failed = |error: csv::Error| Error::content(&table, error.to_string());
    let mut reader = csv::Reader::from_path(&table).map_err(failed)?;
    let net = net(&log_of(&folder.join(ORIGINAL), ORIGINAL))?;
    let answers = reader.deserialize().map(|answer| section(folder, &answer.map_err(failed)?, net.as_ref()));
    answers.collect()
}

/// The net of a log; none where it cannot be read.
fn net(log: &Path) -> Result<Option<Net>> {
    let Ok((path, text)) = record(log) else { return Ok(None) };
    let record = serde_json::from_str(&text).map_err(|error| Error::content(&path, error.to_string()))?;
    Ok(nets::find(None, &[log.to_owned()], &[record])?.net)
}

fn section(folder: &Path, answer: &Answer, net: Option<&Net>) -> Result<String> {
    let (id, words) = (answer.conflict, escaped(&answer.in_words()).into_owned());
    let mut text = format!("<section id=\"whatif-{id}\"><h2>Conflict {id}, what if</h2><p>{words}</p>\n");
    let mut paths = Vec::new();
    for number in 0..answer.roll_outs + answer.lost {
        let file = series_of(folder, &name_of(id, ERROR, &number.to_string())).join(ROLL_OUT);
        if file.is_file() {
            let outcome = Outcome::read(&file)?;
            for (user, colour) in [(&answer.foe, FOE), (&answer.ego, EGO)] {
                let places = outcome.paths.get(user).into_iter().flatten();
                let places = places.map(|step| Point::new(step.1, step.2)).collect();
                let is_struck = outcome.contact.as_ref().is_some_and(|contact| contact.pair.contains(user));
                paths.push(DrawnPath { places, colour: if is_struck { STRUCK } else { colour }, is_struck });
            }
        }
    }
    if paths.is_empty() {
        return Ok(text + "</section>\n");
    }
    // Those of contacts above the others.
    paths.sort_by_key(|path| path.is_struck);
    let title = format!("Paths of the roll-outs of conflict {id}");
    text += &overlay(net, Point::new(answer.x, answer.y), &paths, &title);
    text += &format!("<p class=\"note\">{LEGEND}</p>\n");
    for (run, what) in [(&answer.clip_with_contact, "with a contact"), (&answer.clip_without, "without one")] {
        if let (false, Some(clip)) = (run.is_empty(), clip(&log_of(folder, run), answer)?) {
            text += &format!("<h3>A roll-out {what}</h3>\n{clip}");
        }
    }
    Ok(text + "</section>\n")
}

/// The clip of the conflict in the log of a roll-out; none where it has none.
fn clip(log: &Path, answer: &Answer) -> Result<Option<String>> {
    if !log.is_dir() {
        return Ok(None);
    }
    for found in ConflictReader::open(log)? {
        let found = found?;
        if found.is_between(&answer.ego, &answer.foe) {
            let playback = Playback::find(log, ConflictSelector::Id(found.id), None);
            return Ok(playback.ok().map(|playback| svg(&playback)));
        }
    }
    Ok(None)
}
