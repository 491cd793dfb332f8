//! Time to collision: when two rectangles touch if both keep their speed along their paths.

use crate::detection::path::Pose;
use crate::geometry::bisection::{Bisection, Contact};
use crate::geometry::polygon::Polygon;
use crate::geometry::rectangle::Rectangle;
use crate::geometry::separating_axes::slide;
use crate::geometry::sweep::{Step, TOLERANCE};
use crate::geometry::{Point, Vector};
use crate::util::units::{Metre, MetrePerSecond, Second};

/// ContactInterval that is later than this is none: paths are not laid further; s.
pub const HORIZON: Second = 10.0;

/// One road user that keeps its speed along its poses, which reach [`HORIZON`] ahead.
#[derive(Clone, Copy, Debug)]
pub struct Course<'a> {
    /// Poses from now on; straight on beyond the last.
    pub poses: &'a [Pose],
    /// Speed in m/s.
    pub speed: MetrePerSecond,
    /// Length in m.
    pub length: Metre,
    /// Width in m.
    pub width: Metre,
}

impl Course<'_> {
    /// Where it is after a time.
    pub(crate) fn at(&self, time: Second) -> Rectangle {
        let way = self.speed * time;
        let next = self.poses.partition_point(|pose| pose.way <= way);
        let (front, axis): (Point, Vector) = match (self.poses.get(next.wrapping_sub(1)), self.poses.get(next)) {
            (Some(last), Some(next)) => {
                let part = (way - last.way) / (next.way - last.way);
                let axis = last.axis + (next.axis - last.axis) * part;
                (last.front + (next.front - last.front) * part, axis.normalize())
            }
            (Some(last), None) => (last.front + last.axis * (way - last.way), last.axis),
            (None, _) => (Point::origin(), Vector::x()),
        };
        Rectangle::behind(front, axis, self.length, self.width)
    }

    /// Its steps from pose to pose, and the ways at which they begin and end, until it is as far as that.
    pub(crate) fn steps(&self, furthest: Metre) -> impl Iterator<Item = (Metre, Metre, Step)> {
        let beyond = self.poses.last().filter(|last| last.way < furthest).map(|last| {
            [*last, Pose { way: furthest, front: last.front + last.axis * (furthest - last.way), ..*last }]
        });
        let step = |from: &Pose, to: &Pose| (from.way, to.way, from.step_to(to, self.length, self.width));
        let laid = self.poses.windows(2).take_while(move |pair| pair[0].way < furthest);
        laid.map(move |pair| step(&pair[0], &pair[1])).chain(beyond.map(move |[from, to]| step(&from, &to)))
    }

    /// Where it is now, and how far it moves until [`HORIZON`], if it goes straight on so long.
    pub(crate) fn straight(&self) -> Option<(Rectangle, Vector)> {
        let way = self.speed * HORIZON;
        let (first, by) = match self.poses {
            [only] => (only, only.axis * way),
            [first, last] if first.axis == last.axis && last.way >= way => {
                (first, if way > 0.0 { (last.front - first.front) * (way / last.way) } else { Vector::zeros() })
            }
            _ => return None,
        };
        Some((Rectangle::behind(first.front, first.axis, self.length, self.width), by))
    }

    /// The next time at which it reaches a pose.
    fn next_pose(&self, time: Second) -> Second {
        let way = self.speed * time;
        let next = self.poses.partition_point(|pose| pose.way <= way * (1.0 + f64::EPSILON));
        match self.poses.get(next) {
            Some(pose) if self.speed > 0.0 => pose.way / self.speed,
            _ => f64::INFINITY,
        }
    }
}

/// Time until a moving road user touches another, in s; none where it does not within [`HORIZON`].
pub fn time_to_collision(a: &Course, b: &Course) -> Option<Second> {
    if let (Some((a, by)), Some((b, foe_by))) = (a.straight(), b.straight()) {
        return slide(&a, &(by - foe_by), &b).map(|contact| contact.enter * HORIZON);
    }
    let both_at = |time| (time, [a.at(time), b.at(time)]);
    let mut start = both_at(0.0);
    while start.0 < HORIZON {
        let time = a.next_pose(start.0).min(b.next_pose(start.0)).min(HORIZON).max(start.0 + 1e-6);
        let end = both_at(time);
        let contact = contact_between(&both_at, start, end, 0);
        if contact.is_some() {
            return contact;
        }
        start = end;
    }
    None
}

