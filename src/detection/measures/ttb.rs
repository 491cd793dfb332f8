//! TTB, the time to brake: the longest wait before full braking that still avoids contact (Hillenbrand, Spieker and
//! Kroschel 2006; Tamke, Dang and Breuel 2011).
//!
//! Until then the ego goes on with its present deceleration, and so does the foe, until it stands. The ego stays behind the
//! place where the foe blocks its path at each time: it stops before, or waits until the foe has left. Towards an oncoming
//! foe that alone avoids nothing, and both brake after the same wait. If the foe comes to where the ego is now, it is the foe
//! that has to brake.

use super::blocked_path::{PARALLEL, contact_distance, largest_need};
use super::ttc::{HORIZON, SteadyMotion};
use crate::braking::{LateBraking, Leader};
use crate::geometry::bisection::Bisection;
use crate::util::units::{Metre, Second};

/// What one road user can do to avoid contact with another, if it brakes in time. `Limits` is a slice of times and distances, or
/// tells where one is.
#[derive(Clone, Copy, Debug)]
pub enum Evasion<Limits> {
    /// Stay behind a leader in line.
    Behind(Leader),
    /// Be no further than each of these distances at each of these times; the first decides if the ego brakes fully.
    At(Limits),
    /// Stop before an oncoming foe, which brakes after the same wait.
    Towards {
        /// How the foe brakes.
        foe: LateBraking,
        /// The share of the foe's way that takes up room.
        share: f64,
        /// The room between both.
        room: Metre,
        /// The same as for [`Evasion::At`], if waiting until the foe has left is possible, too.
        or_at: Option<Limits>,
    },
    /// Nothing.
    None,
}

impl<Limits: Copy> Evasion<Limits> {
    /// The same with other limits.
    pub(crate) fn map<Other>(&self, mut limits: impl FnMut(Limits) -> Other) -> Evasion<Other> {
        match *self {
            Self::Behind(leader) => Evasion::Behind(leader),
            Self::At(own) => Evasion::At(limits(own)),
            Self::Towards { foe, share, room, or_at } => {
                Evasion::Towards { foe, share, room, or_at: or_at.map(limits) }
            }
            Self::None => Evasion::None,
        }
    }
}

impl Evasion<&[(Second, Metre)]> {
    /// The longest wait before it brakes like this, in s. Infinite if it need not brake harder than now; below 0 if even
    /// braking at once is too late.
    pub fn longest_wait(&self, braking: &LateBraking) -> Second {
        let at = |limits| braking.longest_wait_at_all(limits);
        match self {
            Self::Behind(leader) => braking.longest_wait_behind(leader),
            Self::At(limits) => at(limits),
            Self::Towards { foe, share, room, or_at } => {
                let both = braking.longest_wait_towards(foe, *share, *room);
                or_at.map_or(both, |limits| both.max(at(limits)))
            }
            Self::None => f64::NEG_INFINITY,
        }
    }
}

/// How an ego that brakes late stays behind a foe: the two touch after `meets`, in s, if neither brakes harder than now.
/// `limits` holds what the result borrows. None if the foe comes to where the ego is now.
pub(crate) fn to_stay_behind<'a>(
    bisection: &mut Bisection,
    limits: &'a mut Vec<(Second, Metre)>,
    [ego, foe]: [&SteadyMotion; 2],
    braking: &LateBraking,
    meets: Second,
) -> Option<Evasion<&'a [(Second, Metre)]>> {
    limits.clear();
    let ahead = 2.0 * meets;
    let straight = (ego.straight_for(ego.travel(ahead)), foe.straight_for(foe.travel(ahead)));
    if let (Some((of_ego, _)), Some((of_foe, _))) = straight
        && of_ego.axis.dot(&of_foe.axis) > 1.0 - PARALLEL
    {
        let along = (of_foe.centre - of_ego.centre).dot(&of_ego.axis);
        let room = along - of_ego.half_length - of_foe.half_length;
        let leader = Leader { room: room.max(0.0), speed: foe.speed, deceleration: foe.deceleration };
        return (along > 0.0).then_some(Evasion::Behind(leader));
    }
    bisection.clear();
    let late = |time: Second| {
        let distance = contact_distance(bisection, ego, &foe.at(time), ego.travel(time));
        if distance == 0.0 {
            return f64::INFINITY;
        }
        if distance == f64::INFINITY {
            return 0.0;
        }
        limits.push((time, distance));
        // How much sooner than the contact it has to brake; of waits that are too long already, the least is the worst.
        (meets + HORIZON - braking.longest_wait_at(time, distance)).clamp(0.0, 2.0 * HORIZON)
    };
    if !largest_need(late, meets).is_finite() {
        return None;
    }
    keep_binding(limits);
    let wait = |(time, distance): &(Second, Metre)| braking.longest_wait_at(*time, *distance);
    let binding = (0..limits.len()).min_by(|one, other| wait(&limits[*one]).total_cmp(&wait(&limits[*other])));
    if let Some(binding) = binding {
        limits.swap(0, binding);
    }
    Some(Evasion::At(limits))
}

