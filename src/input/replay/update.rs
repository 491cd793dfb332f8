//! Over how long a recorded speed is the mean, as the positions show.
//!
//! SUMO's Euler update drives at the speed v₁ of a step's end for the whole step, its ballistic update at (v₀ + v₁)/2. Where
//! each step of the first is recorded, a vehicle moves by v₁ P in the period P; of the second, by (v₀ + v₁)/2 · P; and where
//! every k-th step of the first, by (v₀ + v₁)/2 · P + (v₁ − v₀)/2 · P/k if it speeds up evenly. So the difference from the
//! second tells over how much of the period a speed is the mean: 1, 0, or 1/k of it.

use std::path::Path;

use rustc_hash::FxHashMap;

use super::recording::Recording;
use super::rows::{RecordedRow, RecordedStep};
use crate::util::units::{Metre, MetrePerSecond, Second};
use crate::{Error, Result};

/// Movements of vehicles that change their speed that are enough to tell.
const ENOUGH: u32 = 2000;
/// Rows after which no more are read.
const MOST_ROWS: usize = 200_000;
/// By how much positions may be rounded, in m: recordings have two decimals or more.
const ROUNDED: Metre = 0.02;
/// The largest number of steps of a simulation between two of its recording.
const MOST_STEPS: f64 = 20.0;
/// From this share on, the whole period is meant.
const WHOLE: f64 = 0.75;

/// Over which share of the time between two steps a recorded speed is the mean; 1 where too little shows.
///
/// # Errors
/// Those of [`Recording`], but not that a recording is cut short.
pub(super) fn averaged_over(path: &Path) -> Result<f64> {
    let mut recording = Recording::open(path)?;
    let mut step = RecordedStep::default();
    let mut evidence = Evidence::default();
    let mut rows = 0;
    loop {
        match recording.next_step(&mut step) {
            Ok(true) => evidence.add(&step),
            Ok(false) | Err(Error::CutShort { .. }) => break,
            Err(error) => return Err(error),
        }
        rows += step.rows().len();
        if evidence.movements >= ENOUGH || rows >= MOST_ROWS {
            break;
        }
    }
    Ok(evidence.share())
}

/// What the movements so far show.
#[derive(Default)]
struct Evidence {
    time: Second,
    /// By the recording's number of the vehicle: its lane, position and speed in the last step.
    last: FxHashMap<u32, (u32, Metre, MetrePerSecond)>,
    movements: u32,
    /// The sum of what was driven beyond the ballistic update's distance, where the speed rose; short of it, where it fell.
    beyond: Metre,
    /// The sum of half the changes in speed over half the period.
    at_most: Metre,
}

impl Evidence {
    fn add(&mut self, step: &RecordedStep) {
        let period = step.time - std::mem::replace(&mut self.time, step.time);
        let before = std::mem::take(&mut self.last);
        for row in step.rows().iter().filter(|row| !row.person) {
            self.last.insert(row.user, (row.lane, row.position, row.speed));
            if let Some(&(lane, position, speed)) = before.get(&row.user)
                && lane == row.lane
            {
                self.compare(row, position, speed, period);
            }
        }
    }

    /// Compares the way along the lane with the speeds. One that stops or starts may have done so within the period; one that
    /// drives against its lane or was moved has another way than its speeds tell.
    fn compare(&mut self, row: &RecordedRow, position: Metre, speed: MetrePerSecond, period: Second) {
        let (driven, change) = (row.position - position, row.speed - speed);
        let beyond = driven - (speed + row.speed) / 2.0 * period;
        let at_most = change.abs() / 2.0 * period;
        if change != 0.0 && speed > 0.0 && row.speed > 0.0 && beyond.abs() <= 2.0 * at_most + ROUNDED {
            self.movements += 1;
            self.beyond += change.signum() * beyond;
            self.at_most += at_most;
        }
    }

    fn share(&self) -> f64 {
        if self.at_most == 0.0 {
            return 1.0;
        }
        let share = self.beyond / self.at_most;
        match (1.0 / share).round() {
            _ if share >= WHOLE => 1.0,
            steps if share > 0.0 && steps <= MOST_STEPS => 1.0 / steps,
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(position: Metre, speed: MetrePerSecond) -> RecordedRow {
        RecordedRow {
            user: 0,
            person: false,
            type_name: 0,
            lane: 0,
            x: 0.0,
            y: 0.0,
            z: 0.0,
            angle: 0.0,
            speed,
            position,
            lateral_speed: 0.0,
        }
    }

    /// What a vehicle shows that speeds up and slows down, in a simulation with steps of 0.1 s of which every `kept`-th is
    /// recorded to the centimetre.
    fn share(kept: usize, is_euler: bool) -> f64 {
        const STEP: f64 = 0.1;
        let mut evidence = Evidence::default();
        let (mut position, mut speed) = (0.0, 10.0);
        let mut last = None;
        for number in 1..=400 {
            let before = speed;
            speed += STEP * if (number - 1) / 40 % 2 == 0 { 2.0 } else { -1.9 };
            position += STEP * if is_euler { speed } else { (before + speed) / 2.0 };
            if number % kept != 0 {
                continue;
            }
            let [position, speed] = [position, speed].map(|value: f64| (value * 100.0).round() / 100.0);
            let row = row(position, speed);
            if let Some((position, speed)) = last.replace((position, speed)) {
                evidence.compare(&row, position, speed, STEP * kept as f64);
            }
        }
        evidence.share()
    }

    #[test]
    fn the_update_and_the_steps_between_show() {
        assert_eq!([1, 2, 5, 10].map(|kept| share(kept, true)), [1.0, 0.5, 0.2, 0.1]);
        assert_eq!([1, 2, 5, 10].map(|kept| share(kept, false)), [0.0; 4]);
    }

    #[test]
    fn driving_against_a_lane_tells_nothing() {
        let mut evidence = Evidence::default();
        evidence.compare(&row(12.0, 12.0), 0.0, 10.0, 1.0);
        evidence.compare(&row(-12.0, 12.0), 0.0, 10.0, 1.0);
        assert_eq!((evidence.movements, evidence.share()), (1, 1.0));
    }

    #[test]
    fn without_a_change_in_speed_eulers_is_assumed() {
        assert_eq!(Evidence::default().share(), 1.0);
    }
}
