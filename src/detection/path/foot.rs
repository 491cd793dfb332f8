//! The point of a lane's centre line nearest to a front bumper.

use crate::geometry::polylines::{Vertex, scale};
use crate::geometry::{Point, Vector, cross};
use crate::util::units::Metre;

/// A front bumper further than this from its lane's position hint is looked for on the whole lane, in m.
const NEAR_HINT: Metre = 5.0;

/// The point of a lane's centre line nearest to a front bumper.
pub struct Foot {
    /// The point.
    pub point: Point,
    /// The segment of the centre line that it is on.
    pub segment: usize,
    /// Distance from the lane's beginning.
    pub distance: Metre,
    /// Along the lane, for each metre of it.
    pub direction: Vector,
    /// Offset of the front bumper, positive to the left.
    pub aside: Metre,
}

impl Foot {
    /// Looks near the distance `hint` first.
    pub fn of(line: &[Vertex], front: Point, hint: Metre) -> Self {
        let best = Self::nearest(line, front, |start, end| start <= hint + NEAR_HINT && end >= hint - NEAR_HINT);
        best.unwrap_or_else(|| Self::on_any_part(line, front))
    }

    /// Looks on the whole lane.
    pub fn on_any_part(line: &[Vertex], front: Point) -> Self {
        Self::nearest(line, front, |_, _| true).unwrap_or(Self {
            point: front,
            segment: 0,
            distance: 0.0,
            direction: Vector::x(),
            aside: 0.0,
        })
    }

    fn nearest(line: &[Vertex], front: Point, wanted: impl Fn(Metre, Metre) -> bool) -> Option<Self> {
        let mut best: Option<(f64, Self)> = None;
        for (segment, ends) in line.windows(2).enumerate() {
            let [start, end] = [&ends[0], &ends[1]];
            let length = end.distance - start.distance;
            if !wanted(start.distance, end.distance) {
                continue;
            }
            let direction = (end.point - start.point) / length;
            let scale = scale(&direction);
            let along = ((front - start.point).dot(&direction) / (scale * scale)).clamp(0.0, length);
            let point = start.point + direction * along;
            let squared = (front - point).norm_squared();
            if best.as_ref().is_none_or(|(least, _)| squared < *least) {
                let aside = cross(&direction, &(front - point)) / scale;
                best = Some((squared, Self { point, segment, distance: start.distance + along, direction, aside }));
            }
        }
        best.map(|(_, foot)| foot)
    }
}
