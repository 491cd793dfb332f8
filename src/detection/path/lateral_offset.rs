//! A line beside the lanes' centre line: the path of a road user that keeps to one side or changes lanes. Its metres are
//! those of the centre line: SUMO advances along the lane, so a vehicle on the outer side of a bend is faster.

use crate::geometry::polylines::Lines;
use crate::geometry::{Point, Vector, left_of};
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Second};

/// A vehicle with a lower speed keeps its offset, and lateral speeds that differ by less are the same, in m/s.
const KEEPS_OFFSET: MetrePerSecond = 0.01;
/// A vehicle that moves within its lane stays this far off the border, in m: more than the error of sweeping.
const OFF_THE_BORDER: Metre = 0.05;
/// Lateral acceleration in m/s², SUMO's default `lcAccelLat`: no lateral movement ends sooner.
const SLOWS_DOWN: MetrePerSecondSquared = 1.0;

/// How a road user moves across its lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Movement {
    /// Its offset from the centre line, positive to the left.
    pub now: Metre,
    /// Its lateral speed, positive to the left.
    pub speed: MetrePerSecond,
    /// The lateral speed that it had when its path was last built.
    pub before: MetrePerSecond,
    /// How fast it drives along the lane.
    pub ahead: MetrePerSecond,
    /// Its width.
    pub width: Metre,
    /// Width of the lane.
    pub lane_width: Metre,
    /// Whether there is another lane on the side to which it moves.
    pub leads_to_a_lane: bool,
    /// Whether it may move without changing lanes (SUMO's sublane model).
    pub sublane: bool,
    /// How long a step takes, in s: SUMO changes speeds at its beginning.
    pub step: Second,
}

/// Lateral offset from the centre line, positive to the left: `now` at distance 0, changing evenly to `target` over a
/// distance of `over`. `speed` is the lateral speed now.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Offset {
    pub now: Metre,
    pub target: Metre,
    pub over: Metre,
    pub speed: MetrePerSecond,
}

impl Offset {
    /// The current offset, and where a movement leads: to the centre of this lane or the next one, or (sublane model) to
    /// where it comes to rest or to the border of this lane.
    pub fn of(movement: &Movement) -> Self {
        let Movement { now, speed, before, sublane, step, .. } = *movement;
        if speed.abs() < KEEPS_OFFSET || movement.ahead < KEEPS_OFFSET {
            return Self { now, target: now, over: 0.0, speed: 0.0 };
        }
        // Offsets in the direction of the movement: now, and where it can end at the earliest.
        let at = now * speed.signum();
        let slowing_down = (speed * speed / (2.0 * SLOWS_DOWN) - speed.abs() * step / 2.0).max(0.0);
        let rest = at + if sublane { slowing_down } else { 0.0 };
        // The largest offset within the lane: two that drift towards each other in adjacent lanes do not touch.
        let inside = ((movement.lane_width - movement.width) / 2.0 - OFF_THE_BORDER).max(0.0);
        let slows_down = before * speed > 0.0 && speed.abs() < before.abs() - KEEPS_OFFSET;
        let target = if sublane && slows_down {
            rest
        } else if at < 0.0 && rest <= 0.0 {
            0.0
        } else if sublane && (rest < inside || !movement.leads_to_a_lane) {
            // At a border without a lane beyond, the vehicle goes no further.
            inside.max(at)
        } else {
            movement.lane_width
        };
        Self { now, target: target * speed.signum(), over: (target - at) / speed.abs() * movement.ahead, speed }
    }

    fn at(&self, distance: Metre) -> Metre {
        if distance <= 0.0 || self.over <= 0.0 {
            self.now
        } else {
            self.now + (self.target - self.now) * (distance / self.over).min(1.0)
        }
    }
}

/// Builds a line beside the centre line from the points of the latter, in driving order.
#[derive(Clone, Debug)]
pub(super) struct OffsetLine {
    offset: Offset,
    /// The last two points of the centre line. The vertex beside the last one depends on the next point.
    before: Option<Point>,
    last: Option<Point>,
    /// Distance of the last point along the centre line, from where the front bumper was when the line was begun.
    distance: Metre,
    /// Way along the centre line from the last vertex to beside the last point.
    along: Metre,
}

