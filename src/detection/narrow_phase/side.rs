//! Side conflicts, and all others that are not in line: swept rectangles.

use std::slice::from_ref;

use super::approach::{ALIKE, Approach, Ego};
use super::conflict_point::ConflictPoint;
use super::participant::Participant;
use super::swept_bounds::SweptBounds;
use crate::detection::path::Pose;
use crate::geometry::bisection::Bisection;
use crate::geometry::convex::ConvexOutline;
use crate::geometry::movement::{FINE, Movement, TOLERANCE};
use crate::geometry::rectangle::Rectangle;
use crate::geometry::separating_axes::{Contact, translation};
use crate::geometry::{Vector, contact, exact, polygon};
use crate::util::units::Metre;

/// How far apart two rectangles may be where a coarse sweep of both finds contact, in m.
const INEXACT: Metre = 2.0 * TOLERANCE;

/// How a pair meets, each as its carriages, of which most have one: at the first pose on the ego's path at which its
/// rectangle touches the area that the foe covers now and still needs to stop. The ego is the one with the longer distance
/// there; if equal, the one that moves faster towards the other. An obstacle is never the ego.
///
/// Swept to [`TOLERANCE`], which covers a little too much: what does not meet does not meet, and no gap is too
/// large.
pub fn meet(bisection: &mut Bisection, a: &[Participant], b: &[Participant]) -> Option<Approach> {
    bisection.clear();
    find(bisection, a, b)
}

/// The same for a pair that [`meet`] has just found to meet, swept to `tolerance`.
pub fn refine(bisection: &mut Bisection, tolerance: Metre, a: &[Participant], b: &[Participant]) -> Option<Approach> {
    bisection.sweep_to(tolerance);
    find(bisection, a, b)
}

/// How far an ego goes until it touches a foe, each of whose carriages stands where it is now, and its axis there.
pub fn distance_to(bisection: &mut Bisection, ego: &Participant, foe: &[Participant]) -> Option<(Metre, Vector)> {
    bisection.clear();
    let touch = touch(bisection, [0, movement_count(ego)], from_ref(ego), foe)?;
    Some((touch.ego_distance, touch.ego_rectangle.axis))
}

/// How a pair meets, swept to the bisection's tolerance.
fn find(bisection: &mut Bisection, a: &[Participant], b: &[Participant]) -> Option<Approach> {
    // The movements of all are numbered one after the other.
    let [of_a, of_b] = [0, a.iter().map(movement_count).sum()];
    let a_touches = touch(bisection, [of_a, of_b], a, b);
    let b_touches = touch(bisection, [of_b, of_a], b, a);
    let (roles, Touch { ego_distance, ego_rectangle, ego_behind }) = match (a_touches, b_touches) {
        (Some(of_a), Some(of_b)) => {
            let roles = if (of_a.ego_distance - of_b.ego_distance).abs() <= ALIKE {
                Ego::of_equals([a.first()?, b.first()?])
            } else {
                Ego::first_if(of_a.ego_distance > of_b.ego_distance)
            };
            let [ego, _] = roles.then_foe([of_a, of_b]);
            (roles, ego)
        }
        (Some(a), None) => (Ego::First, a),
        (None, b) => (Ego::Second, b?),
    };
    let [_, foe] = roles.then_foe([a, b]);
    let [_, of_foe] = roles.then_foe([of_a, of_b]);
    let (foe_distance, foe_axis) = arrival(bisection, of_foe, foe, &ego_rectangle)?;
    let conflict_point =
        ConflictPoint { ego_distance, foe_distance, ego_rectangle, ego_behind, foe_axis, foe_leads: false };
    Some(Approach { ego: roles, conflict_point })
}

/// The carriages, each with the number of its first movement, where those of the first are numbered from `begin` on.
fn numbered<'a, 'b>(
    carriages: &'b [Participant<'a>],
    begin: usize,
) -> impl Iterator<Item = (usize, &'b Participant<'a>)> {
    carriages.iter().scan(begin, |next, carriage| {
        let number = *next;
        *next += movement_count(carriage);
        Some((number, carriage))
    })
}