/// Removes each limit that holds where another does: one at most as far at a later time is stricter, because the
/// ego does not drive back.
fn keep_binding(limits: &mut Vec<(Second, Metre)>) {
    limits.sort_by(|(one, _), (other, _)| other.total_cmp(one));
    let mut nearest = f64::INFINITY;
    limits.retain(|(_, distance)| {
        let binds = *distance < nearest;
        nearest = nearest.min(*distance);
        binds
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detection::measures::ttc::time_to_collision;
    use crate::detection::path::{Pose, arc};
    use crate::geometry::Point;
    use crate::geometry::exact::touches;
    use crate::geometry::rectangle::direction;
    use fastrand::Rng;

    struct Drive {
        poses: Vec<Pose>,
        speed: f64,
        deceleration: f64,
    }

    impl Drive {
        fn new((x, y): (f64, f64), heading: f64, speed: f64, deceleration: f64, curvature: f64) -> Self {
            let (front, axis) = (Point::new(x, y), direction(heading));
            let mut poses = vec![Pose { distance: 0.0, front, axis }];
            arc::poses(front, axis, curvature, 5.0, &[speed * HORIZON], &mut poses);
            Self { poses, speed, deceleration }
        }

        fn motion(&self) -> SteadyMotion<'_> {
            let Self { poses, speed, deceleration } = self;
            SteadyMotion { poses, speed: *speed, deceleration: *deceleration, length: 5.0, width: 2.0 }
        }

        fn braking(&self) -> LateBraking {
            LateBraking { speed: self.speed, present: self.deceleration, build_up: 0.1, deceleration: 8.0 }
        }

        /// Its distance after each hundredth of a second, if it brakes fully after a wait.
        fn driven(&self, wait: Second) -> Vec<f64> {
            const STEP: f64 = 1e-3;
            let (mut speed, mut travelled, mut travelled_at) = (self.speed, 0.0, vec![0.0]);
            for step in 1..=20_000 {
                let time = f64::from(step) * STEP - STEP / 2.0;
                let harder = ((time - wait) / 0.1).clamp(0.0, 1.0) * (8.0 - self.deceleration).max(0.0);
                let next = (speed - (self.deceleration + harder) * STEP).max(0.0);
                travelled += (speed + next) / 2.0 * STEP;
                speed = next;
                if step % 10 == 0 {
                    travelled_at.push(travelled);
                }
            }
            travelled_at
        }
    }

    /// Whether an ego that waits so long touches the foe before a time, if it is `further` ahead throughout.
    fn touch(ego: &Drive, foe: &Drive, wait: Second, further: f64, until: Second) -> bool {
        let at = |drive: &Drive, travelled: f64| {
            let steady = SteadyMotion { deceleration: 0.0, speed: 1.0, ..drive.motion() };
            steady.at(travelled.max(0.0))
        };
        let travelled_at = ego.driven(wait).into_iter().zip(foe.driven(f64::INFINITY));
        travelled_at
            .take((until * 100.0) as usize)
            .any(|(own, other)| touches(&at(ego, own + further), &at(foe, other)))
    }

    fn wait_of(ego: &Drive, foe: &Drive) -> Option<(f64, f64)> {
        let (mut bisection, mut limits) = (Bisection::default(), Vec::new());
        let pair = [&ego.motion(), &foe.motion()];
        let meets = time_to_collision(pair[0], pair[1]).filter(|meets| *meets > 0.0)?;
        let evasion = to_stay_behind(&mut bisection, &mut limits, pair, &ego.braking(), meets)?;
        Some((evasion.longest_wait(&ego.braking()), meets))
    }

    #[test]
    fn the_wait_avoids_contact_and_a_little_longer_does_not() {
        let mut chance = Rng::with_seed(1);
        let mut between = |low: f64, high: f64| low + (high - low) * chance.f64();
        let [mut enough, mut needed, mut all] = [0; 3];
        while all < 200 {
            let [of_ego, of_foe] = [(); 2].map(|()| if between(0.0, 1.0) < 0.5 { 0.0 } else { between(0.0, 4.0) });
            let ego = Drive::new((0.0, 0.0), 0.0, between(2.0, 30.0), of_ego, between(-0.02, 0.02));
            let place = (between(5.0, 80.0), between(-40.0, 40.0));
            let foe = Drive::new(place, between(-2.0, 2.0), between(0.0, 20.0), of_foe, between(-0.02, 0.02));
            let Some((wait, meets)) =
                wait_of(&ego, &foe).filter(|(wait, meets)| *meets < 5.0 && (0.05..5.0).contains(wait))
            else {
                continue;
            };
            all += 1;
            enough += u32::from(!touch(&ego, &foe, wait, -0.1, 1.5 * meets));
            needed += u32::from(touch(&ego, &foe, wait + 0.05, 0.1, 2.0 * HORIZON));
        }
        assert!(100 * enough >= 98 * all && 100 * needed >= 98 * all, "{enough} and {needed} of {all}");
    }

    #[test]
    fn limits_that_do_not_bind_change_no_wait() {
        let mut chance = Rng::with_seed(2);
        for _ in 0..200 {
            let mut draw = |most: f64| most * chance.f64();
            let mut limits = (0..30).map(|_| (draw(10.0), draw(60.0))).collect::<Vec<_>>();
            let all = limits.clone();
            let braking = LateBraking { speed: draw(30.0), present: draw(3.0), build_up: draw(0.5), deceleration: 8.0 };
            keep_binding(&mut limits);
            assert!(limits.len() < all.len());
            // How much too late it is already may differ.
            let [kept, all] = [&limits, &all].map(|limits| Evasion::At(&limits[..]).longest_wait(&braking).max(0.0));
            assert!(kept == all || (kept - all).abs() < 1e-12 * kept, "{kept}, not {all}");
        }
    }

    #[test]
    fn a_follower_has_the_time_of_its_room_at_the_closing_speed() {
        let (ego, leader) = (Drive::new((0.0, 0.0), 0.0, 20.0, 0.0, 0.0), Drive::new((35.0, 0.0), 0.0, 12.0, 0.0, 0.0));
        // 8 m/s are braked away over 4 m, and 0.4 m more while the deceleration builds up; 30 m are left.
        let (wait, _) = wait_of(&ego, &leader).unwrap();
        assert!((wait - (30.0 - 4.0 - 0.4 + 8.0 * 0.01 / 24.0) / 8.0).abs() < 1e-9, "{wait}");
    }

    #[test]
    fn a_foe_that_comes_to_where_the_ego_is_leaves_it_nothing() {
        let ego = Drive::new((0.0, 0.0), 0.0, 5.0, 0.0, 0.0);
        let crossing = Drive::new((-2.0, -20.0), std::f64::consts::FRAC_PI_2, 10.0, 0.0, 0.0);
        let slow = Drive { speed: 0.1, ..ego };
        assert_eq!(wait_of(&slow, &crossing), None);
    }
}