/// Time until a moving road user touches something that stands.
pub fn time_to_fixed(halves: &mut Bisection, a: &Course, fixed: &[Polygon]) -> Option<Second> {
    a.poses
        .windows(2)
        .find_map(|pair| {
            halves.clear();
            let (pose, next) = (&pair[0], &pair[1]);
            let step = halves.add(pose.step_to(next, a.length, a.width));
            let touched = fixed.iter().filter_map(|shape| halves.meet(step, shape, Contact::Entry));
            let time = |enter| (pose.way + (next.way - pose.way) * enter) / a.speed;
            touched.map(time).reduce(f64::min)
        })
        .filter(|time| *time <= HORIZON)
}

/// A time, and both rectangles at it.
type Moment = (Second, [Rectangle; 2]);

/// Between two times in which both move almost straight: relative translation in closed form; halved as long as the
/// turning of the two is more than the tolerance allows.
fn contact_between(at: &impl Fn(Second) -> Moment, start: Moment, end: Moment, depth: u32) -> Option<Second> {
    /// Halving this often leaves less than a millionth of the interval.
    const DEEPEST: u32 = 20;
    let ([a_start, b_start], [a_end, b_end]) = (&start.1, &end.1);
    if !near(a_start, a_end, b_start, b_end) {
        return None;
    }
    let bend =
        |first: &Rectangle, last: &Rectangle| (last.axis - first.axis).norm() * (first.half_length + first.half_width);
    if depth < DEEPEST && bend(a_start, a_end) + bend(b_start, b_end) > TOLERANCE {
        let middle = at((start.0 + end.0) / 2.0);
        return contact_between(at, start, middle, depth + 1).or_else(|| contact_between(at, middle, end, depth + 1));
    }
    let by = (a_end.centre - a_start.centre) - (b_end.centre - b_start.centre);
    let contact = slide(a_start, &by, b_start)?;
    Some(start.0 + (end.0 - start.0) * contact.enter)
}

/// Whether the boxes around the two movements meet at all.
fn near(a_start: &Rectangle, a_end: &Rectangle, b_start: &Rectangle, b_end: &Rectangle) -> bool {
    let mut a = a_start.bounds();
    a.join(&a_end.bounds());
    let mut b = b_start.bounds();
    b.join(&b_end.bounds());
    a.grown(TOLERANCE).meet(&b.grown(TOLERANCE))
}

#[cfg(test)]
mod tests {
    use crate::detection::measures::ttc::*;

    fn straight(x: f64, y: f64, heading: f64, speed: f64) -> (Vec<Pose>, f64) {
        let axis = crate::geometry::rectangle::direction(heading);
        (vec![Pose { way: 0.0, front: Point::new(x, y), axis }], speed)
    }

    fn ttc(a: (Vec<Pose>, f64), b: (Vec<Pose>, f64)) -> Option<f64> {
        let course = |(poses, speed): &(Vec<Pose>, f64)| Course {
            poses: Box::leak(poses.clone().into()),
            speed: *speed,
            length: 5.0,
            width: 2.0,
        };
        time_to_collision(&course(&a), &course(&b))
    }

    #[test]
    fn a_follower_needs_the_gap_over_the_closing_speed() {
        let found = ttc(straight(0.0, 0.0, 0.0, 20.0), straight(25.0, 0.0, 0.0, 10.0)).unwrap();
        assert!((found - 2.0).abs() < 1e-12);
    }

    #[test]
    fn who_passes_behind_the_other_never_touches() {
        let crossing = straight(30.0, -9.0, std::f64::consts::FRAC_PI_2, 10.0);
        assert_eq!(ttc(straight(0.0, 0.0, 0.0, 10.0), crossing), None);
    }

    #[test]
    fn equal_speeds_never_touch() {
        assert_eq!(ttc(straight(0.0, 0.0, 0.0, 20.0), straight(25.0, 0.0, 0.0, 20.0)), None);
    }
}
