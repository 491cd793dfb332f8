//! Time to collision: when two rectangles touch if both keep their speed along their paths.

use crate::detection::path::Pose;
use crate::geometry::bisection::Bisection;
use crate::geometry::movement::{Movement, TOLERANCE};
use crate::geometry::polygon::Polygon;
use crate::geometry::rectangle::Rectangle;
use crate::geometry::separating_axes::{Contact, slide};
use crate::geometry::{Point, Vector};
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Second};

/// A later contact does not count, in s: paths are not built further.
pub const HORIZON: Second = 10.0;

/// A relative difference between distances along a path and in the plane that changes no measure by as much.
const STRETCHED: f64 = 1e-3;

/// How far a pose may be from where an even movement has it, in m: on lanes of which one is longer, the other shorter than
/// drawn.
const UNEVEN: Metre = 0.005;

/// A road user that keeps its speed, or its deceleration until it stands, along its poses, which reach [`HORIZON`] ahead.
#[derive(Clone, Copy, Debug)]
pub struct SteadyMotion<'a> {
    /// Poses from now on; beyond the last, straight on.
    pub poses: &'a [Pose],
    /// Speed in m/s.
    pub speed: MetrePerSecond,
    /// Deceleration in m/s², 0 or more.
    pub deceleration: MetrePerSecondSquared,
    /// Length in m.
    pub length: Metre,
    /// Width in m.
    pub width: Metre,
}

impl SteadyMotion<'_> {
    /// Its rectangle after a time.
    pub fn at(&self, time: Second) -> Rectangle {
        self.at_distance(self.travel(time))
    }

    /// The distance that it travels in a time.
    pub(super) fn travel(&self, time: Second) -> Metre {
        if self.deceleration == 0.0 {
            return self.speed * time;
        }
        let brakes = time.min(self.speed / self.deceleration);
        (self.speed - self.deceleration * brakes / 2.0) * brakes
    }

    /// Its rectangle after a time in which it has braked with this deceleration, or stands already.
    pub(crate) fn braked(&self, time: Second, deceleration: MetrePerSecondSquared) -> Rectangle {
        let brakes = time.min(self.speed / deceleration);
        self.at_distance((self.speed - deceleration * brakes / 2.0) * brakes)
    }

    /// Its rectangle at a distance along its poses.
    fn at_distance(&self, distance: Metre) -> Rectangle {
        let next = self.poses.partition_point(|pose| pose.distance <= distance);
        let (front, axis): (Point, Vector) = match (self.poses.get(next.wrapping_sub(1)), self.poses.get(next)) {
            (Some(last), Some(next)) => {
                let part = (distance - last.distance) / (next.distance - last.distance);
                let axis = last.axis + (next.axis - last.axis) * part;
                (last.front + (next.front - last.front) * part, axis.normalize())
            }
            (Some(last), None) => (last.front + last.axis * (distance - last.distance), last.axis),
            (None, _) => (Point::origin(), Vector::x()),
        };
        Rectangle::behind(front, axis, self.length, self.width)
    }

    /// Its movements from pose to pose up to a distance; each with the distances at which it begins and ends.
    pub(crate) fn movements(&self, furthest: Metre) -> impl Iterator<Item = (Metre, Metre, Movement)> {
        let beyond = self.poses.last().filter(|last| last.distance < furthest).map(|last| {
            [*last, Pose { distance: furthest, front: last.front + last.axis * (furthest - last.distance), ..*last }]
        });
        let movement =
            |from: &Pose, to: &Pose| (from.distance, to.distance, from.movement_to(to, self.length, self.width));
        let known = self.poses.windows(2).take_while(move |pair| pair[0].distance < furthest);
        known.map(move |pair| movement(&pair[0], &pair[1])).chain(beyond.map(move |[from, to]| movement(&from, &to)))
    }

    /// Its rectangle now and its displacement in a time, if it keeps its speed and goes straight on for so long.
    pub(crate) fn straight(&self, time: Second) -> Option<(Rectangle, Vector)> {
        if self.deceleration == 0.0 { self.straight_for(self.speed * time) } else { None }
    }

    /// Its rectangle now and its displacement over a distance, if it goes straight on for so long, as beyond the last pose. None
    /// on a lane that is longer or shorter than drawn: the displacement is not the distance there.
    pub(super) fn straight_for(&self, distance: Metre) -> Option<(Rectangle, Vector)> {
        let (first, by) = match self.poses {
            [only] => (only, only.axis * distance),
            [first, ..] => {
                let alike = self.poses.iter().take_while(|pose| pose.axis == first.axis);
                let last = alike.clone().last()?;
                let moves = (last.front - first.front).norm();
                let goes_on = alike.clone().count() == self.poses.len();
                if (last.distance < distance && !goes_on) || (moves - last.distance).abs() > STRETCHED * last.distance {
                    return None;
                }
                let is_even = |pose: &Pose| {
                    let travelled = moves * pose.distance - last.distance * (pose.front - first.front).norm();
                    travelled.abs() <= UNEVEN * last.distance
                };
                if !alike.clone().all(is_even) {
                    return None;
                }
                let within = distance.min(last.distance);
                let part = if within > 0.0 { within / last.distance } else { 0.0 };
                (first, (last.front - first.front) * part + last.axis * (distance - within))
            }
            [] => return None,
        };
        Some((Rectangle::behind(first.front, first.axis, self.length, self.width), by))
    }

    /// The next time at which it reaches a pose.
    fn next_pose(&self, time: Second) -> Second {
        let distance = self.travel(time);
        let next = self.poses.partition_point(|pose| pose.distance <= distance * (1.0 + f64::EPSILON));
        let left = |pose: &Pose| self.speed * self.speed - 2.0 * self.deceleration * pose.distance;
        match self.poses.get(next) {
            Some(pose) if self.speed > 0.0 && left(pose) >= 0.0 => {
                if self.deceleration > 0.0 {
                    2.0 * pose.distance / (self.speed + left(pose).sqrt())
                } else {
                    pose.distance / self.speed
                }
            }
            _ => f64::INFINITY,
        }
    }
}

