//! Two that go straight on along their headings, on no lanes: what they cover is two rectangles, and to lay these for each
//! pair takes less than to keep them.

use super::reach::User;
use super::step::StepInputs;
use super::work::Work;
use super::worker::Found;
use crate::detection::narrow_phase::Participant;
use crate::detection::path::{Pose, straight};
use crate::geometry::Point;
use crate::geometry::contact::plainly_touches;
use crate::geometry::sweep::TOLERANCE;
use crate::traffic::profile::Category;
use crate::util::units::Metre;

/// Poses where somebody is now, where it stands and ε further; who stands has fewer.
struct Onward {
    poses: [Pose; 3],
    count: usize,
}

impl Onward {
    fn of(front: Point, user: &User, stop: Metre, reach: Metre) -> Self {
        let now = straight::pose(front, user.axis, 0.0);
        let mut onward = Self { poses: [now; 3], count: 1 };
        for way in [stop, reach] {
            if way > 0.0 {
                onward.poses[onward.count] = straight::pose(front, user.axis, way);
                onward.count += 1;
            }
        }
        onward
    }

    fn poses(&self) -> &[Pose] {
        &self.poses[..self.count]
    }
}

impl StepInputs<'_> {
    /// Whether both do, and phase 1 has compared the boxes around all that they cover.
    pub(super) fn go_onward(&self, slots: [u32; 2]) -> bool {
        let goes_onward = |user: &User| user.ahead && !user.on_lanes && user.category != Category::Obstacle;
        self.shortcuts.areas_apart
            && self.shortcuts.paths_apart
            && slots.iter().all(|slot| goes_onward(self.user(*slot)))
    }

    /// Where they would meet.
    pub(super) fn meet_onward(&self, work: &mut Work, slots: [u32; 2], found: &mut Found) {
        let (mut first, mut second) = (self.mover(slots[0]), self.mover(slots[1]));
        let Some(in_line) = self.settle(work, slots, [&first, &second], found) else { return };
        let covered = |mover: &Participant| mover.rectangle.swept(&(mover.rectangle.axis * mover.reach), TOLERANCE);
        if !plainly_touches(&covered(&first), &covered(&second)) {
            work.paths_apart += 1;
            return;
        }
        let onward = |slot: u32, mover: &Participant| {
            let user = self.user(slot);
            Onward::of(self.state(user).front(), user, mover.stop, mover.reach)
        };
        let (of_first, of_second) = (onward(slots[0], &first), onward(slots[1], &second));
        first.poses = of_first.poses();
        second.poses = of_second.poses();
        self.sweep(work, slots, [&first, &second], in_line, found);
    }
}
