//! How long a driver can wait before it brakes fully, in closed form.
//!
//! The ego goes on with its present deceleration d for a wait w. Then its deceleration rises linearly to a over t3 and
//! stays there until the ego stands. The distance that it still travels is
//!
//! ```text
//! F(w) = V w − d w²/2 + S(V − d w),   S(U) = U t3 − d t3²/2 − (a−d) t3²/6 + (U − (a+d) t3/2)²/(2a)
//!      = S(V) + (1 − d/a) ((V − d t3/2) w − d w²/2)
//! ```
//!
//! if it still moves when the deceleration has built up. So the longest wait with which the ego stops within some
//! room solves a quadratic equation. Behind a foe that moves, the same holds for the speed and the decelerations relative
//! to it, until the foe stands.

use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Second};

/// A road user that goes on with its present deceleration and brakes fully after a wait.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LateBraking {
    /// Speed now, 0 or more.
    pub speed: MetrePerSecond,
    /// Deceleration now, 0 or more.
    pub present: MetrePerSecondSquared,
    /// Build-up time t3 of the full deceleration.
    pub build_up: Second,
    /// Full deceleration, above 0.
    pub deceleration: MetrePerSecondSquared,
}

/// A road user ahead in the same direction. It brakes with its deceleration until it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leader {
    /// Room between the two.
    pub room: Metre,
    /// Its speed, 0 or more.
    pub speed: MetrePerSecond,
    /// Its deceleration, 0 or more.
    pub deceleration: MetrePerSecondSquared,
}

impl LateBraking {
    /// The longest wait, in s, with which it does not touch a leader. Infinite if it need not brake harder than now; below
    /// 0 if even braking at once is too late.
    pub fn longest_wait_behind(&self, leader: &Leader) -> Second {
        let Leader { room, speed, deceleration } = *leader;
        let stands_after = match deceleration {
            _ if speed == 0.0 => 0.0,
            0.0 => f64::INFINITY,
            _ => speed / deceleration,
        };
        let until_both_stand = if stands_after < f64::INFINITY {
            self.relative(0.0, 0.0).longest_wait(room + speed * stands_after / 2.0)
        } else {
            f64::INFINITY
        };
        // While both move, the room is narrowest when their speeds are equal. A leader that brakes harder stands first.
        if speed == 0.0 || deceleration >= self.deceleration {
            return until_both_stand;
        }
        let relative = self.relative(speed, deceleration);
        let until_as_fast = relative.longest_wait(room);
        let is_as_fast_in_time = relative.rests_after(until_as_fast.max(0.0)) <= stands_after;
        if is_as_fast_in_time { until_both_stand.min(until_as_fast) } else { until_both_stand }
    }

    /// The longest wait, in s, with which it has gone no further than a distance at a time. Infinite if it need not brake
    /// harder than now; below 0 if even braking at once is too late.
    pub fn longest_wait_at(&self, time: Second, distance: Metre) -> Second {
        let own = self.relative(0.0, 0.0);
        let excess = self.travel(time) - distance;
        if excess <= 0.0 {
            return f64::INFINITY;
        }
        let more = self.deceleration - self.present;
        if more <= 0.0 {
            return f64::NEG_INFINITY;
        }
        let to_stop = own.longest_wait(distance);
        if own.rests_after(to_stop.max(0.0)) <= time {
            return to_stop;
        }
        // The excess is what the harder braking takes off within the time that is left after the wait.
        let (t3, in_build_up) = (self.build_up, more * self.build_up * self.build_up / 6.0);
        let braked_for = if excess < in_build_up {
            (6.0 * excess * t3 / more).cbrt()
        } else {
            t3 / 2.0 + (2.0 * excess / more - t3 * t3 / 12.0).sqrt()
        };
        time - braked_for
    }

    /// The longest wait, in s, with which it has gone no further than each of these distances at each of these times. It is
    /// quickest if the first of them is the one that decides.
    pub(crate) fn longest_wait_at_all(&self, limits: &[(Second, Metre)]) -> Second {
        let own = self.relative(0.0, 0.0);
        let (mut longest, mut travelled) = (f64::INFINITY, f64::INFINITY);
        for (time, distance) in limits {
            if travelled <= *distance || self.surely_keeps(longest, *time, *distance) {
                continue;
            }
            let wait = self.longest_wait_at(*time, *distance);
            if wait < longest {
                (longest, travelled) = (wait, own.travelled(wait.max(0.0)));
            }
        }
        longest
    }

