//! Side, and whatever else is not in line: swept rectangles.

use super::conflict_point::ConflictPoint;
use super::participant::Participant;
use super::swept_bounds::SweptBounds;
use crate::detection::path::Pose;
use crate::geometry::bisection::{Bisection, Contact};
use crate::geometry::convex::ConvexOutline;
use crate::geometry::rectangle::Rectangle;
use crate::geometry::separating_axes::translation;
use crate::geometry::sweep::{Step, TOLERANCE};
use crate::geometry::{Vector, exact};
use crate::util::units::Metre;

/// How far from each other two may be, after both were swept, where they touch, in m.
const INEXACT: Metre = 2.0 * TOLERANCE;

/// Where a pair meets, and whether `a` is the ego: at the first pose on the ego's path at which its rectangle touches the
/// area that the foe covers now and still needs to stop. The ego is the one with the longer way there, of equal ones the
/// one with the smaller id; none of an obstacle.
pub fn meet(
    halves: &mut Bisection,
    a: &Participant,
    b: &Participant,
    in_line: bool,
    a_is_smaller: &impl Fn() -> bool,
) -> Option<(bool, ConflictPoint)> {
    halves.clear();
    let (of_a, of_b) = (0, numbers(a));
    let mut touch = |numbers, ego: &Participant, foe: &Participant| match one_rectangle(foe) {
        _ if !ego.shape.is_empty() => None,
        Some(covered) if ego.straight => first_slide(ego, &covered),
        _ => first_touch(halves, numbers, ego, foe),
    };
    let (as_a, as_b) = (touch([of_a, of_b], a, b), touch([of_b, of_a], b, a));
    let (a_is_ego, (ego_distance, rectangle)) = match (as_a, as_b) {
        (Some(as_a), Some(as_b)) if as_b.0 > as_a.0 || (as_b.0 == as_a.0 && !a_is_smaller()) => (false, as_b),
        (Some(as_a), _) => (true, as_a),
        (None, as_b) => (false, as_b?),
    };
    let (ego, foe, of_foe) = if a_is_ego { (a, b, of_b) } else { (b, a, of_a) };
    // Poses stand along the path, which the heading may leave by as much as rounding to centimetres.
    let in_front = Rectangle { centre: ego.rectangle.centre + ego.rectangle.axis * ego_distance, ..ego.rectangle };
    let rectangle = if in_line { in_front } else { rectangle };
    let meeting =
        |foe_distance, foe_axis, leads| ConflictPoint { ego_distance, foe_distance, ego: rectangle, foe_axis, leads };
    let meeting = if !foe.shape.is_empty() {
        meeting(0.0, None, false)
    } else if in_line && rectangle.axis.dot(&foe.rectangle.axis) > 0.0 {
        meeting(0.0, Some(foe.rectangle.axis), true)
    } else {
        let (foe_distance, foe_axis) = arrival(halves, of_foe, foe, &rectangle, if in_line { 0.0 } else { INEXACT });
        meeting(foe_distance, Some(foe_axis), false)
    };
    Some((a_is_ego, meeting))
}

/// How many numbers the steps of a mover need: one is that of who stands.
fn numbers(of: &Participant) -> usize {
    of.poses.len() + 1
}

/// The area that a foe covers now and still needs to stop, where that is one rectangle.
fn one_rectangle(foe: &Participant) -> Option<Rectangle> {
    if !foe.straight || !foe.shape.is_empty() {
        return None;
    }
    if foe.stop <= 0.0 {
        return stands(foe).covered();
    }
    match foe.poses {
        [now, next, ..] if next.way >= foe.stop => now.step_to(next, foe.length(), foe.width()).covered(),
        _ => None,
    }
}

/// The way of an ego that drives straight on to such an area, and its rectangle there.
fn first_slide(ego: &Participant, covered: &Rectangle) -> Option<(Metre, Rectangle)> {
    ego.poses.windows(2).find_map(|pair| {
        let step = pair[0].step_to(&pair[1], ego.length(), ego.width());
        let enter = step.slide_to(covered)?.enter;
        Some((pair[0].way + (pair[1].way - pair[0].way) * enter, step.rectangle(enter)))
    })
}

