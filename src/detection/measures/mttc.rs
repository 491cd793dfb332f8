//! Modified TTC and crash index (Ozbay, Yang, Bartin and Mudigonda 2008) of a follower, at constant accelerations.
//!
//! MTTC is the first time t at which the room is used up:
//!
//! ```text
//! gap = (V − Vᵢ) t + (a − aᵢ) t²/2
//! crash index = ((V + a MTTC)² − (Vᵢ + aᵢ MTTC)²) / (2 MTTC)
//! ```
//!
//! The published formula lets a road user that brakes drive backwards once it has stopped; here it stands then. Contacts
//! beyond [`HORIZON`] do not count.

use super::ttc::HORIZON;
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, MetreSquaredPerSecondCubed, Second};

/// The speed and the acceleration of a road user along the ego's path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accelerating {
    /// Its speed in m/s.
    pub speed: MetrePerSecond,
    /// Its acceleration in m/s², below 0 where it brakes.
    pub acceleration: MetrePerSecondSquared,
}

impl Accelerating {
    /// When it stands.
    fn stops_after(&self) -> Second {
        if self.acceleration < 0.0 { self.speed / -self.acceleration } else { f64::INFINITY }
    }

    /// Its state after a time.
    fn after(&self, time: Second) -> Self {
        if time >= self.stops_after() {
            return Self { speed: 0.0, acceleration: 0.0 };
        }
        Self { speed: self.speed + self.acceleration * time, ..*self }
    }
}

/// MTTC in s and the crash index in m²/s³ of a follower and its leader; no index where they touch now. None if they do not
/// touch within [`HORIZON`].
pub fn mttc(
    gap: Metre,
    follower: Accelerating,
    leader: Accelerating,
) -> Option<(Second, Option<MetreSquaredPerSecondCubed>)> {
    let mut stops = [follower.stops_after(), leader.stops_after()];
    stops.sort_by(f64::total_cmp);
    let (mut begin, mut room) = (0.0, gap);
    for end in [stops[0], stops[1], f64::INFINITY].map(|end| end.min(HORIZON)) {
        let [own, other] = [follower.after(begin), leader.after(begin)];
        let (closing, faster) = (own.speed - other.speed, own.acceleration - other.acceleration);
        if let Some(time) = used_up(room, closing, faster).map(|time| begin + time).filter(|time| *time <= end) {
            let [own, other] = [follower, leader].map(|one| one.after(time).speed);
            let index = (own * own - other * other) / (2.0 * time);
            return Some((time, Some(index).filter(|_| time > 0.0)));
        }
        let lasts = end - begin;
        room -= (closing + faster * lasts / 2.0) * lasts;
        begin = end;
    }
    None
}

/// The first time at which the room is used up.
fn used_up(room: Metre, closing: MetrePerSecond, faster: MetrePerSecondSquared) -> Option<Second> {
    if room <= 0.0 {
        return Some(0.0);
    }
    let root = closing.mul_add(closing, 2.0 * faster * room).sqrt();
    Some(2.0 * room / (closing + root)).filter(|time| *time >= 0.0 && time.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use fastrand::Rng;

    /// When small steps use up the room, and both speeds then.
    fn driven(gap: f64, follower: Accelerating, leader: Accelerating) -> Option<(f64, [f64; 2])> {
        const STEP: f64 = 1e-4;
        let (mut room, mut speeds) = (gap, [follower.speed, leader.speed]);
        for step in 0..100_000 {
            if room <= 0.0 {
                return Some((f64::from(step) * STEP, speeds));
            }
            let next = [0, 1].map(|one| {
                let acceleration: f64 = [follower, leader][one].acceleration;
                let stands = speeds[one] == 0.0 && acceleration <= 0.0;
                if stands { 0.0 } else { f64::max(speeds[one] + acceleration * STEP, 0.0) }
            });
            room -= (speeds[0] + next[0] - speeds[1] - next[1]) / 2.0 * STEP;
            speeds = next;
        }
        None
    }

    #[test]
    fn it_is_what_small_steps_say() {
        let mut chance = Rng::with_seed(3);
        let mut between = |low: f64, high: f64| low + (high - low) * chance.f64();
        let mut met = 0;
        for _ in 0..150 {
            let [follower, leader] =
                [(); 2].map(|()| Accelerating { speed: between(0.0, 25.0), acceleration: between(-6.0, 3.0) });
            let gap = between(0.5, 40.0);
            match (mttc(gap, follower, leader), driven(gap, follower, leader)) {
                (Some((time, index)), Some((sampled, [own, other]))) => {
                    met += 1;
                    assert!((time - sampled).abs() < 0.02, "{time}, not {sampled}: {gap} {follower:?} {leader:?}");
                    let expected = (own * own - other * other) / (2.0 * sampled);
                    assert!((index.unwrap() - expected).abs() < 0.02 * expected.abs() + 0.2, "{index:?} {expected}");
                }
                (None, None) => {}
                (found, sampled) => {
                    let at = found.map(|(time, _)| time).or(sampled.map(|(time, _)| time)).unwrap();
                    assert!(at > 9.9, "{found:?}, not {sampled:?}: {gap} {follower:?} {leader:?}");
                }
            }
        }
        assert!(met > 40, "{met}");
    }

    #[test]
    fn it_is_the_published_formula_while_both_move() {
        let (gap, own, other) = (20.0, 15.0, 12.0);
        let (a, b) = (1.0, -2.0);
        let [follower, leader] =
            [(own, a), (other, b)].map(|(speed, acceleration)| Accelerating { speed, acceleration });
        let (time, index) = mttc(gap, follower, leader).unwrap();
        let (dv, da): (f64, f64) = (own - other, a - b);
        let published = (-dv + (dv * dv + 2.0 * da * gap).sqrt()) / da;
        let energy = ((own + a * published).powi(2) - (other + b * published).powi(2)) / 2.0 / published;
        assert!((time - published).abs() < 1e-12 && (index.unwrap() - energy).abs() < 1e-9);
    }
}
