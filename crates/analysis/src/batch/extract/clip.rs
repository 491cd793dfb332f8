//! A conflict's clip as a scenario of ASAM's formats, for simulators and tools that do not know SUMO.
//!
//! Nothing is simulated: the road users do again what the log says, so that this works for recordings, too.

use std::fs;
use std::path::Path;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use super::extracted::{Extracted, fill};
use crate::logged::{ConflictSelector, record};
use crate::playback::Playback;
use crate::{Error, Result};
use closecall::events::Clip;
use closecall::geometry::{Bounds, Point};
use closecall::util::units::Metre;
use closecall_run::output::formats::{Scenario, scenario, trace};
use closecall_run::util::output_file;

/// The scenario's file.
pub const SCENARIO: &str = "conflict.xosc";
/// The file of its roads.
const ROADS: &str = "net.xodr";
/// How far beyond the road users the net is converted, in m.
const AROUND: Metre = 100.0;

/// From 1970 to the last second of the year 9999.
const YEAR_9999: Duration = Duration::from_secs(253_402_300_799);

/// Writes the part of a SUMO net that is within bounds as OpenDRIVE.
pub type ConvertNet<'a> = dyn FnMut(&Path, &Bounds, &Path) -> closecall_run::Result<()> + 'a;

/// Writes the clip of a conflict as OpenSCENARIO XML, with its net as OpenDRIVE, into the folder `out`, whole or not at all.
/// The net is `net` or the one that the log names.
///
/// # Errors
/// [`Error::NoConflict`] or [`Error::NoClip`]; [`Error::content`] where `out` is not empty;
/// those of `convert` and of reading and writing.
pub fn extract_openscenario(
    folder: &Path,
    which: ConflictSelector,
    net: Option<&Path>,
    out: &Path,
    convert: &mut ConvertNet,
) -> Result<Extracted> {
    let Playback { conflict, clip, net_file, notes, .. } = Playback::find(folder, which, net)?;
    let date = written(folder)?;
    fill(out, |place, _| {
        if let Some(net) = &net_file {
            convert(net, &bounds(&clip), &place.join(ROADS))?;
        }
        let roads = net_file.is_some().then_some(ROADS);
        let text = scenario(&Scenario { conflict: &conflict, clip: &clip, roads, date: &date });
        Ok(output_file::write(&place.join(SCENARIO), text.as_bytes())?)
    })?;
    let remark = match net_file {
        Some(_) => (!notes.is_empty()).then(|| notes.join(" ")),
        None => Some("no net was found, so that the scenario has no roads; --net gives one".to_owned()),
    };
    Ok(Extracted { conflict, remark })
}

/// Writes the clip of a conflict as a trace of OSI.
///
/// # Errors
/// [`Error::NoConflict`] or [`Error::NoClip`]; those of reading and writing.
pub fn extract_osi(folder: &Path, which: ConflictSelector, out: &Path) -> Result<Extracted> {
    let Playback { conflict, clip, .. } = Playback::find(folder, which, None)?;
    output_file::write(out, &trace(&clip))?;
    Ok(Extracted { conflict, remark: None })
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

/// A time as XML Schema has it, in UTC; one outside the years 1970 to 9999, which humantime refuses, as their end.
fn date(time: SystemTime) -> String {
    humantime::format_rfc3339_seconds(time.clamp(UNIX_EPOCH, UNIX_EPOCH + YEAR_9999)).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_time_of_a_file_has_a_date() {
        let of = |time: Option<SystemTime>| date(time.unwrap());
        assert_eq!(of(UNIX_EPOCH.checked_add(Duration::from_secs(951_782_400))), "2000-02-29T00:00:00Z");
        assert_eq!(of(UNIX_EPOCH.checked_sub(Duration::from_secs(1))), "1970-01-01T00:00:00Z");
        assert_eq!(of(UNIX_EPOCH.checked_add(2 * YEAR_9999)), "9999-12-31T23:59:59Z");
    }
}
