//! The clips of the worst conflicts, as the page plays them: whole numbers, each as its difference from the previous one. A clip
//! takes some kilobytes of the page.

use std::path::PathBuf;

use rustc_hash::FxHashMap;
use serde_json::{Value, json};

use crate::dataset::conflict_table::ConflictTable;
use crate::dataset::kept::RunConflict;
use crate::dataset::nets::Ground;
use crate::playback::{clips, signal_bar, signal_colour};
use crate::{Error, Result};
use closecall::detection::kind::Severity;
use closecall::events::{Clip, ClipUser};
use closecall::geometry::Point;
use closecall::traffic::net::Net;
use closecall::util::units::Metre;

/// Others are left out that never come this near to the conflict, in m: the page shows no more.
const SHOWN: Metre = 50.0;
/// Of a metre, a second and a metre per second.
const HUNDREDTHS: f64 = 100.0;
const THOUSANDTHS: f64 = 1000.0;

/// The clips of these conflicts that have one as JSON, by run and `id`, until they take this many bytes: those of the first
/// ones. Clips that are not as a run writes them are a note: the report is whole without them.
///
/// # Errors
/// [`Error::file`] where a file cannot be read.
pub(crate) fn of_worst(
    (worst, table): (&[RunConflict], &ConflictTable),
    logs: &[PathBuf],
    most_bytes: usize,
    ground: &mut Ground,
) -> Result<FxHashMap<(u32, u64), Value>> {
    let mut all = FxHashMap::default();
    for (run, log) in (0..).zip(logs) {
        let ids = worst.iter().filter(|one| one.run == run).map(|one| one.id).collect::<Vec<_>>();
        if ids.is_empty() {
            continue;
        }
        match clips(log, &ids) {
            Ok(found) => all.extend(found.into_iter().map(|(id, clip)| ((run, id), clip))),
            Err(error @ Error::Run(closecall_run::Error::File { .. })) => return Err(error),
            Err(error) => ground.notes.push(format!("No playback: {error}.")),
        }
    }
    let [x, y] = ["x", "y"].map(|name| table.numbers(name));
    let mut bytes = 0;
    let of = |one: &RunConflict| {
        let at = Point::new(x(one.row)?, y(one.row)?);
        Some((one.key(), json(all.get(&one.key())?, at, ground.net.as_ref())))
    };
    let fits = |(_, clip): &((u32, u64), Value)| {
        bytes += clip.to_string().len();
        bytes <= most_bytes
    };
    Ok(worst.iter().filter_map(of).take_while(fits).collect())
}

/// A clip as JSON, of a conflict at this place. Times are in ms, places in cm, headings and times left in hundredths, speeds in cm/s.
fn json(clip: &Clip, at: Point, net: Option<&Net>) -> Value {
    let is_near = |user: &ClipUser| {
        let places = user.x.iter().zip(&user.y).filter_map(|(x, y)| x.zip(*y));
        let corners = user.outlines.iter().flatten().map(|[x, y]| (*x, *y));
        places.chain(corners).any(|(x, y)| (Point::new(x, y) - at).norm() <= SHOWN)
    };
    let (two, others) = clip.users.split_at(2);
    let users = two.iter().map(|one| user(one, true));
    let users = users.chain(others.iter().filter(|other| is_near(other)).map(|other| user(other, false)));
    let severity = |severity: &Option<Severity>| {
        severity.map_or(-1, |one| Severity::ALL.iter().position(|known| *known == one).map_or(-1, |place| place as i32))
    };
    let times = clip.times.iter().copied().map(Some);
    json!({
        "time": differences(times, THOUSANDTHS),
        "severity": clip.severity.iter().map(severity).collect::<Vec<_>>(),
        "left": differences(clip.time_left.iter().copied(), HUNDREDTHS),
        "users": users.collect::<Vec<_>>(),
        "signals": net.map(|net| signals(clip, net)).unwrap_or_default(),
    })
}

fn user(user: &ClipUser, is_of_pair: bool) -> Value {
    if !user.outlines.is_empty() {
        let outline = |part: &Vec<[Metre; 2]>| differences(part.iter().flatten().copied().map(Some), HUNDREDTHS);
        return json!({ "outlines": user.outlines.iter().map(outline).collect::<Vec<_>>() });
    }
    let list = |values: &[Option<f64>]| differences(values.iter().copied(), HUNDREDTHS);
    json!({
        "category": user.category,
        "length": user.length,
        "width": user.width,
        "x": list(&user.x),
        "y": list(&user.y),
        "heading": list(&user.heading),
        "speed": is_of_pair.then(|| list(&user.speed)),
    })
}

/// The signals: the corners of each one's bar, and from which place in time on it has which colour.
fn signals(clip: &Clip, net: &Net) -> Vec<Value> {
    let one = |place: usize| {
        let corners = signal_bar(net, &clip.signals, place)?;
        let mut changes = Vec::<(usize, &str)>::new();
        for (place, letter) in clip.signals[place].states.bytes().enumerate() {
            let colour = signal_colour(letter);
            if changes.last().is_none_or(|(_, last)| *last != colour) {
                changes.push((place, colour));
            }
        }
        let corners = corners.iter().flat_map(|corner| [corner.x, corner.y]);
        Some(json!({ "corners": differences(corners.map(Some), HUNDREDTHS), "colours": changes }))
    };
    (0..clip.signals.len()).filter_map(one).collect()
}

/// Numbers as whole ones of this many to one, each as its difference from the last that was there.
fn differences(values: impl Iterator<Item = Option<f64>>, scale: f64) -> Vec<Option<i64>> {
    let mut last = 0;
    let from_last = |value: f64| {
        let now = (value * scale).round() as i64;
        now - std::mem::replace(&mut last, now)
    };
    values
        .map({
            let mut from_last = from_last;
            move |value| value.map(&mut from_last)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_in_a_list_keeps_the_last_number() {
        let values = [Some(1.0), Some(1.25), None, Some(1.2), Some(-1.0)];
        assert_eq!(differences(values.into_iter(), 100.0), [Some(100), Some(25), None, Some(-5), Some(-220)]);
    }
}