    /// Whether it surely keeps to a distance at a time after this wait, found without a root or a division.
    fn surely_keeps(&self, wait: Second, time: Second, distance: Metre) -> bool {
        let (t3, more) = (self.build_up, self.deceleration - self.present);
        let braked_for = time - wait - t3 / 2.0;
        let still_moves = self.speed - self.present * time >= more * braked_for;
        let travelled =
            (self.speed - self.present * time / 2.0) * time - more * (braked_for * braked_for / 2.0 + t3 * t3 / 24.0);
        braked_for >= t3 / 2.0 && still_moves && travelled <= distance
    }

    /// The longest wait, in s, with which it and an oncoming vehicle stop within some room, if both wait as long. `share` is
    /// the part of the other's distance that counts.
    pub fn longest_wait_towards(&self, other: &Self, share: f64, room: Metre) -> Second {
        let both = [self.relative(0.0, 0.0), other.relative(0.0, 0.0)];
        let travelled = |wait| both[0].travelled(wait) + share * both[1].travelled(wait);
        if travelled(f64::INFINITY) <= room {
            return f64::INFINITY;
        }
        // Braking at once leaves this much room; a longer wait uses it up at no more than the present speeds.
        let left = room - travelled(0.0);
        if left < 0.0 {
            return f64::NEG_INFINITY;
        }
        let least = left / (self.speed + share * other.speed);
        if self.present == 0.0 && (other.present == 0.0 || share == 0.0) {
            return least;
        }
        let mut most = 2.0 * least + 1.0;
        while travelled(most) <= room {
            most *= 2.0;
        }
        bisect(|wait| travelled(wait) <= room, least, most)
    }

    /// The distance that it travels in a time if it does not brake harder.
    fn travel(&self, time: Second) -> Metre {
        let time = if self.present > 0.0 { time.min(self.speed / self.present) } else { time };
        (self.speed - self.present * time / 2.0) * time
    }

    /// Its motion relative to a vehicle with this speed and deceleration.
    fn relative(&self, speed: MetrePerSecond, deceleration: MetrePerSecondSquared) -> Closing {
        Closing {
            speed: self.speed - speed,
            present: self.present - deceleration,
            full: self.deceleration - deceleration,
            build_up: self.build_up,
        }
    }
}

/// A motion in one dimension that is to end: both decelerations are relative to the one that it approaches.
#[derive(Clone, Copy)]
struct Closing {
    speed: MetrePerSecond,
    /// Deceleration during the wait; below 0 if the one ahead brakes harder.
    present: MetrePerSecondSquared,
    /// Deceleration after the build-up, above 0.
    full: MetrePerSecondSquared,
    build_up: Second,
}

impl Closing {
    /// The longest wait with which the motion ends within some room.
    fn longest_wait(&self, room: Metre) -> Second {
        let Self { speed, present, full, build_up } = *self;
        let ends_by_itself = if present > 0.0 {
            speed <= 0.0 || speed * speed <= 2.0 * present * room
        } else {
            present == 0.0 && speed <= 0.0
        };
        if ends_by_itself {
            return f64::INFINITY;
        }
        if present >= full {
            return f64::NEG_INFINITY;
        }
        if present == 0.0 {
            return (room - self.stopping_distance(speed)) / speed;
        }
        // (V − d t3/2) w − d w²/2 = q
        let q = (room - self.built_up_distance(speed)) / (1.0 - present / full);
        let mean = speed - present * build_up / 2.0;
        let root = (mean * mean - 2.0 * present * q).max(0.0).sqrt();
        // Of a motion that gets faster, the later root: before the other its speed is below 0.
        let wait = if mean > 0.0 { 2.0 * q / (mean + root) } else { (root - mean) / -present };
        if self.is_built_up(speed - present * wait) {
            return wait;
        }
        // It would end before the deceleration has built up: F has no closed inverse there.
        let ends = |wait: Second| self.travelled(wait) <= room;
        let most = if present > 0.0 { speed / present } else { wait };
        if ends(0.0) { bisect(ends, 0.0, most) } else { f64::NEG_INFINITY }
    }

    /// F(w): the distance until the motion ends.
    fn travelled(&self, wait: Second) -> Metre {
        let Self { speed, present, .. } = *self;
        let wait = if present > 0.0 { wait.min(speed / present) } else { wait };
        if wait == f64::INFINITY {
            return if speed > 0.0 { f64::INFINITY } else { 0.0 };
        }
        (speed - present * wait / 2.0) * wait + self.stopping_distance(speed - present * wait)
    }

    /// When the motion ends after a wait.
    fn rests_after(&self, wait: Second) -> Second {
        let speed = self.speed - self.present * wait;
        if self.is_built_up(speed) {
            wait + self.build_up + (speed - self.lost_in_build_up()) / self.full
        } else {
            wait + self.ends_in_build_up(speed)
        }
    }