impl OffsetLine {
    /// None if the line is the centre line itself.
    pub fn new(offset: Offset) -> Option<Self> {
        let is_aside = offset.now != 0.0 || offset.target != 0.0;
        is_aside.then_some(Self { offset, before: None, last: None, distance: f64::NEG_INFINITY, along: 0.0 })
    }

    /// The offset where the line was begun.
    pub fn aside(&self) -> Metre {
        self.offset.now
    }

    /// The lateral speed where the line was begun, positive to the left.
    pub fn speed(&self) -> MetrePerSecond {
        self.offset.speed
    }

    /// Adds the next point of the centre line behind the front bumper.
    pub(crate) fn push_behind(&mut self, line: &mut Lines, point: Point) {
        self.push(line, point, f64::NEG_INFINITY);
    }

    /// Adds the point of the centre line beside the front bumper.
    pub(crate) fn push_front(&mut self, line: &mut Lines, point: Point) {
        self.distance = 0.0;
        self.push(line, point, 0.0);
    }

    /// Adds the next point of the centre line ahead.
    pub(crate) fn push_ahead(&mut self, line: &mut Lines, point: Point) {
        let distance = self.distance + self.last.map_or(0.0, |last| (point - last).norm());
        // A changing offset needs a vertex where the change ends.
        if self.distance < self.offset.over
            && self.offset.over < distance
            && let Some(last) = self.last
        {
            let part = (self.offset.over - self.distance) / (distance - self.distance);
            self.push(line, last + (point - last) * part, self.offset.over);
        }
        self.push(line, point, distance);
    }

    /// Adds a point of the centre line, and the vertex beside the point before.
    fn push(&mut self, line: &mut Lines, point: Point, distance: Metre) {
        if self.last.is_some_and(|last| (point - last).norm() < 1e-3) {
            return;
        }
        if let (Some(before), Some(last)) = (self.before, self.last) {
            self.add(line, last, miter(&(last - before), &(point - last)));
        } else if let Some(first) = self.last {
            self.add(line, first, left_of(&(point - first).try_normalize(0.0).unwrap_or_else(Vector::x)));
        }
        self.along += self.last.map_or(0.0, |last| (point - last).norm());
        self.before = self.last.replace(point);
        self.distance = distance;
    }

    /// Adds the vertex beside the last point of the centre line, for as long as no further point is known.
    pub fn flush(&mut self, line: &mut Lines) {
        if let (Some(before), Some(last)) = (self.before, self.last) {
            self.add(line, last, left_of(&(last - before).try_normalize(0.0).unwrap_or_else(Vector::x)));
        }
    }

    /// Adds the vertex beside the last point of the centre line, `shift` for an offset of 1 to the left.
    fn add(&mut self, line: &mut Lines, last: Point, shift: Vector) {
        self.along = line.push_beside(last + shift * self.offset.at(self.distance), self.along);
    }
}

