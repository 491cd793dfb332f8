//! Post-encroachment time: how long after the first has left the conflict area the second enters it.
//!
//! Measured on the paths that both really drove. A corridor is the area that a rectangle covered; the conflict area is
//! the place of both corridors in which the second crosses the first's (`passage`): from where it comes into it
//! until it is clear of it, or until the two go on together. The second enters the area when it comes into the first's
//! corridor; the first leaves it when its rectangle touches what the second covers there for the last time. So the time is
//! final when the second has crossed, whatever both do afterwards. An articulated vehicle has a corridor of each carriage.
//!
//! A follower has none, whatever the bends that both drive through, nor do two that leave one lane in different directions.

use super::corridor::Corridor;
use super::driven_path::{DrivenPath, bounds};
use super::passage::{Passage, Track, crossing};
use crate::geometry::bisection::Bisection;
use crate::util::units::{Radian, Second};

/// A post-encroachment time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pet {
    /// From when the first has left the conflict area until the second enters it, in s.
    pub lasts: Second,
    /// When the second enters it, in s.
    pub enters: Second,
    /// Whether the second has crossed the first's corridor, so that no further step changes this.
    pub is_final: bool,
}

/// The PET of two driven paths; paths that meet at a smaller angle than `widest` cross only where each goes on beyond the
/// other. None where they do not cross, or both are in the conflict area at once. `halves` only lends its allocations.
pub(crate) fn post_encroachment_time(
    halves: &mut Bisection,
    a: &DrivenPath,
    b: &DrivenPath,
    widest: Radian,
) -> Option<Pet> {
    let courses = [a, b].map(DrivenPath::courses);
    let near = bounds(&courses[0]).shared_with(&bounds(&courses[1]))?;
    halves.clear();
    let corridors = [0, 1].map(|of| Corridor::of(&courses[of], &near, halves));
    let pets = [[0, 1], [1, 0]].into_iter().filter_map(|[first, second]| {
        let (course, width) = (courses[first].first()?, courses[second].first()?.width);
        let track = Track::of(course, [a, b][first].length(), width, widest);
        let carriages = &corridors[second].carriages;
        let passages = carriages.iter().filter_map(|steps| crossing(steps, &corridors[first], &track, halves));
        let Passage { enters, leaves, is_final } = passages.reduce(Passage::joined)?;
        let lasts = enters - leaves;
        // It still is in the conflict area where its record ends.
        let has_left = track.ends() > leaves;
        let is_final = is_final || [a, b][second].has_ended();
        (has_left && lasts >= 0.0 && lasts.is_finite()).then_some(Pet { lasts, enters, is_final })
    });
    pets.min_by(|a, b| a.enters.total_cmp(&b.enters))
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
            let distance = 8.0 * (time - 1.0);
            let angle = (distance / 9.0).clamp(0.0, std::f64::consts::FRAC_PI_2);
            let beyond = Point::new(
                9.0 * angle.cos() - distance.max(9.0 * angle) + 9.0 * angle,
                9.0 * angle.sin() + distance.min(0.0),
            );
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

    /// What one has driven between two times, `later` seconds later.
    fn part(of: &DrivenPath, [begin, end]: [f64; 2], later: f64) -> DrivenPath {
        let mut part = DrivenPath::new(4.0, 2.0);
        for pose in &of.courses()[0].poses[..] {
            if (begin..=end).contains(&pose.time) {
                part.push(pose.time + later, pose.front, pose.heading);
            }
        }
        part
    }

    #[test]
    fn a_follower_through_a_bend_has_no_pet() {
        let turn = turn(0.1);
        // The record of the first begins anywhere before, in and behind the bend.
        for begin in (0..30).map(|step| f64::from(step) * 0.1) {
            for later in [0.7, 2.0, 5.9] {
                assert_eq!(pet_of(&part(&turn, [begin, 9.0], 0.0), &part(&turn, [0.0, 9.0], later)), None, "{begin}");
            }
        }
    }

    #[test]
    fn the_pet_of_a_merge_is_the_same_however_far_both_go_on() {
        // It goes on to the west, into which the first turns, and is faster than it in the end.
        let mut second = DrivenPath::new(4.0, 2.0);
        (0..=90).map(|step| f64::from(step) * 0.1).for_each(|time| {
            second.push(time, Point::new(-10.0 * (time - 5.0), 9.0), std::f64::consts::PI);
        });
        let first = turn(0.1);
        let until = |end: f64| pet_of(&part(&first, [0.0, end], 0.0), &part(&second, [0.0, end], 0.0));
        let all = until(9.0).unwrap();
        assert!(all.is_final && 1.0 < all.lasts && all.lasts < 3.0, "{all:?}");
        let found = (40..90).filter_map(|step| until(f64::from(step) * 0.1)).collect::<Vec<_>>();
        let final_ones = found.iter().filter(|pet| pet.is_final).collect::<Vec<_>>();
        assert!(final_ones.len() > 30 && final_ones.iter().all(|pet| **pet == all), "{found:?}");
    }

    #[test]
    fn a_crossing_at_a_small_angle_has_a_pet() {
        let at = |degrees: f64| pet_of(&course(0.0, 2.0), &course(degrees.to_radians(), 5.0));
        for degrees in [15.0, 29.0, 31.0_f64] {
            // Both corridors are 2 m wide; a corner of each enters and leaves the parallelogram that they share.
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let area = (1.0 + cosine) / sine;
            let Pet { lasts, is_final, .. } = at(degrees).unwrap();
            assert!((lasts - (3.0 - 0.4 - 2.0 * area / 10.0)).abs() < 0.01 && is_final, "{degrees}: {lasts}");
        }
    }

    #[test]
    fn one_that_changes_lanes_behind_another_has_no_pet() {
        let mut changes = DrivenPath::new(4.0, 2.0);
        (0..=100).map(|step| f64::from(step) * 0.1).for_each(|time| {
            let (x, aside) = (10.0 * (time - 4.0), (time - 4.0).clamp(0.0, 3.0) - 3.0);
            let drifts = (4.0..7.0).contains(&time);
            changes.push(time, Point::new(x, aside), if drifts { 0.1 } else { 0.0 });
        });
        assert_eq!(pet_of(&course(0.0, 2.0), &changes), None);
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
