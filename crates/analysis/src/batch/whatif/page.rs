//! `whatif.html`: for each conflict the answer, the paths of all roll-outs over each other, and two clips.

use std::path::Path;

use super::answer::Answer;
use super::runs::{Rolled, WhatIf};
use crate::logged::{ConflictReader, ConflictSelector};
use crate::playback::{DrawnPath, Playback, overlay, svg};
use crate::{Result, style};
use closecall::geometry::Point;
use closecall::traffic::net::Net;
use closecall_run::util::output_file;
use closecall_run::util::xml_text::escaped;

/// Colours of paths: of both where they strike each other, of the ego and of the foe where not.
const STRUCK: &str = "#d00000";
const EGO: &str = "#0077b6";
const FOE: &str = "#ffb703";

/// What the pictures show.
const LEGEND: &str =
    "Paths of all roll-outs: ego blue, foe yellow; red where one of the two is struck, with a ring at the contact.";

/// Writes the page.
///
/// # Errors
/// Those of reading the runs and of writing it.
pub(super) fn write(whatif: &WhatIf, answers: &[Answer], path: &Path) -> Result<()> {
    let style = style::sheet();
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>What if – closecall</title>\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <meta name=\"color-scheme\" content=\"light dark\"><style>{style}</style></head><body>\n\
         <header><h1>What if</h1><p>{}</p></header>\n<main>\n",
        escaped(&whatif.asked.in_words())
    );
    let net = whatif.net()?;
    for answer in answers {
        page += &section(whatif, answer, net.as_ref())?;
    }
    page += "</main></body></html>\n";
    Ok(output_file::write(path, page.as_bytes())?)
}

fn section(whatif: &WhatIf, answer: &Answer, net: Option<&Net>) -> Result<String> {
    let id = answer.conflict;
    let mut text =
        format!("<section id=\"conflict-{id}\"><h2>Conflict {id}</h2><p>{}</p>\n", escaped(&answer.in_words()));
    let Some(Rolled { conflict, roll_outs, filmed }) = whatif.rolled(id)? else { return Ok(text + "</section>\n") };
    let mut paths = Vec::new();
    for run in &roll_outs {
        for (user, colour) in [(&conflict.foe, FOE), (&conflict.ego, EGO)] {
            let places = run.outcome.paths.get(user).into_iter().flatten();
            let places = places.map(|step| Point::new(step.1, step.2)).collect();
            let is_struck = run.outcome.contact.as_ref().is_some_and(|contact| contact.pair.contains(user));
            paths.push(DrawnPath { places, colour: if is_struck { STRUCK } else { colour }, is_struck });
        }
    }
    // Those of contacts above the others.
    paths.sort_by_key(|path| path.is_struck);
    text +=
        &overlay(net, Point::new(conflict.x, conflict.y), &paths, &format!("Paths of the roll-outs of conflict {id}"));
    text += &format!("<p class=\"note\">{LEGEND}</p>\n");
    for run in &filmed {
        let what = if run.outcome.contact.is_some() { "A roll-out with a contact" } else { "A roll-out without" };
        if let Some(clip) = clip(&run.task.log(), &conflict.ego, &conflict.foe)? {
            text += &format!("<h3>{what}</h3>\n{clip}");
        }
    }
    Ok(text + "</section>\n")
}

/// The clip of the conflict of two in a log; none where it has none.
fn clip(log: &Path, ego: &str, foe: &str) -> Result<Option<String>> {
    for found in ConflictReader::open(log)? {
        let found = found?;
        let is_pair = [(ego, foe), (foe, ego)].contains(&(found.ego.as_str(), found.foe.as_str()));
        if is_pair {
            let playback = Playback::find(log, ConflictSelector::Id(found.id), None);
            return Ok(playback.ok().map(|playback| svg(&playback)));
        }
    }
    Ok(None)
}
