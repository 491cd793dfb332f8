//! Places and headings of a track smoothed: Kalman's filter forward, then Rauch, Tung and Striebel's smoother back (AIAA Journal 3,
//! 1965). The model is that of a constant acceleration, which white noise changes; steps may be of any length.
//!
//! Where a place is further from its prediction than a vehicle can drive, the track jumps. Each piece is smoothed alone, so
//! that a jump stays what it is.

use nalgebra::{Matrix1x3, Matrix3, Matrix3x2, Vector3};

use super::spill::Row;
use crate::geometry::Point;
use crate::util::units::{Metre, Second};

/// The noise of the places of a recording that is not smoothed, in m: that which the drones' data sets state.
pub const USUAL_NOISE: Metre = 0.1;
/// Spectral density of the jerk, in m²/s⁵. Of 1, 3, 10, 30 and 100 the error of places at 25 Hz with white noise of 0.1 and 0.3 m differs
/// by 25 % at most in `sumo_nets/roundabout` and `reckless`; it is 5 % less with 3.
const JERK: f64 = 10.0;
/// That of the heading, in rad²/s⁵.
const TURNING: f64 = 1.0;
/// Standard deviations of a speed, an acceleration, a turning speed and its change before a track is known, in SI units.
const UNKNOWN: [f64; 2] = [40.0, 5.0];
const UNKNOWN_TURN: [f64; 2] = [1.0, 1.0];
/// A value further from its prediction than this number of standard deviations is not noise.
const SURE: f64 = 5.0;
/// A velocity below this number of standard deviations is that of a road user that stands.
const MOVES: f64 = 3.0;
/// A place nearer than this to its prediction is not a jump, in m: two vehicles that exchange identities are further apart.
const LEAST_JUMP: Metre = 2.0;

/// A place that its road user cannot have driven to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Jump {
    pub user: u32,
    pub time: Second,
    /// Where it was expected.
    pub expected: Point,
    pub found: Point,
}

/// Value, its change and the change of that, of two quantities.
type State = Matrix3x2<f64>;

/// How noisy values are, and how they change.
#[derive(Clone, Copy)]
struct Model {
    noise: f64,
    density: f64,
    unknown: [f64; 2],
    /// The least distance of a value from its prediction that is not noise.
    least_jump: f64,
}

/// A step of the filter, as the smoother needs it.
struct Filtered {
    transition: Matrix3<f64>,
    predicted: State,
    predicted_covariance: Matrix3<f64>,
    state: State,
    covariance: Matrix3<f64>,
    /// Whether the track jumps here, and the smoother does not look back beyond.
    begins: bool,
}

/// Smooths tracks one after the other; its memory is reused.
pub(super) struct Smoother {
    noise: Option<Metre>,
    filtered: Vec<Filtered>,
}

impl Smoother {
    /// For places with noise of this standard deviation; none if they are not to be smoothed, but only searched for jumps.
    pub fn new(noise: Option<Metre>) -> Self {
        Self { noise, filtered: Vec::new() }
    }

    /// Finds the jumps of a track and smooths it, if that is wanted: its places and headings. Adds the headings and speeds that it lacks,
    /// where the road user moves, and returns their numbers.
    pub fn smooth(&mut self, track: &mut [Row], mut jumped: impl FnMut(Jump)) -> [u64; 2] {
        let noise = self.noise.unwrap_or(USUAL_NOISE);
        let places = Model { noise, density: JERK, unknown: UNKNOWN, least_jump: LEAST_JUMP };
        self.filter(track, &places, |row| [row.values[0], row.values[1]]);
        for (row, step) in track.iter().zip(&self.filtered).skip(1).filter(|(_, step)| step.begins) {
            let expected = Point::new(step.predicted[(0, 0)], step.predicted[(0, 1)]);
            let found = Point::new(row.values[0], row.values[1]);
            jumped(Jump { user: row.user, time: row.time, expected, found });
        }
        if self.noise.is_none() {
            return [0, 0];
        }
        let mut added = [0, 0];
        self.smooth_back();
        for (row, step) in track.iter_mut().zip(&self.filtered) {
            let [x, y] = [0, 1].map(|of| step.state[(0, of)]);
            let [vx, vy] = [0, 1].map(|of| step.state[(1, of)]);
            let moves = vx.hypot(vy) > MOVES * step.covariance[(1, 1)].sqrt();
            let values = &mut row.values;
            (values[0], values[1]) = (x, y);
            if values[3].is_nan() {
                added[1] += 1;
                values[3] = if moves { vx.hypot(vy) } else { 0.0 };
            }
        }
        self.smooth_headings(track, noise, &mut added);
        added
    }

