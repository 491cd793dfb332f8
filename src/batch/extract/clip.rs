//! A conflict's clip as a scenario of ASAM's formats, for simulators and tools that do not know SUMO.
//!
//! Nothing is simulated: the road users do again what the log says, so that this works for recordings, too.

use std::fs;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use super::made::{Made, fill};
use crate::analysis::logged::{Which, record};
use crate::analysis::playback::Playback;
use crate::events::Clip;
use crate::geometry::{Bounds, Point};
use crate::output::formats::{Scenario, scenario, trace};
use crate::util::output_file;
use crate::util::units::Metre;
use crate::{Error, Result};

/// The scenario's file.
pub const SCENARIO: &str = "conflict.xosc";
/// The file of its roads.
const ROADS: &str = "net.xodr";
/// How far beyond the road users the net is converted, in m.
const AROUND: Metre = 100.0;

/// Writes the part of a SUMO net that is within bounds as OpenDRIVE.
pub type ConvertNet<'a> = dyn FnMut(&Path, &Bounds, &Path) -> Result<()> + 'a;

/// Writes the clip of a conflict as OpenSCENARIO XML, with its net as OpenDRIVE, into the folder `out`, whole or not at all.
/// The net is `net` or the one that the log names.
///
/// # Errors
/// [`Error::Value`] where the log has no such conflict, or the conflict no clip; [`Error::Content`] where `out` is not empty;
/// those of `convert` and of reading and writing.
pub fn extract_openscenario(
    folder: &Path,
    which: Which,
    net: Option<&Path>,
    out: &Path,
    convert: &mut ConvertNet,
) -> Result<Made> {
    let Playback { conflict, clip, net_file, notes, .. } = Playback::find(folder, which, net)?;
    let date = written(folder)?;
    fill(out, |place, _| {
        if let Some(net) = &net_file {
            convert(net, &bounds(&clip), &place.join(ROADS))?;
        }
        let roads = net_file.is_some().then_some(ROADS);
        let text = scenario(&Scenario { conflict: &conflict, clip: &clip, roads, date: &date });
        output_file::write(&place.join(SCENARIO), text.as_bytes())
    })?;
    let remark = match net_file {
        Some(_) => (!notes.is_empty()).then(|| notes.join(" ")),
        None => Some("no net was found, so that the scenario has no roads; --net gives one".to_owned()),
    };
    Ok(Made { conflict, remark })
}

/// Writes the clip of a conflict as a trace of OSI.
///
/// # Errors
/// [`Error::Value`] where the log has no such conflict, or the conflict no clip; those of reading and writing.
pub fn extract_osi(folder: &Path, which: Which, out: &Path) -> Result<Made> {
    let Playback { conflict, clip, .. } = Playback::find(folder, which, None)?;
    output_file::write(out, &trace(&clip))?;
    Ok(Made { conflict, remark: None })
}

/// The part of the net that is converted.
fn bounds(clip: &Clip) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    for user in &clip.users {
        let places = user.x.iter().zip(&user.y);
        places.filter_map(|(x, y)| Some(Point::new((*x)?, (*y)?))).for_each(|place| bounds.include(place));
    }
    bounds.grown(AROUND)
}

/// When a log was written.
fn written(folder: &Path) -> Result<String> {
    let (path, _) = record(folder)?;
    let time = fs::metadata(&path).and_then(|file| file.modified()).map_err(|source| Error::file(&path, source))?;
    Ok(date(time))
}

/// A time as XML Schema has it, in UTC. The calendar is computed as by Hinnant (2021), "chrono-compatible low-level date
/// algorithms", `civil_from_days`.
fn date(time: SystemTime) -> String {
    let seconds = time.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let days = seconds / 86_400 + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let (day, month) = (day - (153 * month + 2) / 5 + 1, if month < 10 { month + 3 } else { month - 9 });
    let year = year + era * 400 + u64::from(month <= 2);
    let [hour, minute, second] = [seconds / 3600 % 24, seconds / 60 % 60, seconds % 60];
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        let of = |seconds| date(UNIX_EPOCH + Duration::from_secs(seconds));
        assert_eq!(of(0), "1970-01-01T00:00:00Z");
        assert_eq!(of(951_782_400), "2000-02-29T00:00:00Z");
        assert_eq!(of(1_795_858_323), "2026-11-28T09:32:03Z");
    }
}
