//! Whether a recording was made on this net, and whether its positions are metres or degrees.

use std::path::Path;

use super::lanes::{Lanes, distance};
use super::recorded_step::{RecordedRow, RecordedStep};
use super::recording::Recording;
use crate::net::projection::Projection;
use crate::{Error, Result};
use closecall::traffic::net::{LaneIndex, Net};
use closecall::util::units::Metre;

/// A vehicle further than this from its lane, in m, was recorded on another net.
const ELSEWHERE: Metre = 100.0;

/// The projection that turns the recording's positions into the net's; none where they are the net's already. The first
/// vehicle on a lane of the net decides.
///
/// # Errors
/// [`Error::Content`] if the net has none of the recording's lanes or has the vehicle's lane elsewhere, and those of
/// [`Recording`].
pub(super) fn projection(path: &Path, net: &Net) -> Result<Option<Projection>> {
    let mut recording = Recording::open_for_lanes(path)?;
    let mut step = RecordedStep::default();
    let mut lanes = Lanes::default();
    let mut unknown = None;
    while recording.next_step(&mut step).or_else(end_of_cut_short)? {
        for row in step.rows().iter().filter(|row| !row.person) {
            if let Some(lane) = lanes.lane(row.lane, |lane| recording.lane(lane), net) {
                return fitting(row, net, lane).map_err(|reason| {
                    let (id, lane, x, y) = (recording.id(row.user), recording.lane(row.lane), row.x, row.y);
                    let message = format!(
                        "\"{id}\" is on lane {lane} at ({x}, {y}), but the net has that lane elsewhere: {reason}"
                    );
                    Error::content(path, message)
                });
            }
            let name = recording.lane(row.lane);
            if unknown.is_none() && !name.is_empty() {
                unknown = Some(name.to_owned());
            }
        }
    }
    unknown.map_or(Ok(None), |lane| {
        let message =
            format!("the net has none of the recording's lanes (\"{lane}\" and so on): recorded on another net");
        Err(Error::content(path, message))
    })
}

/// A recording that is cut short ends there.
fn end_of_cut_short(error: Error) -> Result<bool> {
    if matches!(error, Error::CutShort { .. }) { Ok(false) } else { Err(error) }
}

/// The projection that brings a vehicle to its lane; none if it is there.
fn fitting(row: &RecordedRow, net: &Net, lane: LaneIndex) -> std::result::Result<Option<Projection>, String> {
    let in_metres = distance(row, net, lane);
    let may_be_degrees = row.x.abs() <= 180.0 && row.y.abs() <= 90.0;
    let projection = if may_be_degrees { Projection::of(net.location.as_ref()) } else { Ok(None) };
    let place = projection.as_ref().ok().and_then(|projection| projection.as_ref()?.place(row.x, row.y));
    let in_degrees =
        place.map_or(f64::INFINITY, |place| distance(&RecordedRow { x: place.x, y: place.y, ..*row }, net, lane));
    if in_degrees < in_metres && in_degrees <= ELSEWHERE {
        return projection;
    }
    if in_metres <= ELSEWHERE {
        return Ok(None);
    }
    projection?;
    Err(if may_be_degrees {
        "recorded on another net, or in degrees (--fcd-output.geo) with another projection than the net's?".to_owned()
    } else {
        "recorded on another net?".to_owned()
    })
}
