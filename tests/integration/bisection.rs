//! Where movements touch: equal, to the last bit, to trying all parts of both.

use closecall::Point;
use closecall::geometry::bisection::Bisection;
use closecall::geometry::convex::ConvexOutline;
use closecall::geometry::movement::{Movement, TOLERANCE};
use closecall::geometry::polygon::Polygon;
use closecall::geometry::rectangle::{Rectangle, direction};
use closecall::geometry::separating_axes::{Contact, translation};
use closecall::geometry::{Bounds, Vector};
use proptest::prelude::*;

/// The fraction of a movement at which it touches another's area, by all hulls of the other whose whole is touched.
fn touch(movement: &Movement, other: &Movement, which: Contact, tolerance: f64) -> Option<f64> {
    if !bounds(movement).meet(&bounds(other)) {
        return None;
    }
    let hull = other.hull();
    let part = meet(movement, &hull, &hull.bounds(), which, tolerance)?;
    if turn(other) * other.length / 4.0 <= tolerance {
        return Some(part);
    }
    let parts = halves(other).into_iter().filter_map(|half| touch(movement, &half, which, tolerance));
    parts.reduce(if which == Contact::Entry { f64::min } else { f64::max })
}

/// The fraction of a movement at which it touches a fixed outline.
fn meet(
    movement: &Movement,
    fixed: &ConvexOutline,
    box_around: &Bounds,
    which: Contact,
    tolerance: f64,
) -> Option<f64> {
    if turn(movement) * (movement.length + movement.width) / 2.0 <= tolerance {
        let (middle, by) = (movement.rectangle(0.5), movement.to - movement.from);
        let start = ConvexOutline::rectangle(&Rectangle { centre: middle.centre - by * 0.5, ..middle });
        let contact = translation(&start, &by, fixed)?;
        return Some(if which == Contact::Entry { contact.enter } else { contact.leave });
    }
    if !bounds(movement).meet(box_around) || translation(&movement.hull(), &Vector::zeros(), fixed).is_none() {
        return None;
    }
    let [first, second] = halves(movement);
    let first = || meet(&first, fixed, box_around, which, tolerance).map(|part| (part / 2.0).min(0.5));
    let second = || meet(&second, fixed, box_around, which, tolerance).map(|part| 0.5 + part / 2.0);
    if which == Contact::Entry { first().or_else(second) } else { second().or_else(first) }
}

fn turn(movement: &Movement) -> f64 {
    (movement.to_axis - movement.from_axis).norm()
}

fn bounds(movement: &Movement) -> Bounds {
    let mut bounds = movement.rectangle(0.0).bounds();
    bounds.join(&movement.rectangle(1.0).bounds());
    bounds
}

fn halves(movement: &Movement) -> [Movement; 2] {
    [(0.0, 0.5), (0.5, 1.0)].map(|(start, end)| Movement {
        from: movement.from + (movement.to - movement.from) * start,
        from_axis: movement.rectangle(start).axis,
        to: movement.from + (movement.to - movement.from) * end,
        to_axis: movement.rectangle(end).axis,
        ..*movement
    })
}

/// A last contact beyond the end counts as one at the end.
fn capped(part: Option<f64>) -> Option<f64> {
    part.map(|part| part.min(1.0))
}

/// That of the coarse sweep, and a finer one.
fn tolerance() -> impl Strategy<Value = f64> {
    prop_oneof![Just(TOLERANCE), Just(TOLERANCE / 4.0)]
}

prop_compose! {
    /// A movement of up to 10 m, as road users drive: it may turn, and slide a little.
    fn movement()(
        x in -8.0..8.0, y in -8.0..8.0, heading in -4.0..4.0, distance in prop_oneof![Just(0.0), 0.0..10.0],
        turn in prop_oneof![Just(0.0), -0.1..0.1, -1.5..1.5], slide in prop_oneof![Just(0.0), -0.3..0.3],
        length in 0.5..12.0, width in 0.3..3.0,
    ) -> Movement {
        let from = Point::new(20_000.0 + x, 5_000.0 + y);
        let (from_axis, to_axis) = (direction(heading), direction(heading + turn));
        let to = from + direction(heading + turn / 2.0 + slide) * distance;
        Movement { from, from_axis, to, to_axis, length, width }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(700))]

    #[test]
    fn leaving_out_parts_changes_no_contact(movement in movement(), others in prop::collection::vec(movement(), 1..4), tolerance in tolerance()) {
        let mut halves = Bisection::default();
        halves.sweep_to(tolerance);
        let part = halves.add(movement);
        let parts = others.iter().map(|other| halves.add(*other)).collect::<Vec<_>>();
        for which in [Contact::Entry, Contact::Exit] {
            let all = others.iter().filter_map(|other| touch(&movement, other, which, tolerance));
            let all = all.reduce(if which == Contact::Entry { f64::min } else { f64::max });
            let found = parts.iter().fold(which.none(), |known, other| halves.touch(part, *other, which, known));
            prop_assert_eq!(capped((found != which.none()).then_some(found)), capped(all));
        }
    }

    #[test]
    fn a_fixed_outline_is_met_where_all_parts_meet_it(movement in movement(), fixed in movement(), tolerance in tolerance()) {
        let (mut halves, outline) = (Bisection::default(), ConvexOutline::rectangle(&fixed.rectangle(0.0)));
        halves.sweep_to(tolerance);
        let part = halves.add(movement);
        for which in [Contact::Entry, Contact::Exit] {
            let found = halves.meet(part, &Polygon::from(outline), which);
            prop_assert_eq!(found, meet(&movement, &outline, &outline.bounds(), which, tolerance));
        }
    }
}