/// Time until two moving road users touch, in s; none if they do not within [`HORIZON`].
pub fn time_to_collision(a: &SteadyMotion, b: &SteadyMotion) -> Option<Second> {
    if let (Some((a, by)), Some((b, foe_by))) = (a.straight(HORIZON), b.straight(HORIZON)) {
        return slide(&a, &(by - foe_by), &b).map(|contact| contact.enter * HORIZON);
    }
    let both_at = |time| PairAt { time, a: a.at(time), b: b.at(time) };
    let decelerations = a.deceleration + b.deceleration;
    let mut start = both_at(0.0);
    while start.time < HORIZON {
        let time = a.next_pose(start.time).min(b.next_pose(start.time)).min(HORIZON).max(start.time + 1e-6);
        let end = both_at(time);
        let contact = contact_between(&both_at, decelerations, &start, &end, 0);
        if contact.is_some() {
            return contact;
        }
        start = end;
    }
    None
}

/// Whether two road users that both brake with this deceleration touch before they stand.
pub(super) fn touch_while_braking(a: &SteadyMotion, b: &SteadyMotion, deceleration: MetrePerSecondSquared) -> bool {
    /// Within each of these parts of the time both keep their speeds: braking from 30 m/s, the distance is then wrong by 2 cm
    /// at most.
    const PARTS: u32 = 64;
    let stand = (a.speed.max(b.speed) / deceleration).min(2.0 * HORIZON);
    let both_at = |time| PairAt { time, a: a.braked(time, deceleration), b: b.braked(time, deceleration) };
    let mut start = both_at(0.0);
    (1..=PARTS).any(|part| {
        let end = both_at(stand * f64::from(part) / f64::from(PARTS));
        let start = std::mem::replace(&mut start, end);
        contact_between(&both_at, 0.0, &start, &end, 0).is_some()
    })
}

/// Time until a moving road user touches an obstacle, in s; none if it does not within [`HORIZON`].
pub(crate) fn time_to_fixed(bisection: &mut Bisection, a: &SteadyMotion, fixed: &[Polygon]) -> Option<Second> {
    a.poses
        .windows(2)
        .find_map(|pair| {
            bisection.clear();
            let pose = &pair[0];
            let next = &pair[1];
            let movement = bisection.add(pose.movement_to(next, a.length, a.width));
            let touched = fixed.iter().filter_map(|shape| bisection.meet(movement, shape, Contact::Entry));
            let time = |enter| (pose.distance + (next.distance - pose.distance) * enter) / a.speed;
            touched.map(time).reduce(f64::min)
        })
        .filter(|time| *time <= HORIZON)
}

