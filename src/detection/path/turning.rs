//! The curvature of a road user's path, from its headings over the last second or so.
//!
//! With s the distance driven and h the heading, the curvature κ is the slope of the line that fits h over s best:
//!
//! ```text
//! κ = Σ(s − s̄)(h − h̄) / Σ(s − s̄)²
//! ```
//!
//! Headings are measured with noise, and a curve that noise alone explains does not count: the path is straight unless |κ| is
//! above three standard errors. With n states and the sum R of squared residuals
//!
//! ```text
//! error² = (R + σ₀²) / (n − 1) / Σ(s − s̄)²
//! ```
//!
//! σ₀ is the noise assumed before any residual is known: a prior of one observation, without which two states would fit any
//! circle. For exact states R is 0, so that the error soon vanishes.

use std::collections::VecDeque;

use super::turn;
use crate::geometry::{Point, Vector};
use crate::util::units::{Metre, Radian, Second};

/// The window lasts at least this long, and is at least this far: a slow road user turns over metres, not seconds.
const LASTS: Second = 1.0;
const REACHES: Metre = 2.0;
/// States are kept that are at least this part of the window apart. It bounds their number; all of a recording at 30 Hz
/// are kept.
const PART: f64 = 1.0 / 32.0;
const MOST: usize = 34;
/// The noise of headings, until they show their own.
const HEADING_NOISE: Radian = 0.5 * std::f64::consts::PI / 180.0;
/// A curvature of fewer standard errors is none.
const SIGNIFICANT: f64 = 3.0;
/// Over a shorter distance, rounding dominates the curvature, in m.
const SHORTEST: Metre = 0.05;
/// The radius of SUMO's tightest hairpins, in m; a smaller one means that the vehicle was moved.
const SMALLEST_RADIUS: Metre = 2.0;
/// Rounding of times, in s.
const ROUNDING: Second = 1e-6;

/// A road user's heading at a place of its way.
#[derive(Clone, Copy, Debug)]
struct Seen {
    time: Second,
    /// Distance driven by then.
    driven: Metre,
    /// Angle turned by then.
    turned: Radian,
}

impl Seen {
    /// Whether it is this part of the window ahead of another.
    fn is_ahead(&self, other: &Self, part: f64) -> bool {
        self.time - other.time >= part * LASTS - ROUNDING && (self.driven - other.driven).abs() >= part * REACHES
    }
}

/// A road user's curvature, and the window that it is from.
#[derive(Clone, Debug, Default)]
pub struct Turning {
    /// In 1/m, positive to the left; 0 where it cannot be told from noise.
    pub curvature: f64,
    window: VecDeque<Seen>,
    /// Place and heading of the last state of the window.
    last: Option<(Point, Vector)>,
}

impl Turning {
    /// Forgets the road user; the memory is kept.
    pub fn clear(&mut self) {
        self.window.clear();
        self.last = None;
        self.curvature = 0.0;
    }

    /// Takes in the next state of the road user.
    pub fn see(&mut self, time: Second, front: Point, axis: Vector) {
        self.see_within(1.0, time, front, axis);
    }

    /// [`Turning::see`] with the window scaled by a factor.
    pub fn see_within(&mut self, windows: f64, time: Second, front: Point, axis: Vector) {
        let (Some(last), Some((last_front, last_axis))) = (self.window.back().copied(), self.last) else {
            self.window.reserve(MOST);
            return self.keep(Seen { time, driven: 0.0, turned: 0.0 }, front, axis);
        };
        let turned = turn(&last_axis, &axis);
        let driven = arc_length(front - last_front, turned, last_axis + axis);
        let now = Seen { time, driven: last.driven + driven, turned: last.turned + turned };
        while self.window.get(1).is_some_and(|second| now.is_ahead(second, windows)) {
            self.window.pop_front();
        }
        self.curvature = curvature(self.window.iter().chain([&now]));
        if now.is_ahead(&last, PART * windows) {
            self.keep(now, front, axis);
        }
    }

    fn keep(&mut self, seen: Seen, front: Point, axis: Vector) {
        self.window.push_back(seen);
        self.last = Some((front, axis));
    }
}

/// The length of an arc with this chord and turn, 2 · radius · sin(turn/2) being the chord; negative if it leads back.
fn arc_length(chord: Vector, turned: Radian, ahead: Vector) -> Metre {
    let half = turned / 2.0;
    let per_chord = if half.abs() < 1e-6 { 1.0 } else { half / half.sin() };
    (chord.norm() * per_chord).copysign(chord.dot(&ahead))
}

/// The curvature of a way on which these headings, at least two, were seen.
fn curvature<'a>(seen: impl Iterator<Item = &'a Seen> + Clone) -> f64 {
    let count = seen.clone().count() as f64;
    let driven = seen.clone().map(|seen| seen.driven).sum::<f64>() / count;
    let turned = seen.clone().map(|seen| seen.turned).sum::<f64>() / count;
    let (mut across, mut both, mut along) = (0.0, 0.0, 0.0);
    for seen in seen {
        let (s, h) = (seen.driven - driven, seen.turned - turned);
        along += s * s;
        both += s * h;
        across += h * h;
    }
    // Of two states `SHORTEST` apart.
    if along < SHORTEST * SHORTEST / 2.0 {
        return 0.0;
    }
    let slope = both / along;
    let residuals = (across - slope * both).max(0.0);
    let error = ((residuals + HEADING_NOISE * HEADING_NOISE) / (count - 1.0) / along).sqrt();
    if slope.abs() < SIGNIFICANT * error {
        return 0.0;
    }
    slope.clamp(-1.0 / SMALLEST_RADIUS, 1.0 / SMALLEST_RADIUS)
}

