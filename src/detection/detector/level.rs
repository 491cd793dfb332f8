//! Bridges in a net without heights: two paths that cross away from any common junction are on different levels.
//!
//! Only road users known to be on a lane have a level: a vehicle moved off the road, a person or an obstacle can meet any
//! other.

use smallvec::SmallVec;

use super::step::StepInputs;
use crate::detection::kind::Kind;
use crate::detection::narrow_phase::ConflictPoint;
use crate::traffic::net::{EdgeIndex, Net};
use crate::traffic::profile::Category;
use crate::util::units::Metre;

/// Two ways that share one junction may cross on different levels further than this from it, in m.
const NEAR_JUNCTION: Metre = 50.0;

impl StepInputs<'_> {
    /// Whether the ways of an ego and its foe are on different levels at their conflict point.
    pub(super) fn are_on_two_levels(&self, [ego, foe]: [u32; 2], meeting: &ConflictPoint, kind: Kind) -> bool {
        let Some(net) = self.flat_net else { return false };
        let (Some(of_ego), Some(of_foe)) =
            (self.edges_at(net, ego, meeting.ego_distance), self.edges_at(net, foe, meeting.foe_distance))
        else {
            return false;
        };
        let are_level = |a: EdgeIndex, b: EdgeIndex| {
            let [of_a, of_b] = [a, b].map(|edge| net.edges[edge].ends);
            let mut common = of_a.into_iter().filter(|junction| of_b.contains(junction));
            a == b
                || of_a == of_b
                || of_a == [of_b[1], of_b[0]]
                || common.any(|junction| kind != Kind::Side || net.is_near(junction, meeting.front(), NEAR_JUNCTION))
        };
        !of_ego.iter().any(|ego| of_foe.iter().any(|foe| are_level(*ego, *foe)))
    }

    /// The edges that a vehicle is on when its front bumper is at a distance ahead on its path; none where that is unknown.
    fn edges_at(&self, net: &Net, slot: u32, distance: Metre) -> Option<SmallVec<[EdgeIndex; 4]>> {
        let user = self.user(slot);
        let path = self.paths.of(user.index).filter(|path| !path.track.is_empty())?;
        let profile = self.profile(user);
        if user.category != Category::Vehicle {
            return None;
        }
        let lanes = path.lanes_between(&net.lines, distance - profile.length, distance);
        let lane = lanes.last().map(|lane| &net.lanes[*lane])?;
        let is_off_the_road = path.aside().abs() > (lane.width + profile.width) / 2.0;
        (!is_off_the_road).then(|| lanes.iter().map(|lane| net.lanes[*lane].edge).collect())
    }
}
