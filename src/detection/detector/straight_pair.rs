//! Two road users without lanes that go straight on along their headings. They cover two rectangles, which are cheaper
//! to compute for each pair than to keep.

use super::reach::User;
use super::step::StepInputs;
use super::work_counts::Work;
use super::worker::Findings;
use crate::detection::narrow_phase::Participant;
use crate::detection::path::{Pose, straight};
use crate::geometry::Point;
use crate::geometry::contact::plainly_touches;
use crate::geometry::movement::TOLERANCE;
use crate::traffic::profile::Category;
use crate::util::units::Metre;

/// Poses where a road user is now, where it stands and ε further; fewer where it stands already.
struct StraightPoses {
    poses: [Pose; 3],
    count: usize,
}

impl StraightPoses {
    fn of(front: Point, user: &User, stop: Metre, reach: Metre) -> Self {
        let now = straight::pose(front, user.axis, 0.0);
        let mut straight_poses = Self { poses: [now; 3], count: 1 };
        for distance in [stop, reach] {
            if distance > 0.0 {
                straight_poses.poses[straight_poses.count] = straight::pose(front, user.axis, distance);
                straight_poses.count += 1;
            }
        }
        straight_poses
    }

    fn poses(&self) -> &[Pose] {
        &self.poses[..self.count]
    }
}

impl StepInputs<'_> {
    /// Whether both go straight on, so that the boxes around all that they cover need not be kept.
    pub(super) fn go_straight(&self, slots: [u32; 2]) -> bool {
        let goes_straight = |user: &User| user.ahead && !user.on_lanes && user.category != Category::Obstacle;
        self.shortcuts.areas_apart
            && self.shortcuts.paths_apart
            && slots.iter().all(|slot| goes_straight(self.user(*slot)))
    }

    /// Finds where they would meet.
    pub(super) fn meet_straight(&self, work: &mut Work, slots: [u32; 2], found: &mut Findings) {
        let pair = slots.map(|slot| self.mover(slot));
        let Some(unsettled) = self.settle(work, slots, &pair, found) else { return };
        let [mut first, mut second] = unsettled.shrunk(pair);
        let covered = |mover: &Participant| mover.rectangle.swept(&(mover.rectangle.axis * mover.reach), TOLERANCE);
        if !plainly_touches(&covered(&first), &covered(&second)) {
            work.paths_apart += 1;
            return;
        }
        let straight_poses = |slot: u32, mover: &Participant| {
            let user = self.user(slot);
            StraightPoses::of(self.state(user).front(), user, mover.stop, mover.reach)
        };
        let (of_first, of_second) = (straight_poses(slots[0], &first), straight_poses(slots[1], &second));
        first.poses = of_first.poses();
        second.poses = of_second.poses();
        self.sweep(work, slots, &[first, second], unsettled, found);
    }
}
