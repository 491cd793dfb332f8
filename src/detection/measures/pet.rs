//! Post-encroachment time: how long after the first has left the conflict area the second enters it.
//!
//! Measured on the paths that both really drove. A corridor is the area that a rectangle covered; the conflict area is
//! where the two corridors overlap. The first leaves it when its rectangle touches the other's corridor for the last
//! time. The second enters it when its rectangle touches the first's corridor for the first time. While the second is in
//! that corridor, its own may still overlap a later part of it, so the time is final when the second has left. An
//! articulated vehicle has a corridor of each carriage.
//!
//! Only of two whose paths cross: where the second enters, its heading has to differ from that of the first when that was
//! there. One that follows the other, out of the same lane too, has none.

use smallvec::SmallVec;

use super::driven_path::{Course, DrivenPath, bounds};
use crate::geometry::bisection::{Bisection, Part};
use crate::geometry::movement::TOLERANCE;
use crate::geometry::separating_axes::Contact;
use crate::geometry::{Bounds, Vector, angle_between};
use crate::options::condition::LONGEST_PET;
use crate::util::units::{Radian, Second};

/// How long after a conflict closed its PET is waited for, in s.
pub const WAIT: Second = LONGEST_PET;

/// The area that one road user covered, as far as the other may have been there.
struct Corridor {
    /// Of each carriage, in the order of time.
    carriages: SmallVec<[Vec<Step>; 1]>,
    /// When it ends.
    end: Second,
}

/// The area covered between two times.
struct Step {
    from: Second,
    to: Second,
    /// The directions at its begin and end.
    axes: [Vector; 2],
    part: Part,
}

impl Step {
    fn time(&self, part: f64) -> Second {
        self.from + (self.to - self.from) * part
    }

    fn axis(&self, part: f64) -> Vector {
        self.axes[0] * (1.0 - part) + self.axes[1] * part
    }
}

/// Where one enters the other's corridor.
struct Entry {
    time: Second,
    /// Between its heading there and that of the other when it was there.
    angle: Radian,
}

impl Corridor {
    fn of(courses: &[Course], near: &Bounds, halves: &mut Bisection) -> Self {
        let end = courses.first().and_then(|course| course.poses.last()).map_or(0.0, |pose| pose.time);
        Self { carriages: courses.iter().map(|course| steps(course, near, halves)).collect(), end }
    }

    /// The first time at which it touches the other's corridor. The steps after it, which cost most, are not tested.
    fn enters(&self, other: &Self, halves: &mut Bisection) -> Option<Entry> {
        let entries = self.carriages.iter().filter_map(|steps| {
            steps.iter().find_map(|step| {
                let (enters, met) = other.touch(step.part, Contact::Entry, halves)?;
                Some(Entry { time: step.time(enters), angle: angle_between(&step.axis(enters), &met.axis(0.5)) })
            })
        });
        entries.min_by(|a, b| a.time.total_cmp(&b.time))
    }

    /// The last time; none where it still touches it at the end.
    fn leaves(&self, other: &Self, halves: &mut Bisection) -> Option<Second> {
        let exits = self.carriages.iter().filter_map(|steps| {
            let (step, leaves) = steps.iter().rev().find_map(|step| {
                let (leaves, _) = other.touch(step.part, Contact::Exit, halves)?;
                Some((step, leaves.min(1.0)))
            })?;
            let still = step.to == self.end && leaves >= 1.0;
            Some(if still { f64::INFINITY } else { step.time(leaves) })
        });
        exits.reduce(f64::max).filter(|time| time.is_finite())
    }

    /// The fraction of a step of the other at which it touches this corridor, and the step of this one that it touches.
    fn touch(&self, part: Part, which: Contact, halves: &mut Bisection) -> Option<(f64, &Step)> {
        let mut found = (which.none(), None);
        for step in self.carriages.iter().flatten() {
            let touch = halves.touch(part, step.part, which, found.0);
            if touch != found.0 {
                found = (touch, Some(step));
            }
        }
        Some((found.0, found.1?))
    }
}