#[cfg(test)]
mod tests {
    use fastrand::Rng;

    use crate::detection::path::rotated;
    use crate::detection::path::turning::*;
    use crate::geometry::left_of;
    use crate::geometry::rectangle::direction;

    /// The place on a way with this curvature from a distance on, and the heading there.
    fn place(driven: Metre, curvature: f64, from: Metre) -> (Point, f64) {
        let (straight, angle) = (driven.min(from), (driven - from).max(0.0) * curvature);
        let start = Point::new(straight, 0.0);
        let to_centre = left_of(&Vector::new(1.0, 0.0)) / curvature;
        (if angle == 0.0 { start } else { start + to_centre - rotated(&to_centre, angle) }, angle)
    }

    #[test]
    fn exact_states_on_a_circle_have_its_curvature_at_once() {
        for (speed, dt, radius) in [(8.0, 0.1, 10.0), (8.0, 1.0, -10.0), (2.0, 0.5, 6.0), (14.0, 0.04, 50.0)] {
            let mut turning = Turning::default();
            let states = (0..200).map(|step| f64::from(step) * dt);
            let mut exact = 0;
            for time in states {
                let (front, heading) = place(time * speed, 1.0 / radius, 0.0);
                turning.see(time, front, direction(heading));
                let error = turning.curvature * radius - 1.0;
                exact += u32::from(error.abs() < 1e-9);
                assert!(error.abs() < 1e-9 || time < 0.3, "{speed} {dt} {radius} {time}: {}", turning.curvature);
            }
            assert!(exact >= 190, "{exact}");
        }
    }

    #[test]
    fn a_turn_that_begins_is_seen_within_half_a_second() {
        for (dt, noise) in [(0.1, 0.0), (0.04, 0.0), (0.04, 0.1_f64), (0.04, 0.5)] {
            let (mut turning, mut chance) = (Turning::default(), Rng::with_seed(5));
            let mut seen = None;
            for time in (0..200).map(|step| f64::from(step) * dt) {
                let (front, heading) = place(time * 8.0, 0.1, 16.0);
                turning.see(time, front, direction(heading + noise.to_radians() * gauss(&mut chance)));
                if seen.is_none() && turning.curvature > 0.03 {
                    seen = Some(time - 2.0);
                }
                if time > 3.1 {
                    assert!((turning.curvature - 0.1).abs() < 0.01, "{time}: {}", turning.curvature);
                }
            }
            assert!(seen.is_some_and(|after| (0.0..0.5).contains(&after)), "{seen:?}");
        }
    }

    #[test]
    fn noise_of_headings_and_places_alone_is_no_curve() {
        for (heading_noise, place_noise, dt) in [(0.1_f64, 0.01, 0.04), (0.5, 0.1, 0.04), (0.3, 0.05, 0.1)] {
            let (mut curved, mut worst) = (0, 0.0_f64);
            for trial in 0..50 {
                let (mut turning, mut chance) = (Turning::default(), Rng::with_seed(trial));
                for step in 0..200 {
                    let time = f64::from(step) * dt;
                    let error = Vector::new(gauss(&mut chance), gauss(&mut chance)) * place_noise;
                    let heading = heading_noise.to_radians() * gauss(&mut chance);
                    turning.see(time, Point::new(8.0 * time, 0.0) + error, direction(heading));
                    curved += u32::from(turning.curvature != 0.0);
                    worst = worst.max(turning.curvature.abs());
                }
            }
            assert!(curved < 100, "{curved} of 10000 states");
            assert!(heading_noise > 0.1 || worst == 0.0, "{worst}");
        }
    }

    #[test]
    fn a_vehicle_that_stops_in_a_curve_stays_in_it() {
        let mut turning = Turning::default();
        for step in 0..600 {
            let time = f64::from(step) * 0.1;
            let (front, heading) = place((time * 5.0).min(10.0), 0.1, 0.0);
            turning.see(time, front, direction(heading));
        }
        assert!((turning.curvature - 0.1).abs() < 1e-9, "{}", turning.curvature);
    }

    #[test]
    fn the_window_does_not_grow() {
        for (speed, dt) in [(30.0, 0.001), (0.01, 0.1), (1.0, 0.01), (0.0, 0.1), (-3.0, 0.02)] {
            let mut turning = Turning::default();
            for step in 0..20_000 {
                let time = f64::from(step) * dt;
                turning.see(time, Point::new(time * speed, 0.0), Vector::new(1.0, 0.0));
                assert!(turning.window.len() < MOST, "{}", turning.window.len());
            }
        }
    }

    /// A standard normal number, from twelve uniform ones.
    fn gauss(chance: &mut Rng) -> f64 {
        (0..12).map(|_| chance.f64()).sum::<f64>() - 6.0
    }
}
