//! Side, and whatever else is not in line: swept rectangles.

use super::{Meeting, Mover};
use crate::geometry::Vector;
use crate::geometry::outline::Outline;
use crate::geometry::rectangle::Rectangle;
use crate::geometry::sweep::{Step, TOLERANCE, translation};
use crate::path::Pose;
use crate::units::Metre;

/// How far from each other two may be, after both were swept, where they touch, in m.
const INEXACT: Metre = 2.0 * TOLERANCE;

/// The first pose on the ego's path at which its rectangle touches the area that the foe covers now and still needs
/// to stop; none if there is no such pose.
pub fn meet(ego: &Mover, foe: &Mover, in_line: bool) -> Option<Meeting> {
    if !ego.bounds.meet(&foe.bounds) {
        return None;
    }
    let (ego_way, rectangle) = first_touch(ego, foe)?;
    if !foe.shape.is_empty() {
        return Some(Meeting { ego_way, foe_way: 0.0, ego: rectangle, foe_axis: None, leads: false });
    }
    if in_line && rectangle.axis.dot(&foe.rectangle.axis) > 0.0 {
        let foe_axis = Some(foe.rectangle.axis);
        return Some(Meeting { ego_way, foe_way: 0.0, ego: rectangle, foe_axis, leads: true });
    }
    let (foe_way, foe_axis) = arrival(foe, &rectangle, if in_line { 0.0 } else { INEXACT });
    Some(Meeting { ego_way, foe_way, ego: rectangle, foe_axis: Some(foe_axis), leads: false })
}

/// The ego's way to the foe's area and its rectangle there.
fn first_touch(ego: &Mover, foe: &Mover) -> Option<(Metre, Rectangle)> {
    for (index, (pose, step)) in steps(ego.poses, ego).enumerate() {
        let bounds = step.bounds();
        if bounds.meet(&foe.bounds) {
            let mut enter = f64::INFINITY;
            for part in foe.shape.iter().filter(|part| part.bounds.meet(&bounds)) {
                if let Some(touch) = step.enter(&part.outline) {
                    enter = enter.min(touch);
                }
            }
            for part in area(foe).filter(|part| part.bounds().meet(&bounds)) {
                if let Some(touch) = step.first_touch(&part) {
                    enter = enter.min(touch);
                }
            }
            if enter <= 1.0 {
                let next = ego.poses[index + 1].way;
                return Some((pose.way + (next - pose.way) * enter, step.rectangle(enter)));
            }
        }
    }
    None
}

/// The steps over which the foe covers the area that it is in now and still needs to stop; none of an obstacle.
fn area(foe: &Mover) -> impl Iterator<Item = Step> {
    let stands = foe.shape.is_empty() && foe.stop <= 0.0;
    let now = Pose {
        way: 0.0,
        front: foe.rectangle.centre + foe.rectangle.axis * foe.rectangle.half_length,
        axis: foe.rectangle.axis,
    };
    let moving = steps(foe.poses, foe).take_while(|(pose, _)| pose.way < foe.stop).map(|(_, step)| step);
    stands.then(|| now.step_to(&now, foe.length(), foe.width())).into_iter().chain(moving)
}

/// The foe's way to the ego's rectangle at the meeting place, and its axis there.
///
/// The two touch there to within rounding and the sweep's tolerances, so the rectangle is taken larger by that.
fn arrival(foe: &Mover, ego: &Rectangle, inexact: Metre) -> (Metre, Vector) {
    let ego = Outline::rectangle(&grown(ego, inexact));
    for (index, (pose, step)) in steps(foe.poses, foe).enumerate() {
        if let Some(enter) = step.enter(&ego) {
            let next = foe.poses[index + 1].way;
            return (pose.way + (next - pose.way) * enter, step.rectangle(enter).axis);
        }
        if pose.way >= foe.stop {
            break;
        }
    }
    (foe.stop.min(foe.reach()), foe.poses.last().map_or(foe.rectangle.axis, |pose| pose.axis))
}

/// The way at which a foe on these poses has left the ego's rectangle at the meeting place; `arrival` is its way
/// until it is there.
pub fn departure(poses: &[Pose], foe: &Mover, ego: &Rectangle, arrival: Metre) -> Metre {
    let ego = Outline::rectangle(&grown(ego, INEXACT));
    let mut left = arrival;
    for (pose, next, step) in
        poses.windows(2).map(|pair| (pair[0], pair[1], pair[0].step_to(&pair[1], foe.length(), foe.width())))
    {
        if next.way < arrival {
            continue;
        }
        let Some(leave) = step.leave(&ego) else {
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

fn steps<'a>(poses: &'a [Pose], of: &Mover) -> impl Iterator<Item = (Pose, Step)> + 'a {
    let (length, width) = (of.length(), of.width());
    poses.windows(2).map(move |pair| (pair[0], pair[0].step_to(&pair[1], length, width)))
}

/// Whether two rectangles-with-shapes overlap or touch now.
pub fn touch_now(a: &Mover, b: &Mover) -> bool {
    let outline = Outline::rectangle(&a.rectangle);
    if b.shape.is_empty() {
        return crate::geometry::rectangle::touches(&a.rectangle, &b.rectangle);
    }
    b.shape.iter().any(|part| translation(&outline, &Vector::zeros(), &part.outline).is_some())
}
