//! Checks the unit of headings: they are compared with how the road users moved.

use strum::VariantArray;

use super::field::HeadingUnit;
use super::spill::Row;
use closecall::geometry::Point;
use closecall::geometry::rectangle::direction;
use closecall::util::units::Metre;

/// A heading is compared with the direction of a stretch of at least this length, in m: noise of some decimetres does not turn it.
const STRETCH: Metre = 2.0;
/// Fewer stretches tell nothing.
const ENOUGH: u64 = 4;
/// A heading fits within 20° of its stretch's direction: cos 20°.
const FITS: f64 = 0.939_69;
/// A heading further off contradicts it: cos 45°.
const CONTRADICTS: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// A unit is right if this share of the stretches fits.
const RIGHT: f64 = 0.9;
/// A unit is doubtful if a smaller share fits.
const DOUBTFUL: f64 = 0.75;
/// This share of contradictions is more than manoeuvres explain.
const TOO_MANY: f64 = 0.3;

/// What the headings of a table show, in each unit that they may have.
pub(super) struct Headings {
    unit: HeadingUnit,
    is_picture: bool,
    /// The road user whose rows come, and where its stretch began.
    begin: Option<(u32, Point)>,
    stretches: u64,
    contradict: u64,
    fit: [u64; HeadingUnit::VARIANTS.len()],
}

impl Headings {
    /// For a table with headings in this unit.
    pub fn new(unit: HeadingUnit, is_picture: bool) -> Self {
        Self { unit, is_picture, begin: None, stretches: 0, contradict: 0, fit: Default::default() }
    }

    /// Takes the next row of a track; one without a heading tells nothing.
    pub fn add(&mut self, row: &Row) {
        let (place, heading) = (Point::new(row.values[0], row.values[1]), row.values[2]);
        let Some((_, begin)) = self.begin.filter(|(user, _)| *user == row.user) else {
            self.begin = Some((row.user, place));
            return;
        };
        let displacement = place - begin;
        if displacement.norm() < STRETCH {
            return;
        }
        self.begin = Some((row.user, place));
        if heading.is_nan() {
            return;
        }
        self.stretches += 1;
        let along = displacement.normalize();
        self.contradict += u64::from(direction(heading).dot(&along) < CONTRADICTS);
        let number = self.unit.number(heading, self.is_picture);
        for (fit, unit) in self.fit.iter_mut().zip(HeadingUnit::VARIANTS) {
            *fit += u64::from(direction(unit.heading(number, self.is_picture)).dot(&along) >= FITS);
        }
    }

    /// The unit that fits if the assumed one does not.
    pub fn better(&self) -> Option<HeadingUnit> {
        let share = |unit: HeadingUnit| self.fit[unit as usize] as f64 / self.stretches as f64;
        let is_doubtful = self.stretches >= ENOUGH && share(self.unit) < DOUBTFUL;
        let best = HeadingUnit::VARIANTS.iter().copied().rev().max_by(|a, b| share(*a).total_cmp(&share(*b)))?;
        Some(best).filter(|best| is_doubtful && share(*best) >= RIGHT)
    }

    /// What contradicts the movement, as a line; `column` is that of the headings.
    pub fn remark(&self, column: &str) -> Option<String> {
        let (all, against) = (self.stretches, self.contradict);
        if let Some(unit) = self.better() {
            let fit = self.fit[self.unit as usize];
            let name = unit.name();
            return Some(format!(
                "headings: only {fit} of {all} fit the movement over 2 m; {column} may be in another unit: heading={column}[{name}]"
            ));
        }
        let are_many = all >= ENOUGH && against as f64 > TOO_MANY * all as f64;
        are_many.then(|| {
            format!("headings: {against} of {all} contradict the movement over 2 m, by more than 45° (column {column})")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What headings of road users show that drive in these directions, in degrees.
    fn seen(unit: HeadingUnit, drives_and_heads: &[(f64, f64)]) -> Headings {
        let mut headings = Headings::new(unit, false);
        for (user, (drives, heads)) in (0..).zip(drives_and_heads) {
            for step in 0..10 {
                let place = direction(drives.to_radians()) * (1.1 * f64::from(step));
                let values = [place.x, place.y, unit.heading(*heads, false), 1.0, 0.0, 0.0];
                headings.add(&Row { user, class: 0, time: step.into(), values });
            }
        }
        headings
    }

    #[test]
    fn degrees_and_compass_degrees_taken_for_radians_are_noticed() {
        let all = [0.0, 90.0, 200.0, 300.0];
        for (heads, unit) in [(all, HeadingUnit::Degree), (all.map(|it| 90.0 - it), HeadingUnit::North)] {
            let cases = all.into_iter().zip(heads).collect::<Vec<_>>();
            let headings = seen(HeadingUnit::Radian, &cases);
            assert_eq!(headings.better(), Some(unit));
            assert!(headings.remark("yaw").is_some_and(|it| it.contains(&format!("heading=yaw[{}]", unit.name()))));
            assert_eq!(seen(unit, &cases).remark("yaw"), None);
        }
    }

    #[test]
    fn headings_against_the_movement_are_noticed_but_one_that_reverses_is_not() {
        let directions = [10.0, 100.0, 190.0, 280.0];
        let against = directions.map(|direction| (direction, direction + 180.0));
        let remark = seen(HeadingUnit::Degree, &against).remark("yaw").unwrap();
        assert!(remark.contains("16 of 16 contradict the movement"), "{remark}");
        let one = [(10.0, 190.0), (100.0, 100.0), (190.0, 190.0), (280.0, 280.0)];
        assert_eq!(seen(HeadingUnit::Degree, &one).remark("yaw"), None);
    }
}