    /// Smooths the headings where all are given, and derives them from the velocities where none is.
    fn smooth_headings(&mut self, track: &mut [Row], noise: Metre, added: &mut [u64; 2]) {
        if track.iter().any(|row| row.values[2].is_nan()) {
            for (row, step) in track.iter_mut().zip(&self.filtered).filter(|(row, _)| row.values[2].is_nan()) {
                let [vx, vy] = [0, 1].map(|of| step.state[(1, of)]);
                if vx.hypot(vy) > MOVES * step.covariance[(1, 1)].sqrt() {
                    added[0] += 1;
                    row.values[2] = vy.atan2(vx);
                }
            }
            return;
        }
        // As if both ends of the road user were found with the noise of a place.
        let length = track.first().map_or(1.0, |row| row.values[4]).max(1.0);
        let noise = std::f64::consts::SQRT_2 * noise / length;
        let begins = self.filtered.iter().map(|step| step.begins).collect::<Vec<_>>();
        let mut before = track.first().map_or(0.0, |row| row.values[2]);
        for row in track.iter_mut() {
            let turned = row.values[2] - before;
            before += turned - std::f64::consts::TAU * (turned / std::f64::consts::TAU).round();
            row.values[2] = before;
        }
        let turns = Model { noise, density: TURNING, unknown: UNKNOWN_TURN, least_jump: std::f64::consts::FRAC_PI_4 };
        self.filter(track, &turns, |row| [row.values[2], 0.0]);
        for (step, begins) in self.filtered.iter_mut().zip(begins) {
            step.begins |= begins;
        }
        self.smooth_back();
        for (row, step) in track.iter_mut().zip(&self.filtered) {
            row.values[2] = step.state[(0, 0)];
        }
    }

    /// Kalman's filter, from the first row to the last.
    fn filter(&mut self, track: &[Row], model: &Model, value: impl Fn(&Row) -> [f64; 2]) {
        let Model { noise, density, unknown: [change, change_of_change], least_jump } = *model;
        let measured = Matrix1x3::new(1.0, 0.0, 0.0);
        let variance = noise * noise;
        let unknown = Vector3::new(variance, change * change, change_of_change * change_of_change);
        let first = |[x, y]: [f64; 2]| (State::new(x, y, 0.0, 0.0, 0.0, 0.0), Matrix3::from_diagonal(&unknown));
        self.filtered.clear();
        let mut time = f64::NAN;
        for row in track {
            let found = value(row);
            let lasted = if time.is_nan() { 0.0 } else { row.time - time };
            time = row.time;
            let transition = Matrix3::new(1.0, lasted, lasted * lasted / 2.0, 0.0, 1.0, lasted, 0.0, 0.0, 1.0);
            let step = match self.filtered.last() {
                None => {
                    let (state, covariance) = first(found);
                    Filtered {
                        transition,
                        predicted: state,
                        predicted_covariance: covariance,
                        state,
                        covariance,
                        begins: true,
                    }
                }
                Some(last) => {
                    let predicted = transition * last.state;
                    let predicted_covariance =
                        transition * last.covariance * transition.transpose() + jerks(lasted) * density;
                    let off = [found[0] - predicted[(0, 0)], found[1] - predicted[(0, 1)]];
                    let expected = predicted_covariance[(0, 0)] + variance;
                    let begins = off[0].hypot(off[1]) > least_jump.max(SURE * expected.sqrt());
                    let (state, covariance) = if begins {
                        first(found)
                    } else {
                        let gain = predicted_covariance.column(0) / expected;
                        let state = predicted + gain * nalgebra::RowVector2::new(off[0], off[1]);
                        (state, (Matrix3::identity() - gain * measured) * predicted_covariance)
                    };
                    Filtered { transition, predicted, predicted_covariance, state, covariance, begins }
                }
            };
            self.filtered.push(step);
        }
    }

    /// The smoother, from the last row to the first.
    fn smooth_back(&mut self) {
        for number in (1..self.filtered.len()).rev() {
            let (before, after) = self.filtered.split_at_mut(number);
            let (Some(this), Some(next)) = (before.last_mut(), after.first()) else { return };
            let Some(inverse) = next.predicted_covariance.try_inverse().filter(|_| !next.begins) else { continue };
            let gain = this.covariance * next.transition.transpose() * inverse;
            this.state += gain * (next.state - next.predicted);
            this.covariance += gain * (next.covariance - next.predicted_covariance) * gain.transpose();
        }
    }
}