/// Two road users at a time.
#[derive(Clone, Copy)]
struct PairAt {
    time: Second,
    a: Rectangle,
    b: Rectangle,
}

/// The first contact between two times. The interval is halved until both hardly turn and, with these decelerations, hardly
/// change their speeds; then the relative translation has a closed form.
fn contact_between(
    at: &impl Fn(Second) -> PairAt,
    decelerations: MetrePerSecondSquared,
    start: &PairAt,
    end: &PairAt,
    depth: u32,
) -> Option<Second> {
    /// After this many halvings less than a millionth of the interval is left.
    const DEEPEST: u32 = 20;
    if !boxes_meet(start, end) {
        return None;
    }
    let bend =
        |first: &Rectangle, last: &Rectangle| (last.axis - first.axis).norm() * (first.half_length + first.half_width);
    let time = end.time - start.time;
    let sags = decelerations * time * time / 8.0;
    if depth < DEEPEST && bend(&start.a, &end.a) + bend(&start.b, &end.b) + sags > TOLERANCE {
        let middle = at((start.time + end.time) / 2.0);
        return contact_between(at, decelerations, start, &middle, depth + 1)
            .or_else(|| contact_between(at, decelerations, &middle, end, depth + 1));
    }
    let by = (end.a.centre - start.a.centre) - (end.b.centre - start.b.centre);
    let contact = slide(&start.a, &by, &start.b)?;
    Some(start.time + time * contact.enter)
}

/// Whether the boxes around the two movements meet.
fn boxes_meet(start: &PairAt, end: &PairAt) -> bool {
    let mut a = start.a.bounds();
    a.join(&end.a.bounds());
    let mut b = start.b.bounds();
    b.join(&end.b.bounds());
    a.grown(TOLERANCE).meet(&b.grown(TOLERANCE))
}

#[cfg(test)]
mod tests {
    use crate::detection::measures::ttc::*;

    fn straight(x: f64, y: f64, heading: f64, speed: f64) -> (Vec<Pose>, f64) {
        let axis = crate::geometry::rectangle::direction(heading);
        (vec![Pose { distance: 0.0, front: Point::new(x, y), axis }], speed)
    }

    fn ttc(a: (Vec<Pose>, f64), b: (Vec<Pose>, f64)) -> Option<f64> {
        let motion = |(poses, speed): &(Vec<Pose>, f64)| SteadyMotion {
            poses: Box::leak(poses.clone().into()),
            speed: *speed,
            deceleration: 0.0,
            length: 5.0,
            width: 2.0,
        };
        time_to_collision(&motion(&a), &motion(&b))
    }

    #[test]
    fn a_follower_needs_the_gap_over_the_closing_speed() {
        let found = ttc(straight(0.0, 0.0, 0.0, 20.0), straight(25.0, 0.0, 0.0, 10.0)).unwrap();
        assert!((found - 2.0).abs() < 1e-12);
    }

    #[test]
    fn passing_behind_the_other_is_not_a_contact() {
        let crossing = straight(30.0, -9.0, std::f64::consts::FRAC_PI_2, 10.0);
        assert_eq!(ttc(straight(0.0, 0.0, 0.0, 10.0), crossing), None);
    }

    #[test]
    fn a_leader_that_brakes_is_reached_sooner() {
        let [ego, leader] = [straight(0.0, 0.0, 0.0, 20.0), straight(25.0, 0.0, 0.0, 20.0)];
        let motion = |(poses, speed): &(Vec<Pose>, f64), deceleration| SteadyMotion {
            poses: Box::leak(poses.clone().into()),
            speed: *speed,
            deceleration,
            length: 5.0,
            width: 2.0,
        };
        // 20 m of room are used up when 5/2 t² = 20.
        let found = time_to_collision(&motion(&ego, 0.0), &motion(&leader, 5.0)).unwrap();
        assert!((found - 8.0_f64.sqrt()).abs() < 1e-3, "{found}");
        // Both brake alike.
        assert_eq!(time_to_collision(&motion(&ego, 5.0), &motion(&leader, 5.0)), None);
    }

    #[test]
    fn equal_speeds_never_touch() {
        assert_eq!(ttc(straight(0.0, 0.0, 0.0, 20.0), straight(25.0, 0.0, 0.0, 20.0)), None);
    }
}
