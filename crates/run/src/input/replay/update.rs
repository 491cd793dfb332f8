//! The period over which a recorded speed is the mean, by the positions.
//!
//! SUMO's Euler update drives at the speed v₁ of a step's end for the whole step, its ballistic update at (v₀ + v₁)/2. Where
//! each step of the first is recorded, a vehicle moves by v₁ P in the period P; of the second, by (v₀ + v₁)/2 · P; and where
//! every k-th step of the first, by (v₀ + v₁)/2 · P + (v₁ − v₀)/2 · P/k if it speeds up evenly. So the difference from the
//! second tells over how much of the period a speed is the mean: 1, 0, or 1/k of it. The distance is along the lane; where the
//! place on the lane is not recorded, only straight driving counts.

use std::path::Path;

use rustc_hash::FxHashMap;

use super::lanes::heading;
use super::recorded_step::{RecordedRow, RecordedStep};
use super::recording::Recording;
use crate::net::projection::Projection;
use crate::{Error, Result};
use closecall::geometry::Vector;
use closecall::geometry::rectangle::direction;
use closecall::util::units::{Metre, Second};

/// Movements of vehicles that change their speed that are enough to tell.
const ENOUGH: u32 = 2000;
/// Rows after which no more are read.
const MOST_ROWS: usize = 200_000;
/// By how much positions may be rounded, in m: recordings have two decimals or more.
const ROUNDED: Metre = 0.02;
/// The largest number of steps of a simulation between two of its recording.
const MOST_STEPS: f64 = 20.0;
/// A vehicle whose angle changes by more is not driving straight, in degrees: its arc is longer by less than a ten-thousandth.
const STRAIGHT: f64 = 1.0;
/// From this share on, the whole period is meant.
const WHOLE: f64 = 0.75;

/// Over which share of the time between two steps a recorded speed is the mean; 1 where too little shows.
///
/// # Errors
/// Those of [`Recording`] and [`RecordedStep::project`], but not that a recording is cut short.
pub(super) fn averaged_over(path: &Path, projection: Option<&Projection>) -> Result<f64> {
    let mut recording = Recording::open(path)?;
    let mut step = RecordedStep::default();
    let mut evidence = Evidence::default();
    let mut rows = 0;
    loop {
        match recording.next_step(&mut step) {
            Ok(true) => {
                let projected = projection.map_or(Ok(()), |projection| step.project(projection));
                projected.map_err(|message| Error::content(path, message))?;
                evidence.add(&step);
            }
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
    /// The vehicles of the last step, by the recording's number.
    last: FxHashMap<u32, RecordedRow>,
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
            self.last.insert(row.user, *row);
            if let Some(last) = before.get(&row.user).filter(|last| last.lane == row.lane) {
                self.compare(row, last, period);
            }
        }
    }

    /// Compares the distance with the speeds. Stops and starts may lie within the period; after driving against its lane or
    /// being moved, a vehicle's distance does not match its speeds.
    fn compare(&mut self, row: &RecordedRow, last: &RecordedRow, period: Second) {
        let Some(driven) = driven(last, row) else { return };
        let change = row.speed - last.speed;
        let beyond = driven - (last.speed + row.speed) / 2.0 * period;
        let at_most = change.abs() / 2.0 * period;
        if change != 0.0 && last.speed > 0.0 && row.speed > 0.0 && beyond.abs() <= 2.0 * at_most + ROUNDED {
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

/// How far a vehicle has driven between two rows; none where they do not tell. A change of lanes adds nothing to it.
fn driven(from: &RecordedRow, to: &RecordedRow) -> Option<Metre> {
    let along = to.position - from.position;
    if !along.is_nan() {
        return Some(along);
    }
    let is_straight = (to.angle - from.angle).abs() <= STRAIGHT;
    is_straight.then(|| Vector::new(to.x - from.x, to.y - from.y).dot(&direction(heading(to))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use closecall::util::units::MetrePerSecond;

    /// A vehicle on a lane that leads to the north-east; with or without its place on that lane.
    fn row(position: Metre, speed: MetrePerSecond, has_position: bool) -> RecordedRow {
        RecordedRow {
            user: 0,
            person: false,
            type_name: 0,
            lane: 0,
            x: position * 0.5_f64.sqrt(),
            y: position * 0.5_f64.sqrt(),
            z: 0.0,
            angle: 45.0,
            speed,
            position: if has_position { position } else { f64::NAN },
            lateral_speed: 0.0,
        }
    }

    /// What a vehicle shows that speeds up and slows down, in a simulation with steps of 0.1 s of which every `kept`-th is
    /// recorded to the centimetre.
    fn share(kept: usize, is_euler: bool, has_position: bool) -> f64 {
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
            let row = row(position, speed, has_position);
            if let Some(last) = last.replace(row) {
                evidence.compare(&row, &last, STEP * kept as f64);
            }
        }
        evidence.share()
    }

    #[test]
    fn the_update_and_the_steps_between_show() {
        for has_position in [true, false] {
            assert_eq!([1, 2, 5, 10].map(|kept| share(kept, true, has_position)), [1.0, 0.5, 0.2, 0.1]);
            assert_eq!([1, 2, 5, 10].map(|kept| share(kept, false, has_position)), [0.0; 4]);
        }
    }

    #[test]
    fn driving_against_a_lane_tells_nothing() {
        let mut evidence = Evidence::default();
        evidence.compare(&row(12.0, 12.0, true), &row(0.0, 10.0, true), 1.0);
        evidence.compare(&row(-12.0, 12.0, true), &row(0.0, 10.0, true), 1.0);
        assert_eq!((evidence.movements, evidence.share()), (1, 1.0));
    }

    #[test]
    fn in_a_bend_only_the_place_on_the_lane_tells() {
        let turned = |row: RecordedRow| RecordedRow { angle: 60.0, ..row };
        let mut evidence = Evidence::default();
        evidence.compare(&turned(row(12.0, 12.0, false)), &row(0.0, 10.0, false), 1.0);
        assert_eq!(evidence.movements, 0);
        evidence.compare(&turned(row(12.0, 12.0, true)), &row(0.0, 10.0, true), 1.0);
        assert_eq!(evidence.movements, 1);
    }

    #[test]
    fn without_a_change_in_speed_eulers_is_assumed() {
        assert_eq!(Evidence::default().share(), 1.0);
    }
}