/// The covariance that white jerk of density 1 adds within a time.
fn jerks(lasted: Second) -> Matrix3<f64> {
    let power = |exponent: i32| lasted.powi(exponent);
    let [a, b, c] = [power(5) / 20.0, power(4) / 8.0, power(3) / 6.0];
    Matrix3::new(a, b, c, b, power(3) / 3.0, power(2) / 2.0, c, power(2) / 2.0, lasted)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A track of 10 s at 25 Hz that speeds up and turns; noise of 0.3 m if wanted.
    fn track(noise: bool) -> Vec<Row> {
        let shake = |step: u32, by: u32| 0.3 * 1.73 * (f64::from(step.wrapping_mul(by) % 1009) / 504.0 - 1.0);
        let row = |step: u32| {
            let time = f64::from(step) / 25.0;
            let way = 5.0 * time + 0.5 * time * time;
            let angle = way / 40.0;
            let off = if noise { [shake(step, 7919), shake(step, 104_729)] } else { [0.0; 2] };
            let values =
                [40.0 * angle.sin() + off[0], 40.0 * (1.0 - angle.cos()) + off[1], f64::NAN, f64::NAN, 4.5, 1.8];
            Row { user: 3, class: 0, time, values }
        };
        (0..250).map(row).collect()
    }

    fn rms(found: &[Row], truth: &[Row]) -> f64 {
        let off = found.iter().zip(truth).map(|(a, b)| (a.values[0] - b.values[0]).hypot(a.values[1] - b.values[1]));
        (off.map(|off| off * off).sum::<f64>() / found.len() as f64).sqrt()
    }

    #[test]
    fn noise_becomes_less_and_speeds_follow() {
        let (truth, noisy) = (track(false), track(true));
        let mut found = noisy.clone();
        let mut jumps = 0;
        let added = Smoother::new(Some(0.3)).smooth(&mut found, |_| jumps += 1);
        assert_eq!((jumps, added), (0, [250, 250]));
        assert!(rms(&noisy, &truth) > 0.4 && rms(&found, &truth) < 0.15, "{}", rms(&found, &truth));
        for row in &found[25..225] {
            assert!((row.values[3] - 5.0 - row.time).abs() < 0.5, "{row:?}");
            assert!((row.values[2] - (5.0 * row.time + 0.5 * row.time * row.time) / 40.0).abs() < 0.1, "{row:?}");
        }
    }

    #[test]
    fn without_a_wish_nothing_changes() {
        let mut found = track(true);
        assert_eq!(Smoother::new(None).smooth(&mut found, |_| ()), [0, 0]);
        assert!(found.iter().zip(track(true)).all(|(a, b)| a.values[..2] == b.values[..2] && a.values[3].is_nan()));
    }

    #[test]
    fn a_jump_is_found_and_kept() {
        for wish in [None, Some(0.1)] {
            let mut found = track(false);
            found[100..].iter_mut().for_each(|row| row.values[1] += 3.0);
            let mut jumps = Vec::new();
            Smoother::new(wish).smooth(&mut found, |jump| jumps.push(jump));
            assert_eq!(jumps.iter().map(|jump| (jump.user, jump.time)).collect::<Vec<_>>(), [(3, 4.0)]);
            let moved = found[100].values[1] - found[99].values[1];
            assert!(moved > 2.8, "{moved}");
        }
    }

    #[test]
    fn headings_beyond_a_whole_turn_are_smoothed_across_it() {
        let mut found = track(false);
        for (step, row) in (0..).zip(&mut found) {
            let shake = if step % 2 == 0 { 0.05 } else { -0.05 };
            row.values[2] = (3.1 + 0.01 * f64::from(step) + shake + 4.0).rem_euclid(std::f64::consts::TAU) - 4.0;
        }
        Smoother::new(Some(0.2)).smooth(&mut found, |_| ());
        for (step, row) in (0..).zip(&found).skip(20).take(200) {
            let off = row.values[2] - 3.1 - 0.01 * f64::from(step);
            let turns = off / std::f64::consts::TAU;
            assert!((turns - turns.round()).abs() < 0.004, "{step}: {off}");
        }
    }

    #[test]
    fn a_road_user_that_stands_has_no_speed() {
        let mut found = track(true);
        for (row, moving) in found.iter_mut().zip(track(false)) {
            row.values[0] -= moving.values[0];
            row.values[1] -= moving.values[1];
        }
        Smoother::new(Some(0.3)).smooth(&mut found, |_| ());
        assert!(found.iter().filter(|row| row.values[3] == 0.0).count() > 230);
    }
}