/// The steps that may touch what lies within these bounds.
fn steps(course: &Course, near: &Bounds, halves: &mut Bisection) -> Vec<Step> {
    let steps = course.poses.windows(2).filter_map(|pair| {
        let [start, end] = [&pair[0], &pair[1]].map(|pose| course.pose(pose));
        let mut bounds = course.bounds_at(&start);
        bounds.join(&course.bounds_at(&end));
        if !bounds.grown(TOLERANCE).meet(near) {
            return None;
        }
        let part = halves.add(start.movement_to(&end, course.length, course.width));
        Some(Step { from: pair[0].time, to: pair[1].time, axes: [start.axis, end.axis], part })
    });
    steps.collect()
}

/// A post-encroachment time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pet {
    /// From when the first has left the conflict area until the second enters it, in s.
    pub lasts: Second,
    /// When the second enters it, in s.
    pub enters: Second,
    /// Whether the second has left the first's corridor, so that no further step changes this.
    pub is_final: bool,
}

/// The PET of two driven paths that cross at an angle of at least `crossing`. None where the corridors do not overlap, or
/// both are in the conflict area at once, as where one merges behind the other. `halves` only lends its allocations.
pub fn post_encroachment_time(halves: &mut Bisection, a: &DrivenPath, b: &DrivenPath, crossing: Radian) -> Option<Pet> {
    let courses = [a, b].map(DrivenPath::courses);
    let near = bounds(&courses[0]).shared_with(&bounds(&courses[1]))?;
    halves.clear();
    let [a, b] = courses.map(|courses| Corridor::of(&courses, &near, halves));
    let (a_enters, b_enters) = (a.enters(&b, halves)?, b.enters(&a, halves)?);
    if a_enters.time == b_enters.time {
        return None;
    }
    let (first, second, enters) = if a_enters.time < b_enters.time { (a, b, b_enters) } else { (b, a, a_enters) };
    if enters.angle < crossing {
        return None;
    }
    let lasts = enters.time - first.leaves(&second, halves)?;
    (lasts >= 0.0).then(|| Pet { lasts, enters: enters.time, is_final: second.leaves(&first, halves).is_some() })
}

#[cfg(test)]
mod tests {
    use crate::detection::measures::pet::*;
    use crate::geometry::Point;
    use crate::geometry::rectangle::direction;
    use crate::traffic::profile::Carriage;

    /// The bound below which a conflict is rear-end.
    const CROSSING: Radian = std::f64::consts::FRAC_PI_6;

    fn pet_of(a: &DrivenPath, b: &DrivenPath) -> Option<Pet> {
        post_encroachment_time(&mut Bisection::default(), a, b, CROSSING)
    }

    /// A car of 4 m by 2 m that drives with 10 m/s through the origin; its front is there at `arrives`.
    fn course(heading: f64, arrives: f64) -> DrivenPath {
        let axis = direction(heading);
        let mut course = DrivenPath::new(4.0, 2.0);
        for step in 0..=20 {
            let time = f64::from(step) * 0.5;
            let front = Point::origin() + axis * ((time - arrives) * 10.0);
            course.push(time, front, heading);
        }
        course
    }

    #[test]
    fn one_that_crosses_behind_another_leaves_the_time_between() {
        // The first's rear leaves the other's corridor (1 m beyond the origin) at 2 + 0.5 s, the second's front
        // enters the first's (1 m before the origin) at 5 − 0.1 s.
        let Pet { lasts, enters, is_final } =
            pet_of(&course(0.0, 2.0), &course(std::f64::consts::FRAC_PI_2, 5.0)).unwrap();
        assert!((lasts - 2.4).abs() < 1e-9 && (enters - 4.9).abs() < 1e-9 && is_final, "{lasts} at {enters}");
    }

    /// A car that turns left from the south to the west on a radius of 9 m, with 8 m/s, in steps of this length.
    fn turn(step: f64) -> DrivenPath {
        turn_of(DrivenPath::new(4.0, 2.0), step)
    }

    /// The same of any road user.
    fn turn_of(mut course: DrivenPath, step: f64) -> DrivenPath {
        let steps = (4.0 / step).round() as u32;
        for time in (0..=steps).map(|number| f64::from(number) * step) {
            let way = 8.0 * (time - 1.0);
            let angle = (way / 9.0).clamp(0.0, std::f64::consts::FRAC_PI_2);
            let beyond =
                Point::new(9.0 * angle.cos() - way.max(9.0 * angle) + 9.0 * angle, 9.0 * angle.sin() + way.min(0.0));
            course.push(time, beyond, angle + std::f64::consts::FRAC_PI_2);
        }
        course
    }