/// Where the first of an ego's carriages touches the area of one of a foe's.
fn touch(
    bisection: &mut Bisection,
    [of_ego, of_foe]: [usize; 2],
    ego: &[Participant],
    foe: &[Participant],
) -> Option<Touch> {
    let mut first: Option<Touch> = None;
    for (of_ego, ego) in numbered(ego, of_ego).filter(|(_, ego)| ego.shape.is_empty()) {
        for (of_foe, foe) in numbered(foe, of_foe) {
            let found = match one_rectangle(foe) {
                Some(covered) if ego.straight => first_slide(ego, &covered),
                _ => first_touch(bisection, [of_ego, of_foe], ego, foe),
            };
            let is_first = |found: &Touch| first.as_ref().is_none_or(|first| found.ego_distance < first.ego_distance);
            first = found.filter(is_first).or(first);
        }
    }
    first
}

/// Where an ego first touches the area of a foe.
struct Touch {
    ego_distance: Metre,
    /// The rectangle of its carriage there, and how far that is behind the front bumper.
    ego_rectangle: Rectangle,
    ego_behind: Metre,
}

/// How many numbers the movements of a road user take; the last one stands for a road user that does not move.
fn movement_count(of: &Participant) -> usize {
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
        [now, next, ..] if next.distance >= foe.stop => foe.movement(now, next).covered(),
        _ => None,
    }
}

/// Where an ego that drives straight on first touches such a rectangle.
fn first_slide(ego: &Participant, covered: &Rectangle) -> Option<Touch> {
    ego.poses.windows(2).find_map(|pair| {
        let movement = ego.movement(&pair[0], &pair[1]);
        let enter = movement.slide_to(covered)?.enter;
        let ego_distance = pair[0].distance + (pair[1].distance - pair[0].distance) * enter;
        Some(Touch { ego_distance, ego_rectangle: movement.rectangle(enter), ego_behind: ego.carriage.behind })
    })
}

/// Where an ego first touches the area of a foe. The movements of the two are numbered from `of_ego` and `of_foe` on.
fn first_touch(
    bisection: &mut Bisection,
    [of_ego, of_foe]: [usize; 2],
    ego: &Participant,
    foe: &Participant,
) -> Option<Touch> {
    for (index, pair) in ego.poses.windows(2).enumerate() {
        let cover = ego.covers.get(index);
        if cover.is_some_and(|cover| !cover.meets(foe.cover)) {
            continue;
        }
        let cover = cover.unwrap_or(ego.cover);
        let movement = ego.movement(&pair[0], &pair[1]);
        let mut enter = Contact::Entry.none();
        for shape in foe.shape.iter().filter(|shape| shape.bounds.meet(&cover.bounds)) {
            let part = bisection.numbered(of_ego + index, || movement);
            enter = bisection.meet(part, shape, Contact::Entry).map_or(enter, |found| found.min(enter));
        }
        for (other_index, other) in area(foe, cover) {
            let ego_movement = (of_ego + index, &movement);
            let foe_movement = (of_foe + other_index, &other);
            enter = bisection.touch_numbered(ego_movement, foe_movement, Contact::Entry, enter);
        }
        if enter <= 1.0 {
            let ego_distance = pair[0].distance + (pair[1].distance - pair[0].distance) * enter;
            let ego_behind = ego.carriage.behind;
            return Some(Touch { ego_distance, ego_rectangle: movement.rectangle(enter), ego_behind });
        }
    }
    None
}

/// The numbered movements near `near` over which the foe covers the area that it needs to stop; none for an obstacle.
fn area<'a>(foe: &'a Participant, near: &'a SweptBounds) -> impl Iterator<Item = (usize, Movement)> + 'a {
    let standing = (foe.shape.is_empty() && foe.stop <= 0.0).then(|| (foe.poses.len(), stands(foe)));
    let before_it_stands = foe.poses.iter().take_while(|pose| pose.distance < foe.stop);
    let moving = before_it_stands.zip(movements(foe).enumerate()).map(|(_, movement)| movement);
    let moving = moving.filter(|(index, _)| foe.covers.get(*index).is_none_or(|cover| cover.meets(near)));
    standing.into_iter().chain(moving)
}

/// The movement of a road user that stands.
fn stands(of: &Participant) -> Movement {
    let front = of.rectangle.centre + of.rectangle.axis * of.rectangle.half_length;
    let now = Pose { distance: 0.0, front, axis: of.rectangle.axis };
    now.movement_to(&now, of.length(), of.width())
}