    /// Whether it still moves when the deceleration has built up.
    fn is_built_up(&self, speed: MetrePerSecond) -> bool {
        self.build_up == 0.0 || speed >= self.lost_in_build_up()
    }

    fn lost_in_build_up(&self) -> MetrePerSecond {
        (self.full + self.present) * self.build_up / 2.0
    }

    /// When a motion at this speed ends within the build-up. A speed below 0 first rises above it if the present
    /// deceleration is below 0; if it never does, the motion ends at once.
    fn ends_in_build_up(&self, speed: MetrePerSecond) -> Second {
        let jerk = (self.full - self.present) / self.build_up;
        let squared = self.present * self.present + 2.0 * jerk * speed;
        if squared < 0.0 || (self.present >= 0.0 && speed <= 0.0) {
            return 0.0;
        }
        let root = squared.sqrt();
        if self.present > 0.0 { 2.0 * speed / (self.present + root) } else { (root - self.present) / jerk }
    }

    /// S(U).
    fn stopping_distance(&self, speed: MetrePerSecond) -> Metre {
        if self.is_built_up(speed) {
            return self.built_up_distance(speed);
        }
        let (time, jerk) = (self.ends_in_build_up(speed), (self.full - self.present) / self.build_up);
        (speed - self.present * time / 2.0 - jerk * time * time / 6.0) * time
    }

    /// S(U) of a motion that lasts longer than the build-up.
    fn built_up_distance(&self, speed: MetrePerSecond) -> Metre {
        let Self { present, full, build_up: t3, .. } = *self;
        let rest = speed - self.lost_in_build_up();
        (speed - present * t3 / 2.0 - (full - present) * t3 / 6.0) * t3 + rest * rest / (2.0 * full)
    }
}