    #[test]
    fn long_steps_through_a_turn_hardly_widen_the_corridor() {
        let crossing = |step: f64| {
            let mut course = DrivenPath::new(4.0, 2.0);
            let steps = (8.0 / step).round() as u32;
            for time in (0..=steps).map(|number| f64::from(number) * step) {
                course.push(time, Point::new(10.0 * (time - 5.0), 5.0), 0.0);
            }
            pet_of(&turn(step), &course).unwrap()
        };
        let (long, short) = (crossing(0.2), crossing(0.01));
        assert!((long.lasts - short.lasts).abs() < 0.02, "{long:?} {short:?}");
    }

    #[test]
    fn the_trailer_of_a_truck_that_turns_leaves_last() {
        let [truck, trailer] = [(0.0, 4.0), (4.0, 8.0)].map(|(behind, length)| Carriage { behind, length });
        let turning = turn_of(DrivenPath::of_carriages([truck, trailer], 2.0), 0.1);
        let mut behind = DrivenPath::new(4.0, 2.0);
        (0..=80).map(|step| f64::from(step) * 0.1).for_each(|time| {
            behind.push(time, Point::new(8.0 + 10.0 * (time - 5.0), -9.0), 0.0);
        });
        // The front is 4 m into the turn when the tail, 12 m behind it, leaves the corridor 1 m beside y = −9 m.
        let Pet { lasts, enters, .. } = pet_of(&turning, &behind).unwrap();
        assert!((enters - 5.0).abs() < 1e-3 && (lasts - (5.0 - 1.5)).abs() < 1e-3, "{lasts} at {enters}");
        let rigid = pet_of(&turn_of(DrivenPath::new(12.0, 2.0), 0.1), &behind).unwrap();
        assert!(rigid.lasts > lasts + 0.05, "{rigid:?}");
    }

    #[test]
    fn it_is_known_when_the_second_has_left() {
        let first = turn(0.1);
        // It crosses the exit of the turn at an angle.
        let axis = direction(2.6);
        let second = |until: f64| {
            let mut course = DrivenPath::new(4.0, 2.0);
            for time in (0..=80).map(|number| f64::from(number) * 0.1).take_while(|time| *time < until) {
                course.push(time, Point::new(1.0, 9.0) + axis * (10.0 * (time - 5.0)), 2.6);
            }
            // The second crosses the exit at a small angle.
            post_encroachment_time(&mut Bisection::default(), &first, &course, 0.0)
        };
        let all = second(8.1).unwrap();
        let found = (1..=80).filter_map(|step| second(f64::from(step) * 0.1)).collect::<Vec<_>>();
        let [early, final_ones] = [false, true].map(|is| found.iter().filter(move |pet| pet.is_final == is));
        assert!(early.clone().count() > 3 && early.clone().any(|pet| pet.lasts > all.lasts + 0.1));
        assert!(final_ones.clone().count() > 3 && final_ones.clone().all(|pet| *pet == all));
    }

    #[test]
    fn a_follower_on_the_same_path_has_no_pet() {
        assert_eq!(pet_of(&course(0.0, 2.0), &course(0.0, 4.0)), None);
    }

    #[test]
    fn two_that_leave_one_lane_for_different_ones_have_no_pet() {
        // The first turns left; the second comes out of the same lane 4 s later and drives straight on.
        let mut straight = DrivenPath::new(4.0, 2.0);
        (0..=90).map(|step| f64::from(step) * 0.1).for_each(|time| {
            straight.push(time, Point::new(9.0, 8.0 * (time - 5.0)), std::f64::consts::FRAC_PI_2);
        });
        assert_eq!(pet_of(&turn(0.1), &straight), None);
        let from_left = |until: f64| {
            let mut course = DrivenPath::new(4.0, 2.0);
            (0..=90).map(|step| f64::from(step) * 0.1).take_while(|time| *time < until).for_each(|time| {
                course.push(time, Point::new(8.0 * (time - 5.0), 2.0), 0.0);
            });
            course
        };
        assert!(pet_of(&turn(0.1), &from_left(9.1)).is_some(), "one that crosses the turn has");
    }
}