/// The foe's distance to the ego's rectangle at the conflict point, and its axis there, none for an obstacle.
fn arrival(
    bisection: &mut Bisection,
    first_number: usize,
    foe: &[Participant],
    ego: &Rectangle,
) -> Option<(Metre, Option<Vector>)> {
    let [whole, ..] = foe else { return None };
    if !whole.shape.is_empty() {
        return Some((0.0, None));
    }
    let arrivals = numbered(foe, first_number).filter_map(|(number, carriage)| {
        first_contact(bisection, number, carriage, carriage.poses, carriage.stop, ego)
    });
    let first = arrivals.reduce(|first, next| if next.0 < first.0 { next } else { first });
    let (distance, axis) = first.unwrap_or_else(|| {
        // It stands, or rounding keeps the two apart.
        let touches = foe.iter().min_by(|a, b| {
            let [a, b] = [a, b].map(|carriage| contact::distance(&at_the_end(carriage), ego));
            a.total_cmp(&b)
        });
        (whole.stop.min(whole.reach), at_the_end(touches.unwrap_or(whole)).axis)
    });
    Some((distance, Some(axis)))
}

/// The rectangle at the last pose.
fn at_the_end(of: &Participant) -> Rectangle {
    of.poses.last().map_or(of.rectangle, |pose| of.movement(pose, pose).rectangle(0.0))
}

/// The distance along poses, up to the first beyond `furthest`, at which a foe reaches the ego's rectangle at the conflict
/// point, and its axis there.
///
/// The two touch there only up to rounding and the sweep's tolerances, so the rectangle is enlarged by those of a fine sweep;
/// where a foe turns so fast that it is further off, by those of a coarse one.
fn first_contact(
    bisection: &mut Bisection,
    first_number: usize,
    foe: &Participant,
    poses: &[Pose],
    furthest: Metre,
    ego: &Rectangle,
) -> Option<(Metre, Vector)> {
    enlarged(ego, bisection).find_map(|ego| {
        for (index, pair) in poses.windows(2).enumerate() {
            let movement = foe.movement(&pair[0], &pair[1]);
            if let Some(enter) = bisection.meet_rectangle((first_number + index, &movement), &ego, Contact::Entry) {
                let foe_distance = pair[0].distance + (pair[1].distance - pair[0].distance) * enter;
                return Some((foe_distance, movement.rectangle(enter).axis));
            }
            if pair[0].distance >= furthest {
                break;
            }
        }
        None
    })
}

/// The ego's rectangle, larger by what the sweep leaves open; after a fine sweep also by what a coarse one does.
fn enlarged(ego: &Rectangle, bisection: &Bisection) -> impl Iterator<Item = Rectangle> + use<> {
    let (ego, inexact) = (*ego, bisection.inexact());
    let coarse = (inexact < INEXACT).then_some(INEXACT);
    std::iter::once(inexact).chain(coarse).map(move |by| grown(&ego, by))
}

/// The distance at which a carriage on these poses has left the ego's rectangle at the conflict point, if it ever comes
/// there.
pub(crate) fn carriage_departure(
    bisection: &mut Bisection,
    poses: &[Pose],
    carriage: &Participant,
    ego: &Rectangle,
) -> Option<Metre> {
    bisection.clear();
    bisection.sweep_to(FINE);
    let (arrival, _) = first_contact(bisection, 0, carriage, poses, f64::INFINITY, ego)?;
    Some(departure(bisection, poses, carriage, ego, arrival))
}

/// The distance at which a foe on these poses has left the ego's rectangle at the conflict point; `arrival` is the
/// distance at which it reaches that rectangle.
pub fn departure(
    bisection: &mut Bisection,
    poses: &[Pose],
    foe: &Participant,
    ego: &Rectangle,
    arrival: Metre,
) -> Metre {
    bisection.clear();
    bisection.sweep_to(FINE);
    let left = enlarged(ego, bisection).find_map(|ego| last_contact(bisection, poses, foe, &ego, arrival));
    left.unwrap_or(arrival)
}

/// The distance at which the contact ends that a foe has from a distance on; none where it has none.
fn last_contact(
    bisection: &mut Bisection,
    poses: &[Pose],
    foe: &Participant,
    ego: &Rectangle,
    arrival: Metre,
) -> Option<Metre> {
    let mut left = None;
    for (index, pair) in poses.windows(2).enumerate() {
        let pose = pair[0];
        let next = pair[1];
        if next.distance < arrival {
            continue;
        }
        let movement = foe.movement(&pose, &next);
        let Some(leave) = bisection.meet_rectangle((index, &movement), ego, Contact::Exit) else {
            if pose.distance > arrival {
                return left;
            }
            continue;
        };
        left = Some(pose.distance + (next.distance - pose.distance) * leave.min(1.0));
        if leave < 1.0 {
            return left;
        }
    }
    left
}

