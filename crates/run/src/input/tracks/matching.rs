//! The lane beneath a road user if the recording does not name it: the nearest in its direction. Within junctions, where lanes
//! overlap, none is named; replay finds the path from the edges before and behind.

use closecall::detection::path::Foot;
use closecall::geometry::Point;
use closecall::geometry::rectangle::direction;
use closecall::traffic::net::{EdgeFunction, LaneIndex, Net};
use closecall::util::units::{Metre, Radian};

/// A road user is at most this far beside its lane, in m.
const BESIDE: Metre = 1.0;
/// A lane that a recording tells is that of the net where its road user is this near to its centre line, in m.
const ON_TOLD: Metre = 5.0;
/// The least cosine of the angle between a road user's heading and its lane: that of 45°.
const ALONG: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Finds lanes of a net.
pub(super) struct LaneFinder<'a> {
    net: &'a Net,
}

impl<'a> LaneFinder<'a> {
    pub fn new(net: &'a Net) -> Self {
        Self { net }
    }

    /// The id of the lane of a road user, which the recording may tell, and how far along it the road user is.
    pub fn find(&self, front: Point, heading: Radian, told: Option<LaneIndex>) -> Option<(&'a str, Metre)> {
        let foot = |lane: LaneIndex| Foot::on_any_part(self.net.lines.line(lane.0), front);
        let told = told.filter(|lane| foot(*lane).aside.abs() <= ON_TOLD);
        let along = direction(heading);
        let beneath = || {
            let near = self.net.lanes_at(front, BESIDE);
            let usable = near
                .filter(|lane| self.net.function(*lane) == EdgeFunction::Normal && self.net.lanes[*lane].has_vehicles);
            let found = usable.map(|lane| (lane, foot(lane)));
            let found = found.filter(|(_, foot)| foot.direction.normalize().dot(&along) >= ALONG);
            found.min_by(|a, b| a.1.aside.abs().total_cmp(&b.1.aside.abs()).then(a.0.cmp(&b.0))).map(|(lane, _)| lane)
        };
        let lane = told.or_else(beneath)?;
        Some((self.net.lane_id(lane), foot(lane).distance))
    }
}
