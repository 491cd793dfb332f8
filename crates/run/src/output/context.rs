//! What a row of the log needs besides its conflict: the names behind its indices, and its paths as text.

use ecow::EcoString;

use super::place::on_lane;
use crate::util::decimal;
use closecall::events::{Conflict, Snapshot};
use closecall::geometry::Point;
use closecall::traffic::net::Net;
use closecall::traffic::roster::{ProfileIndex, Roster};
use closecall::util::units::{Degree, Metre};

/// What a conflict does not know itself: its number in the log, and the names behind its indices.
#[derive(Clone, Copy, Debug)]
pub struct Context<'a> {
    /// 1, 2, 3, … in the order of the log.
    pub number: u64,
    /// The net, which knows the lane's id; none without one.
    pub net: Option<&'a Net>,
    /// The roster, which knows the names of the types.
    pub roster: &'a Roster,
}

impl<'a> Context<'a> {
    pub(super) fn lane(&self, conflict: &Conflict) -> &'a str {
        conflict.lane.zip(self.net).map_or("", |(lane, net)| net.lane_id(lane))
    }

    /// The lane of the ego (0) or the foe (1), and how far along it that is.
    pub(super) fn on_lane(&self, conflict: &Conflict, user: usize) -> Option<(&'a str, Metre)> {
        let front = [&conflict.ego_snapshot, &conflict.foe_snapshot][user].front;
        on_lane(self.net?, conflict.lanes[user], front)
    }

    /// The longitude and latitude of the conflict point.
    pub(super) fn degrees(&self, conflict: &Conflict) -> Option<[Degree; 2]> {
        self.net?.degrees(Point::new(conflict.x, conflict.y))
    }

    pub(super) fn type_name(&self, profile: ProfileIndex) -> EcoString {
        self.roster.profile_at(profile).name.as_str().into()
    }
}

/// The largest coordinate of a path, in m, that is written as 0.
const HALF_A_CENTIMETRE: Metre = 0.005;

/// The path of a snapshot as x y x y …, to the centimetre; without commas, so that its cell needs no quotes.
pub(super) fn path(snapshot: &Snapshot) -> String {
    let mut text = String::new();
    for value in snapshot.path.iter().flat_map(|point| [point.x, point.y]) {
        if !text.is_empty() {
            text.push(' ');
        }
        // What rounds to 0 has no sign: it would be that of rounding, which differs between machines.
        decimal::push_fixed(&mut text, if value.abs() < HALF_A_CENTIMETRE { 0.0 } else { value }, 2);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_writes_what_rounds_to_nothing_without_a_sign() {
        let points = [(-0.0, -4e-16), (-0.0049, -0.0051)].map(|(x, y)| Point::new(x, y));
        let snapshot =
            Snapshot { front: points[0], heading: 0.0, length: 0.0, width: 0.0, path: std::sync::Arc::new(points) };
        assert_eq!(path(&snapshot), "0.00 0.00 0.00 -0.01");
    }
}