fn grown(rectangle: &Rectangle, by: Metre) -> Rectangle {
    Rectangle { half_length: rectangle.half_length + by, half_width: rectangle.half_width + by, ..*rectangle }
}

fn movements<'a>(of: &'a Participant) -> impl Iterator<Item = Movement> + 'a {
    of.poses.windows(2).map(|pair| of.movement(&pair[0], &pair[1]))
}

/// How deep two road users, the second of which may be an obstacle, overlap now.
pub fn overlap_now(a: &Participant, b: &Participant) -> Metre {
    if b.shape.is_empty() {
        contact::overlap(&a.rectangle, &b.rectangle)
    } else {
        polygon::overlap(b.shape, &a.rectangle)
    }
}

/// Whether two road users, the second of which may be an obstacle, touch or overlap now.
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
    use crate::traffic::profile::Carriage;
    use proptest::prelude::*;

    const SIZE: (Metre, Metre) = (5.0, 2.0);
    const BRAKES: Brakes = Brakes { response: 1.0, build_up: 0.1, deceleration: 8.0 };

    fn participant<'a>(poses: &'a [Pose], covers: &'a [SweptBounds], cover: &'a SweptBounds) -> Participant<'a> {
        let (length, width) = SIZE;
        let rectangle = Rectangle::behind(poses[0].front, poses[0].axis, length, width);
        let (stop, reach) = (poses[poses.len() - 2].distance, poses[poses.len() - 1].distance);
        Participant {
            rectangle,
            carriage: Carriage { behind: 0.0, length },
            setback: 0.0,
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
        fn path()(x in -40.0..40.0, y in -40.0..40.0, heading in -3.2..3.2, stop in 1.0..60.0, curvature in -0.1..0.1)
            -> Vec<Pose> {
            let (front, axis) = (Point::new(x, y), crate::geometry::rectangle::direction(heading));
            let mut poses = vec![Pose { distance: 0.0, front, axis }];
            arc::poses(front, axis, curvature, SIZE.0, &[stop, stop + 0.5], &mut poses);
            poses
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn covers_leave_out_nothing_that_meets(ego in path(), foe in path()) {
            let all = vec![SweptBounds::EVERYWHERE; 1000];
            let whole = |poses: &[Pose]| SweptBounds::of(poses, SIZE.0, SIZE.1).unwrap();
            let parts = |poses: &[Pose]| poses.windows(2).map(whole).collect::<Vec<_>>();
            let (ego_parts, foe_parts) = (parts(&ego), parts(&foe));
            let mut bisection = Bisection::default();
            let mut meet = |ego: &Participant, foe: &Participant| meet(&mut bisection, from_ref(ego), from_ref(foe));
            let slow = meet(&participant(&ego, &all, &SweptBounds::EVERYWHERE), &participant(&foe, &all, &SweptBounds::EVERYWHERE));
            let (ego_whole, foe_whole) = (whole(&ego), whole(&foe));
            let (ego, foe) = (participant(&ego, &ego_parts, &ego_whole), participant(&foe, &foe_parts, &foe_whole));
            prop_assert!(slow.is_none() || ego.cover.meets(foe.cover));
            prop_assert_eq!(meet(&ego, &foe), slow);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100))]

        #[test]
        fn the_fine_sweep_finds_nothing_that_the_coarse_one_leaves_out(ego in path(), foe in path()) {
            let whole = |poses: &[Pose]| SweptBounds::of(poses, SIZE.0, SIZE.1).unwrap();
            let (ego_whole, foe_whole) = (whole(&ego), whole(&foe));
            let (ego, foe) = (participant(&ego, &[], &ego_whole), participant(&foe, &[], &foe_whole));
            let (ego, foe, mut bisection) = (from_ref(&ego), from_ref(&foe), Bisection::default());
            let coarse = meet(&mut bisection, ego, foe);
            let after = coarse.and_then(|_| refine(&mut bisection, FINE, ego, foe));
            bisection.clear();
            prop_assert_eq!(after, refine(&mut bisection, FINE, ego, foe));
            if let (Some(coarse), Some(fine)) = (coarse, after) {
                prop_assert!(coarse.ego != fine.ego || coarse.conflict_point.ego_distance <= fine.conflict_point.ego_distance + 0.02);
            }
        }
    }
}