/// The shift of the vertex between two segments of a line, for an offset of 1 to the left.
fn miter(before: &Vector, after: &Vector) -> Vector {
    /// Longest shift: the miter of a sharp corner would lie far away.
    const LONGEST: f64 = 2.0;
    let (a, b) = (left_of(&before.normalize()), left_of(&after.normalize()));
    let sum = a + b;
    let length = 2.0 / sum.norm_squared().max(1e-12);
    (sum * length).cap_magnitude(LONGEST)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use crate::detection::path::lateral_offset::*;

    /// A motorcycle that drives 10 m/s in a lane of 3.2 m.
    const MOTORCYCLE: Movement = Movement {
        now: 0.0,
        speed: 0.0,
        before: 0.0,
        ahead: 10.0,
        width: 0.9,
        lane_width: 3.2,
        leads_to_a_lane: true,
        sublane: true,
        step: 0.0,
    };
    /// The largest offset within the lane.
    const INSIDE: Metre = 1.1;

    /// Where a movement leads, to the micrometre; to the right as to the left.
    fn leads_to(now: Metre, speed: MetrePerSecond, before: MetrePerSecond, rest: Movement) -> Metre {
        let left = Offset::of(&Movement { now, speed, before, ..rest });
        let right = Offset::of(&Movement { now: -now, speed: -speed, before: -before, ..rest });
        assert_eq!((left.target, left.over), (-right.target, right.over));
        assert!(left.over >= 0.0 && (left.over - (left.target - now) / speed * 10.0).abs() < 1e-9);
        (left.target * 1e6).round() / 1e6
    }

    #[test]
    fn a_movement_that_slows_down_ends_where_it_comes_to_rest() {
        assert_eq!(leads_to(0.0, 0.6, 0.7, MOTORCYCLE), 0.18);
        assert_eq!(leads_to(-1.0, 0.6, 0.7, MOTORCYCLE), -0.82);
        // It has not slowed down: it was slower before, as fast, or moved to the other side.
        for before in [0.5, 0.6, -0.7] {
            assert_eq!(leads_to(0.0, 0.6, before, MOTORCYCLE), INSIDE);
        }
    }

    #[test]
    fn a_movement_in_steps_comes_to_rest_sooner() {
        // 0.4 m/s and 0.2 m/s for 0.2 s each.
        assert_eq!(leads_to(0.0, 0.6, 0.8, Movement { step: 0.2, ..MOTORCYCLE }), 0.12);
        assert_eq!(leads_to(-0.16, 0.6, 0.4, Movement { step: 0.2, ..MOTORCYCLE }), 0.0);
        assert_eq!(leads_to(0.0, 0.6, 0.8, Movement { step: 1.0, ..MOTORCYCLE }), 0.0);
    }

    #[test]
    fn a_movement_passes_the_centre_once_it_cannot_stop_there() {
        assert_eq!(leads_to(-0.6, 1.0, 1.0, MOTORCYCLE), 0.0);
        assert_eq!(leads_to(-0.4, 1.0, 1.0, MOTORCYCLE), INSIDE);
    }

    #[test]
    fn a_movement_leaves_the_lane_once_it_cannot_stop_inside() {
        assert_eq!(leads_to(0.5, 1.0, 1.0, MOTORCYCLE), INSIDE);
        assert_eq!(leads_to(0.7, 1.0, 1.0, MOTORCYCLE), 3.2);
        assert_eq!(leads_to(0.7, 1.0, 1.0, Movement { leads_to_a_lane: false, ..MOTORCYCLE }), INSIDE);
    }

    #[test]
    fn beside_a_bend_metres_are_those_of_the_middle() {
        // A quarter circle of 10 m about the origin, driven to the left, with 20 m before and behind it.
        let bend = (0..=18)
            .map(|part| f64::from(part) * FRAC_PI_2 / 18.0)
            .map(|at| Point::new(10.0 * at.cos(), 10.0 * at.sin()));
        let middle =
            [Point::new(10.0, -20.0)].into_iter().chain(bend).chain([Point::new(-20.0, 10.0)]).collect::<Vec<_>>();
        for aside in [1.0, -1.0, -3.0] {
            let mut beside = OffsetLine::new(Offset { now: aside, target: aside, over: 0.0, speed: 0.0 }).unwrap();
            let mut lines = Lines::through([]);
            beside.push_front(&mut lines, middle[0]);
            middle[1..].iter().for_each(|point| beside.push_ahead(&mut lines, *point));
            beside.flush(&mut lines);
            for vertex in lines.line(0) {
                // Where a ray through the centre of the bend meets the middle.
                let angle = vertex.point.y.atan2(vertex.point.x).clamp(0.0, FRAC_PI_2);
                let expected = 20.0 + vertex.point.y.min(0.0) + 10.0 * angle + (-vertex.point.x).max(0.0);
                // A vertex lies on the line that halves the corner of two pieces, half of 2.5° beside that ray.
                let corner = f64::abs(aside) * (FRAC_PI_2 / 72.0).tan();
                assert!((vertex.distance - expected).abs() < 0.005 + corner, "{aside}: {vertex:?} {expected}");
            }
        }
    }

    #[test]
    fn without_the_sublane_model_a_movement_is_a_lane_change() {
        let lanes = Movement { sublane: false, ..MOTORCYCLE };
        assert_eq!(leads_to(0.0, 0.6, 0.7, lanes), 3.2);
        assert_eq!(leads_to(-0.4, 1.0, 1.0, lanes), 0.0);
    }
}
