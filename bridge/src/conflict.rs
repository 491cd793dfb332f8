//! What Python sees of a conflict.

use closecall::traffic::net::Net;
use pyo3::prelude::*;

/// One conflict: a pair of road users and a run of steps in which they were closer than they can safely be.
///
/// SI units; everything from `time` on is of the step with the smallest margin, except `clearance`, `ttc`, `drac` and
/// `pet`, which are the event's extremes. None where a measure does not exist.
#[pyclass(frozen, get_all, module = "closecall", name = "Conflict")]
pub struct Conflict {
    ego: String,
    foe: String,
    kind: &'static str,
    severity: &'static str,
    begin: f64,
    end: f64,
    time: f64,
    gap: f64,
    mu: f64,
    margin: f64,
    clearance: f64,
    ttc: Option<f64>,
    drac: Option<f64>,
    pet: Option<f64>,
    delta_v: f64,
    ego_speed: f64,
    foe_speed: f64,
    angle: f64,
    x: f64,
    y: f64,
    lane: Option<String>,
    collision: bool,
}

impl Conflict {
    /// A conflict of a run on this net.
    pub fn new(from: closecall::events::Conflict, net: Option<&Net>) -> Self {
        Self {
            ego: from.ego.to_string(),
            foe: from.foe.to_string(),
            kind: from.kind.name(),
            severity: from.severity.name(),
            begin: from.begin,
            end: from.end,
            time: from.time,
            gap: from.gap,
            mu: from.mu,
            margin: from.margin,
            clearance: from.clearance,
            ttc: from.ttc,
            drac: from.drac,
            pet: from.pet,
            delta_v: from.delta_v,
            ego_speed: from.ego_speed,
            foe_speed: from.foe_speed,
            angle: from.angle,
            x: from.x,
            y: from.y,
            lane: from.lane.and_then(|lane| net.map(|net| net.lane_id(lane).to_owned())),
            collision: from.collision,
        }
    }
}

#[pymethods]
impl Conflict {
    fn __repr__(&self) -> String {
        let Self { ego, foe, kind, severity, time, margin, .. } = self;
        format!("Conflict(ego={ego:?}, foe={foe:?}, kind={kind}, severity={severity}, time={time}, margin={margin:.3})")
    }
}