/// The ego's way to the foe's area and its rectangle there; the steps of both may be known already, by their numbers from
/// these on.
fn first_touch(
    halves: &mut Bisection,
    [of_ego, of_foe]: [usize; 2],
    ego: &Participant,
    foe: &Participant,
) -> Option<(Metre, Rectangle)> {
    for (index, pair) in ego.poses.windows(2).enumerate() {
        let cover = ego.covers.get(index);
        if cover.is_some_and(|cover| !cover.meets(foe.cover)) {
            continue;
        }
        let cover = cover.unwrap_or(ego.cover);
        let step = pair[0].step_to(&pair[1], ego.length(), ego.width());
        let mut enter = Contact::Entry.none();
        for shape in foe.shape.iter().filter(|shape| shape.bounds.meet(&cover.bounds)) {
            let part = halves.numbered(of_ego + index, || step);
            enter = halves.meet(part, shape, Contact::Entry).map_or(enter, |found| found.min(enter));
        }
        for (of_other, other) in area(foe, cover) {
            enter = halves.touch_numbered((of_ego + index, &step), (of_foe + of_other, &other), Contact::Entry, enter);
        }
        if enter <= 1.0 {
            return Some((pair[0].way + (pair[1].way - pair[0].way) * enter, step.rectangle(enter)));
        }
    }
    None
}

/// The steps near an ego's over which the foe covers the area that it is in now and still needs to stop, with their
/// numbers; none of an obstacle.
fn area<'a>(foe: &'a Participant, near: &'a SweptBounds) -> impl Iterator<Item = (usize, Step)> + 'a {
    let standing = (foe.shape.is_empty() && foe.stop <= 0.0).then(|| (foe.poses.len(), stands(foe)));
    let before_it_stands = foe.poses.iter().take_while(|pose| pose.way < foe.stop);
    let moving = before_it_stands.zip(steps(foe).enumerate()).map(|(_, step)| step);
    let moving = moving.filter(|(index, _)| foe.covers.get(*index).is_none_or(|cover| cover.meets(near)));
    standing.into_iter().chain(moving)
}

/// The step of who stands.
fn stands(of: &Participant) -> Step {
    let front = of.rectangle.centre + of.rectangle.axis * of.rectangle.half_length;
    let now = Pose { way: 0.0, front, axis: of.rectangle.axis };
    now.step_to(&now, of.length(), of.width())
}

/// The foe's way to the ego's rectangle at the meeting place, and its axis there.
///
/// The two touch there to within rounding and the sweep's tolerances, so the rectangle is taken larger by that.
fn arrival(
    halves: &mut Bisection,
    numbers: usize,
    foe: &Participant,
    ego: &Rectangle,
    inexact: Metre,
) -> (Metre, Vector) {
    let ego = grown(ego, inexact);
    for (index, (pair, step)) in foe.poses.windows(2).zip(steps(foe)).enumerate() {
        if let Some(enter) = halves.meet_rectangle((numbers + index, &step), &ego, Contact::Entry) {
            return (pair[0].way + (pair[1].way - pair[0].way) * enter, step.rectangle(enter).axis);
        }
        if pair[0].way >= foe.stop {
            break;
        }
    }
    (foe.stop.min(foe.reach), foe.poses.last().map_or(foe.rectangle.axis, |pose| pose.axis))
}

/// The way at which a foe on these poses has left the ego's rectangle at the meeting place; `arrival` is its way
/// until it is there.
pub fn departure(halves: &mut Bisection, poses: &[Pose], foe: &Participant, ego: &Rectangle, arrival: Metre) -> Metre {
    halves.clear();
    let ego = grown(ego, INEXACT);
    let mut left = arrival;
    for (index, pair) in poses.windows(2).enumerate() {
        let (pose, next) = (pair[0], pair[1]);
        if next.way < arrival {
            continue;
        }
        let step = pose.step_to(&next, foe.length(), foe.width());
        let Some(leave) = halves.meet_rectangle((index, &step), &ego, Contact::Exit) else {
            if pose.way > arrival {
                return left;
            }
            continue;
        };
        left = pose.way + (next.way - pose.way) * leave.min(1.0);
        if leave < 1.0 {
            return left;
        }
    }
    left
}