/// The largest value between two at which `holds` is true, up to rounding: true at the lower, and false from there on.
fn bisect(holds: impl Fn(f64) -> bool, low: f64, high: f64) -> f64 {
    let (mut low, mut high) = (low, high);
    loop {
        let middle = low + (high - low) / 2.0;
        if middle <= low || middle >= high || middle.is_nan() {
            return low;
        }
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The distance after each millisecond of a road user that waits and then brakes fully, by small steps.
    fn driven(braking: &LateBraking, wait: Second) -> impl Iterator<Item = Metre> {
        const STEP: Second = 1e-4;
        let (mut speed, mut travelled) = (braking.speed, 0.0);
        let braking = *braking;
        (0..400_000).map(move |step| {
            let time = (f64::from(step) + 0.5) * STEP;
            let built_up = if braking.build_up > 0.0 {
                ((time - wait) / braking.build_up).clamp(0.0, 1.0)
            } else {
                f64::from(time > wait)
            };
            let deceleration = braking.present + (braking.deceleration - braking.present).max(0.0) * built_up;
            let next = (speed - deceleration * STEP).max(0.0);
            travelled += (speed + next) / 2.0 * STEP;
            speed = next;
            travelled
        })
    }

    /// The smallest room that is left behind a leader.
    fn least_room(braking: &LateBraking, leader: &Leader, wait: Second) -> Metre {
        let leads = LateBraking {
            speed: leader.speed,
            present: leader.deceleration,
            build_up: 0.0,
            deceleration: leader.deceleration,
        };
        driven(braking, wait)
            .zip(driven(&leads, 0.0))
            .map(|(own, other)| leader.room + other - own)
            .fold(f64::INFINITY, f64::min)
    }

    fn braking() -> impl Strategy<Value = LateBraking> {
        let present = prop_oneof![Just(0.0), 0.0..6.0];
        let build_up = prop_oneof![Just(0.0), Just(0.1), 0.0..2.0];
        (prop_oneof![0.01..1.0, 1.0..40.0], present, build_up, 6.0..12.0)
            .prop_map(|(speed, present, build_up, deceleration)| LateBraking { speed, present, build_up, deceleration })
    }

    fn leader() -> impl Strategy<Value = Leader> {
        let speed = prop_oneof![Just(0.0), 0.0..40.0];
        let deceleration = prop_oneof![Just(0.0), 0.0..12.0];
        (0.0..100.0, speed, deceleration).prop_map(|(room, speed, deceleration)| Leader { room, speed, deceleration })
    }

    /// What small steps leave in doubt, in m.
    const DOUBT: Metre = 5e-3;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]
        #[test]
        fn the_longest_wait_just_leaves_room_behind_a_leader(braking in braking(), leader in leader()) {
            let wait = braking.longest_wait_behind(&leader);
            if wait < 0.0 {
                prop_assert!(least_room(&braking, &leader, 0.0) < DOUBT);
            } else if wait < 15.0 {
                prop_assert!(least_room(&braking, &leader, wait) > -DOUBT, "{wait} s is too long");
                prop_assert!(least_room(&braking, &leader, wait + 0.05 + 0.01 / braking.speed) < DOUBT, "{wait} s is too short");
            } else {
                prop_assert!(least_room(&braking, &leader, 15.0) > -DOUBT);
            }
        }

        #[test]
        fn the_longest_wait_just_keeps_a_distance_at_a_time(braking in braking(), time in 0.1..10.0, part in 0.0..1.2) {
            let distance = part * braking.speed * time;
            let at = |wait| driven(&braking, wait).nth((time / 1e-4) as usize).unwrap();
            let wait = braking.longest_wait_at(time, distance);
            if wait < 0.0 {
                prop_assert!(at(0.0) > distance - DOUBT);
            } else if wait < f64::INFINITY {
                prop_assert!((at(wait) - distance).abs() < DOUBT, "{wait} s leads to {}", at(wait));
            } else {
                prop_assert!(at(time) < distance + DOUBT);
            }
        }

        #[test]
        fn the_wait_for_many_limits_is_the_least_of_each(
            braking in braking(), limits in prop::collection::vec((0.1..10.0, 0.0..1.2), 1..40)
        ) {
            let limits = limits.into_iter().map(|(time, part)| (time, part * braking.speed * time)).collect::<Vec<_>>();
            let each = limits.iter().map(|(time, distance)| braking.longest_wait_at(*time, *distance));
            let [least, found] = [each.fold(f64::INFINITY, f64::min), braking.longest_wait_at_all(&limits)];
            prop_assert!(found == least || (found - least).abs() < 1e-12 * (1.0 + least.abs()), "{found}, not {least}");
        }

        #[test]
        fn the_longest_wait_of_two_uses_up_their_room(braking in braking(), other in braking(), room in 0.0..200.0) {
            let wait = braking.longest_wait_towards(&other, 1.0, room);
            let travelled = |wait| [&braking, &other].map(|one| driven(one, wait).last().unwrap()).iter().sum::<f64>();
            if wait < 0.0 {
                prop_assert!(travelled(0.0) > room - DOUBT);
            } else if wait < 15.0 {
                prop_assert!((travelled(wait) - room).abs() < DOUBT, "{wait} s leads to {} of {room} m", travelled(wait));
            }
        }
    }

    #[test]
    fn one_that_stops_in_time_anyway_can_wait_for_ever() {
        let braking = LateBraking { speed: 10.0, present: 2.5, build_up: 0.1, deceleration: 9.0 };
        assert_eq!(braking.longest_wait_behind(&Leader { room: 20.1, speed: 0.0, deceleration: 0.0 }), f64::INFINITY);
        assert!(braking.longest_wait_behind(&Leader { room: 19.9, speed: 0.0, deceleration: 0.0 }) < 5.0);
    }

    #[test]
    fn a_slower_ego_is_not_too_late_behind_one_that_brakes() {
        // The room first grows; the build-up of 9 s ends the approach before it is used up.
        let braking = LateBraking { speed: 41.07, present: 0.0, build_up: 9.138, deceleration: 237.98 };
        assert!(braking.longest_wait_behind(&Leader { room: 3.7e-4, speed: 44.67, deceleration: 9.067 }) > 0.0);
    }

    #[test]
    fn a_wait_is_exact_where_the_present_braking_is_weak() {
        // The deceleration does not build up fully before the ego stands, and the present one alone would take
        // 7.7e12 s.
        let braking = LateBraking { speed: 7.7, present: 1e-12, build_up: 2.0, deceleration: 9.75 };
        let steady = LateBraking { present: 0.0, ..braking };
        let leader = Leader { room: 42.5, speed: 0.0, deceleration: 0.0 };
        let found = [braking, steady].map(|braking| braking.longest_wait_behind(&leader));
        assert!((found[0] - found[1]).abs() < 1e-10, "{found:?}");
    }

    #[test]
    fn a_standing_leader_leaves_the_room_less_the_stopping_distance() {
        let braking = LateBraking { speed: 20.0, present: 0.0, build_up: 0.0, deceleration: 8.0 };
        let wait = braking.longest_wait_behind(&Leader { room: 45.0, speed: 0.0, deceleration: 0.0 });
        assert!((wait - 1.0).abs() < 1e-15, "{wait}");
    }
}
