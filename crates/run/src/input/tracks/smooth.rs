//! Places and headings of a track smoothed: Kalman's [`filter`](super::kalman) forward, then Rauch, Tung and Striebel's smoother back (AIAA
//! Journal 3, 1965). Each piece between two jumps is smoothed alone, so that a jump stays what it is.

use std::ops::Range;

use super::kalman::{Filter, Filtered, Jump, Model, jump};
use super::spill::Row;
use closecall::util::units::Metre;

/// Spectral density of the change of the turning speed, in rad²/s⁵.
const TURNING: f64 = 1.0;
/// Standard deviations of a turning speed and its change before a track is known, in SI units.
const UNKNOWN_TURN: [f64; 2] = [1.0, 1.0];
/// A velocity below this number of standard deviations is that of a road user that stands.
const MOVES: f64 = 3.0;

/// Smooths tracks one after the other; its memory is reused.
pub(super) struct Smoother {
    noise: Metre,
    filtered: Vec<Filtered>,
}

impl Smoother {
    /// For places with noise of this standard deviation.
    pub fn new(noise: Metre) -> Self {
        Self { noise, filtered: Vec::new() }
    }

    /// Smooths a track, its places and headings, and finds its jumps. Adds the headings and speeds that it lacks, where the road user
    /// moves, and returns their numbers. Jumps and numbers are those of `wanted` rows; the others are only there to smooth these.
    pub fn smooth(&mut self, track: &mut [Row], wanted: Range<usize>, jumped: impl FnMut(Jump)) -> [u64; 2] {
        self.filter(track, Model::of_places(self.noise), |row| [row.values[0], row.values[1]]);
        let rows = track.iter().zip(&self.filtered).take(wanted.end).skip(wanted.start.max(1));
        rows.filter(|(_, step)| step.begins).map(|(row, step)| jump(row, step)).for_each(jumped);
        let mut added = [0, 0];
        self.smooth_back();
        for (number, (row, step)) in track.iter_mut().zip(&self.filtered).enumerate() {
            let [x, y] = [0, 1].map(|of| step.state[(0, of)]);
            let [vx, vy] = [0, 1].map(|of| step.state[(1, of)]);
            let moves = vx.hypot(vy) > MOVES * step.covariance[(1, 1)].sqrt();
            let values = &mut row.values;
            (values[0], values[1]) = (x, y);
            if values[3].is_nan() {
                added[1] += u64::from(wanted.contains(&number));
                values[3] = if moves { vx.hypot(vy) } else { 0.0 };
            }
        }
        self.smooth_headings(track, &wanted, &mut added);
        added
    }

    /// Smooths the headings where all are given, and derives them from the velocities where none is.
    fn smooth_headings(&mut self, track: &mut [Row], wanted: &Range<usize>, added: &mut [u64; 2]) {
        if track.iter().any(|row| row.values[2].is_nan()) {
            let rows = track.iter_mut().zip(&self.filtered).enumerate();
            for (number, (row, step)) in rows.filter(|(_, (row, _))| row.values[2].is_nan()) {
                let [vx, vy] = [0, 1].map(|of| step.state[(1, of)]);
                if vx.hypot(vy) > MOVES * step.covariance[(1, 1)].sqrt() {
                    added[0] += u64::from(wanted.contains(&number));
                    row.values[2] = vy.atan2(vx);
                }
            }
            return;
        }
        // As if both ends of the road user were found with the noise of a place.
        let length = track.first().map_or(1.0, |row| row.values[4]).max(1.0);
        let noise = std::f64::consts::SQRT_2 * self.noise / length;
        let begins = self.filtered.iter().map(|step| step.begins).collect::<Vec<_>>();
        let mut before = track.first().map_or(0.0, |row| row.values[2]);
        for row in track.iter_mut() {
            let turned = row.values[2] - before;
            before += turned - std::f64::consts::TAU * (turned / std::f64::consts::TAU).round();
            row.values[2] = before;
        }
        let turns = Model { noise, density: TURNING, unknown: UNKNOWN_TURN, least_jump: std::f64::consts::FRAC_PI_4 };
        self.filter(track, turns, |row| [row.values[2], 0.0]);
        for (step, begins) in self.filtered.iter_mut().zip(begins) {
            step.begins |= begins;
        }
        self.smooth_back();
        for (row, step) in track.iter_mut().zip(&self.filtered) {
            row.values[2] = step.state[(0, 0)];
        }
    }

    /// The filter, from the first row to the last.
    fn filter(&mut self, track: &[Row], model: Model, value: impl Fn(&Row) -> [f64; 2]) {
        let mut filter = Filter::new(model);
        self.filtered.clear();
        self.filtered.extend(track.iter().map(|row| filter.step(row.time, value(row))));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::tracks::kalman::JumpFinder;

    /// A track of 10 s at 25 Hz that speeds up and turns; noise of 0.3 m if wanted.
    fn track(noise: bool) -> Vec<Row> {
        let shake = |step: u32, by: u32| 0.3 * 1.73 * (f64::from(step.wrapping_mul(by) % 1009) / 504.0 - 1.0);
        let row = |step: u32| {
            let time = f64::from(step) / 25.0;
            let distance = 5.0 * time + 0.5 * time * time;
            let angle = distance / 40.0;
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
        let added = Smoother::new(0.3).smooth(&mut found, 0..250, |_| jumps += 1);
        assert_eq!((jumps, added), (0, [250, 250]));
        assert!(rms(&noisy, &truth) > 0.4 && rms(&found, &truth) < 0.15, "{}", rms(&found, &truth));
        for row in &found[25..225] {
            assert!((row.values[3] - 5.0 - row.time).abs() < 0.5, "{row:?}");
            assert!((row.values[2] - (5.0 * row.time + 0.5 * row.time * row.time) / 40.0).abs() < 0.1, "{row:?}");
        }
    }

    #[test]
    fn a_jump_is_found_and_kept() {
        let mut found = track(false);
        found[100..].iter_mut().for_each(|row| row.values[1] += 3.0);
        let mut finder = JumpFinder::default();
        let unsmoothed = found.iter().filter_map(|row| finder.next(row)).collect::<Vec<_>>();
        let mut jumps = Vec::new();
        Smoother::new(0.1).smooth(&mut found, 0..250, |jump| jumps.push(jump));
        for jumps in [unsmoothed, jumps] {
            assert_eq!(jumps.iter().map(|jump| (jump.user, jump.time)).collect::<Vec<_>>(), [(3, 4.0)]);
        }
        let moved = found[100].values[1] - found[99].values[1];
        assert!(moved > 2.8, "{moved}");
    }

    #[test]
    fn the_first_row_of_another_road_user_is_no_jump() {
        let mut finder = JumpFinder::default();
        let of_another = track(false).into_iter().map(|row| Row { user: 4, ..row });
        assert!(track(false).into_iter().chain(of_another).all(|row| finder.next(&row).is_none()));
    }

    #[test]
    fn headings_beyond_a_whole_turn_are_smoothed_across_it() {
        let mut found = track(false);
        for (step, row) in (0..).zip(&mut found) {
            let shake = if step % 2 == 0 { 0.05 } else { -0.05 };
            row.values[2] = (3.1 + 0.01 * f64::from(step) + shake + 4.0).rem_euclid(std::f64::consts::TAU) - 4.0;
        }
        Smoother::new(0.2).smooth(&mut found, 0..250, |_| ());
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
        Smoother::new(0.3).smooth(&mut found, 0..250, |_| ());
        assert!(found.iter().filter(|row| row.values[3] == 0.0).count() > 230);
    }
}