fn grown(rectangle: &Rectangle, by: Metre) -> Rectangle {
    Rectangle { half_length: rectangle.half_length + by, half_width: rectangle.half_width + by, ..*rectangle }
}

fn steps<'a>(of: &'a Participant) -> impl Iterator<Item = Step> + 'a {
    of.poses.windows(2).map(|pair| pair[0].step_to(&pair[1], of.length(), of.width()))
}

/// Whether two rectangles-with-shapes overlap or touch now.
pub fn touch_now(a: &Participant, b: &Participant) -> bool {
    if b.shape.is_empty() {
        return !exact::are_far_apart(&a.rectangle, &b.rectangle) && exact::touches(&a.rectangle, &b.rectangle);
    }
    let outline = ConvexOutline::rectangle(&a.rectangle);
    b.shape.iter().any(|part| translation(&outline, &Vector::zeros(), &part.outline).is_some())
}

#[cfg(test)]
mod tests {
    use crate::braking::Brakes;
    use crate::detection::narrow_phase::side::*;
    use crate::detection::path::arc;
    use crate::geometry::Point;
    use proptest::prelude::*;

    const SIZE: (Metre, Metre) = (5.0, 2.0);
    const BRAKES: Brakes = Brakes { response: 1.0, build_up: 0.1, deceleration: 8.0 };

    fn mover<'a>(poses: &'a [Pose], covers: &'a [SweptBounds], cover: &'a SweptBounds) -> Participant<'a> {
        let (length, width) = SIZE;
        let rectangle = Rectangle::behind(poses[0].front, poses[0].axis, length, width);
        let (stop, reach) = (poses[poses.len() - 2].way, poses[poses.len() - 1].way);
        Participant {
            rectangle,
            shape: &[],
            poses,
            straight: false,
            reach,
            cover,
            covers,
            speed: 10.0,
            brakes: &BRAKES,
            stop,
        }
    }

    prop_compose! {
        fn way()(x in -40.0..40.0, y in -40.0..40.0, heading in -3.2..3.2, stop in 1.0..60.0, curvature in -0.1..0.1)
            -> Vec<Pose> {
            let (front, axis) = (Point::new(x, y), crate::geometry::rectangle::direction(heading));
            let mut poses = vec![Pose { way: 0.0, front, axis }];
            arc::poses(front, axis, curvature, SIZE.0, &[stop, stop + 0.5], &mut poses);
            poses
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(5000))]

        #[test]
        fn covers_leave_out_nothing_that_meets(ego in way(), foe in way()) {
            let all = vec![SweptBounds::EVERYWHERE; 1000];
            let whole = |poses: &[Pose]| SweptBounds::of(poses, SIZE.0, SIZE.1).unwrap();
            let parts = |poses: &[Pose]| poses.windows(2).map(whole).collect::<Vec<_>>();
            let (ego_parts, foe_parts) = (parts(&ego), parts(&foe));
            let mut halves = Bisection::default();
            let mut meet = |ego: &Participant, foe: &Participant| meet(&mut halves, ego, foe, false, &|| true);
            let slow = meet(&mover(&ego, &all, &SweptBounds::EVERYWHERE), &mover(&foe, &all, &SweptBounds::EVERYWHERE));
            let (ego_whole, foe_whole) = (whole(&ego), whole(&foe));
            let (ego, foe) = (mover(&ego, &ego_parts, &ego_whole), mover(&foe, &foe_parts, &foe_whole));
            prop_assert!(slow.is_none() || ego.cover.meets(foe.cover));
            prop_assert_eq!(meet(&ego, &foe), slow);
        }
    }
}
