//! Drops a step's rear-end pairs with another vehicle between (see [`super::one_between`]).

use super::one_between::{OneBetween, PathAhead, may_have_one_between};
use super::worker::Worker;
use super::{Detector, LEVEL};
use crate::detection::encounter::Encounter;
use crate::options::Mode;
use crate::traffic::frame::Frame;
use crate::traffic::roster::Roster;
use crate::util::units::Metre;

impl Detector {
    /// Drops the rear-end encounters of two between which another vehicle is on the same path. Call
    /// [`Detector::narrow_phase`] with the same frame first.
    pub fn drop_pairs_with_one_between(&mut self, frame: &Frame, roster: &Roster) {
        if self.options.mode == Mode::Paper || !self.encounters().any(may_have_one_between) {
            return;
        }
        let mut between = std::mem::take(&mut self.one_between);
        let pairs = self.pairs.iter().flatten().copied();
        if between.find(frame.len(), self.search.slots(), self.encounters(), pairs) {
            let (mut order, mut workers) = (std::mem::take(&mut self.order), std::mem::take(&mut self.workers));
            let lend = |workers: &mut [Worker], ahead: &mut PathAhead| {
                let first = workers.first_mut().map(|worker| &mut worker.found.scratch.halves);
                first.into_iter().for_each(|halves| std::mem::swap(halves, &mut ahead.bisection));
            };
            lend(&mut workers, &mut between.ahead);
            order.retain(&mut workers, |found| {
                !may_have_one_between(found) || !self.has_one_between(&mut between, frame, roster, found)
            });
            between.ahead.bisection.shrink();
            lend(&mut workers, &mut between.ahead);
            (self.order, self.workers) = (order, workers);
        }
        self.one_between = between;
    }

    fn has_one_between(&mut self, between: &mut OneBetween, frame: &Frame, roster: &Roster, found: &Encounter) -> bool {
        let OneBetween { slots, near, ahead, .. } = between;
        let [ego, foe] = [found.ego_row, found.foe_row].map(|row| slots[row as usize]);
        let first = near.partition_point(|(slot, _)| *slot < ego);
        let near = near[first..].iter().take_while(|(slot, _)| *slot == ego).map(|(_, other)| *other);
        let mut near = near.filter(|other| *other != foe).peekable();
        if near.peek().is_none() {
            return false;
        }
        let length = roster.profile_of(found.foe).length;
        let furthest = found.ego_distance + found.foe_distance + length;
        self.look_ahead(frame, roster, ego, furthest, ahead);
        let Some(to_foe) = self.scene(frame, roster).distance_to(ahead, ego, foe) else { return false };
        let height = frame.state(found.ego_row).z;
        for other in near {
            let scene = self.scene(frame, roster);
            if (scene.state(scene.user(other)).z - height).abs() > LEVEL {
                continue;
            }
            // The poses are the ego's until one is found to be on its path.
            if scene.distance_to(ahead, ego, other).is_none_or(|distance| distance >= to_foe) {
                continue;
            }
            self.look_ahead(frame, roster, other, to_foe, ahead);
            if self.scene(frame, roster).distance_to(ahead, other, foe).is_some_and(|distance| distance < to_foe) {
                return true;
            }
            self.look_ahead(frame, roster, ego, furthest, ahead);
        }
        false
    }

    /// Computes the poses of the road user in a slot as far as `furthest`.
    fn look_ahead(&mut self, frame: &Frame, roster: &Roster, slot: u32, furthest: Metre, ahead: &mut PathAhead) {
        let user = self.search.slots()[slot as usize];
        let moves = frame.state(user.row).moves();
        // One that stands still has the path on which it came.
        let user = if moves { user } else { self.sight(frame, roster).further(&user) };
        if user.on_lanes {
            self.lengthen(roster, &user, furthest);
        }
        let scene = self.scene(frame, roster);
        ahead.poses.clear();
        if let Some(first) = scene.carriages(&user).next() {
            scene.course(&user, first, &[furthest], true, &mut ahead.poses);
        }
    }
}
