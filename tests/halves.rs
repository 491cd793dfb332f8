//! Where steps touch, against trying all parts of both: the same to the last bit.

use closecall::geometry::bisection::{Bisection, Contact};
use closecall::geometry::convex::ConvexOutline;
use closecall::geometry::polygon::Polygon;
use closecall::geometry::rectangle::{Rectangle, direction};
use closecall::geometry::separating_axes::translation;
use closecall::geometry::sweep::{Step, TOLERANCE};
use closecall::geometry::{Bounds, Point, Vector};
use proptest::prelude::*;

/// The part of a step at which it touches another's area, by all hulls of the other that are not left out by one that
/// they are a half of.
fn touch(step: &Step, other: &Step, which: Contact) -> Option<f64> {
    if !bounds(step).meet(&bounds(other)) {
        return None;
    }
    let hull = other.hull();
    let part = meet(step, &hull, &hull.bounds(), which)?;
    if turn(other) * other.length / 4.0 <= TOLERANCE {
        return Some(part);
    }
    let parts = halves(other).into_iter().filter_map(|half| touch(step, &half, which));
    parts.reduce(if which == Contact::Entry { f64::min } else { f64::max })
}

/// The part of a step at which it touches a fixed outline.
fn meet(step: &Step, fixed: &ConvexOutline, box_around: &Bounds, which: Contact) -> Option<f64> {
    if turn(step) * (step.length + step.width) / 2.0 <= TOLERANCE {
        let (middle, by) = (step.rectangle(0.5), step.to - step.from);
        let start = ConvexOutline::rectangle(&Rectangle { centre: middle.centre - by * 0.5, ..middle });
        let contact = translation(&start, &by, fixed)?;
        return Some(if which == Contact::Entry { contact.enter } else { contact.leave });
    }
    if !bounds(step).meet(box_around) || translation(&step.hull(), &Vector::zeros(), fixed).is_none() {
        return None;
    }
    let [first, second] = halves(step);
    let first = || meet(&first, fixed, box_around, which).map(|part| (part / 2.0).min(0.5));
    let second = || meet(&second, fixed, box_around, which).map(|part| 0.5 + part / 2.0);
    if which == Contact::Entry { first().or_else(second) } else { second().or_else(first) }
}

fn turn(step: &Step) -> f64 {
    (step.to_axis - step.from_axis).norm()
}

fn bounds(step: &Step) -> Bounds {
    let mut bounds = step.rectangle(0.0).bounds();
    bounds.join(&step.rectangle(1.0).bounds());
    bounds
}

fn halves(step: &Step) -> [Step; 2] {
    [(0.0, 0.5), (0.5, 1.0)].map(|(start, end)| Step {
        from: step.from + (step.to - step.from) * start,
        from_axis: step.rectangle(start).axis,
        to: step.from + (step.to - step.from) * end,
        to_axis: step.rectangle(end).axis,
        ..*step
    })
}

/// The last touch beyond the end is that at the end.
fn capped(part: Option<f64>) -> Option<f64> {
    part.map(|part| part.min(1.0))
}

prop_compose! {
    /// A step of 10 m at most, as road users drive: it may turn, and slide a little.
    fn step()(
        x in -8.0..8.0, y in -8.0..8.0, heading in -4.0..4.0, way in prop_oneof![Just(0.0), 0.0..10.0],
        turn in prop_oneof![Just(0.0), -0.1..0.1, -1.5..1.5], slide in prop_oneof![Just(0.0), -0.3..0.3],
        length in 0.5..12.0, width in 0.3..3.0,
    ) -> Step {
        let from = Point::new(20_000.0 + x, 5_000.0 + y);
        let (from_axis, to_axis) = (direction(heading), direction(heading + turn));
        let to = from + direction(heading + turn / 2.0 + slide) * way;
        Step { from, from_axis, to, to_axis, length, width }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn what_is_left_out_changes_no_touch(step in step(), others in prop::collection::vec(step(), 1..4)) {
        let mut halves = Bisection::default();
        let part = halves.add(step);
        let parts = others.iter().map(|other| halves.add(*other)).collect::<Vec<_>>();
        for which in [Contact::Entry, Contact::Exit] {
            let all = others.iter().filter_map(|other| touch(&step, other, which));
            let all = all.reduce(if which == Contact::Entry { f64::min } else { f64::max });
            let found = parts.iter().fold(which.none(), |known, other| halves.touch(part, *other, which, known));
            prop_assert_eq!(capped((found != which.none()).then_some(found)), capped(all));
        }
    }

    #[test]
    fn a_fixed_outline_is_met_where_all_parts_say(step in step(), fixed in step()) {
        let (mut halves, outline) = (Bisection::default(), ConvexOutline::rectangle(&fixed.rectangle(0.0)));
        let part = halves.add(step);
        for which in [Contact::Entry, Contact::Exit] {
            let found = halves.meet(part, &Polygon::from(outline), which);
            prop_assert_eq!(found, meet(&step, &outline, &outline.bounds(), which));
        }
    }
}
