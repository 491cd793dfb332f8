//! Polylines, all in one table: their points, and the distance of each from the beginning of its line.
//!
//! A line may be stretched: its distances are then not those of the plane. SUMO drives along a lane in metres of the
//! lane's attribute `length`, which may differ from the length of the lane's shape, and beside the lane's middle in
//! metres of the middle.

use super::{Point, Vector};
use crate::util::units::Metre;

/// A point nearer than this to a line is on it, in m.
pub(crate) const ON_THE_LINE: Metre = 1e-3;

/// A point of a line and its distance from the line's beginning.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// Where it is.
    pub point: Point,
    /// Along the line, in m.
    pub distance: Metre,
}

/// The square of the metres of the plane per metre along a line that differs from 1 by less than this is 1: distances are
/// rounded to 1e-12 m and segments are a millimetre long or more. A lane that is stretched is so by far more.
const TO_SCALE: f64 = 1e-8;

/// The lengths of two lines beside each other differ by at most this factor: inside a narrow bend.
const MOST_BESIDE: f64 = 4.0;

/// Lines, numbered from 0, each with its vertices one after the other.
#[derive(Clone, Debug)]
pub struct Lines {
    vertices: Vec<Vertex>,
    /// First vertex of each line, then the end of the last line.
    begins: Vec<u32>,
    /// Metres along the line per metre of the plane, for the points that follow.
    stretch: f64,
    /// The most so far, and at least 1.
    most_stretch: f64,
    /// Whether any line is stretched.
    is_stretched: bool,
}

impl Default for Lines {
    fn default() -> Self {
        Self::NONE.clone()
    }
}

impl Lines {
    /// No lines.
    pub const NONE: &'static Self =
        &Self { vertices: Vec::new(), begins: Vec::new(), stretch: 1.0, most_stretch: 1.0, is_stretched: false };

    /// One line through these points.
    pub fn through(points: impl IntoIterator<Item = Point>) -> Self {
        let mut lines = Self::default();
        lines.begin();
        points.into_iter().for_each(|point| lines.push(point));
        lines
    }

    /// Begins another line.
    pub fn begin(&mut self) {
        let end = self.vertices.len() as u32;
        if self.begins.is_empty() {
            self.begins.push(end);
        }
        self.begins.push(end);
    }

    /// Removes all lines, and begins one anew; keeps the memory.
    pub(crate) fn restart(&mut self) {
        self.vertices.clear();
        self.begins.clear();
        self.begin();
    }

    /// Sets how many metres along the line a metre of the plane is, for the points that follow.
    pub fn set_stretch(&mut self, stretch: f64) {
        self.stretch = stretch;
        self.most_stretch = self.most_stretch.max(stretch);
        self.is_stretched |= stretch != 1.0;
    }

    /// How many metres along the line a metre of the plane is, for the points that follow.
    pub fn stretch(&self) -> f64 {
        self.stretch
    }

    /// Whether any of the lines is stretched.
    pub(crate) fn is_stretched(&self) -> bool {
        self.is_stretched
    }

    /// The most metres along a line that a metre of the plane is; at least 1.
    pub(crate) fn most_stretch(&self) -> f64 {
        self.most_stretch
    }

    /// Appends a point to the last line, unless it lies within a millimetre of the point before.
    pub fn push(&mut self, point: Point) {
        self.push_after(point, |step| step);
    }

    /// The same of a line beside another, along which it is this far from the point before. Returns how much of that is
    /// left for the next point.
    pub(crate) fn push_beside(&mut self, point: Point, along: Metre) -> Metre {
        let mut rest = along;
        self.push_after(point, |step| {
            let shift = along.clamp(step / MOST_BESIDE, step * MOST_BESIDE);
            rest -= shift;
            shift
        });
        rest
    }

    /// Appends a point; `shift` is how far it is along the line from the point before, for a step of the plane.
    fn push_after(&mut self, point: Point, shift: impl FnOnce(Metre) -> Metre) {
        let [.., begin, end] = &mut self.begins[..] else { return };
        let distance = match self.vertices[*begin as usize..].last() {
            Some(last) => {
                let step = (point - last.point).norm();
                if step < ON_THE_LINE {
                    return;
                }
                let shift = shift(step) * self.stretch;
                self.most_stretch = self.most_stretch.max(shift / step);
                last.distance + shift
            }
            None => 0.0,
        };
        self.vertices.push(Vertex { point, distance });
        *end += 1;
    }

    /// Allocates exactly the memory for this many further points.
    pub(crate) fn reserve(&mut self, points: usize) {
        self.vertices.reserve_exact(points);
    }

    /// Frees unused memory.
    pub fn shrink(&mut self) {
        self.vertices.shrink_to_fit();
        self.begins.shrink_to_fit();
    }

    /// Number of lines.
    pub fn count(&self) -> u32 {
        self.begins.len().saturating_sub(1) as u32
    }

    /// Number of vertices of all lines.
    pub(crate) fn len(&self) -> usize {
        self.vertices.len()
    }

    /// First vertex of a line, and one past its last.
    pub(crate) fn range(&self, line: u32) -> (u32, u32) {
        (self.begins[line as usize], self.begins[line as usize + 1])
    }

    /// The vertices of a line.
    pub fn line(&self, line: u32) -> &[Vertex] {
        let (begin, end) = self.range(line);
        &self.vertices[begin as usize..end as usize]
    }

    /// Length of a line in m.
    pub fn length(&self, line: u32) -> Metre {
        self.line(line).last().map_or(0.0, |last| last.distance)
    }

    /// Whether `next` begins exactly where `line` ends.
    pub(crate) fn join(&self, line: u32, next: u32) -> bool {
        match (self.line(line), self.line(next)) {
            ([_, .., end], [begin, _, ..]) => end.point == begin.point,
            _ => false,
        }
    }

    /// The segment that begins at a vertex, which is not the last of its line.
    pub(crate) fn segment(&self, vertex: u32) -> Segment {
        Segment::between(&self.vertices[vertex as usize], &self.vertices[vertex as usize + 1])
    }

    /// Removes the first vertices of the only line, and returns the length that was cut off.
    pub(crate) fn cut(&mut self, vertices: usize) -> Metre {
        self.vertices.drain(..vertices);
        self.begins[1] = self.vertices.len() as u32;
        let shift = self.vertices.first().map_or(0.0, |first| first.distance);
        self.vertices.iter_mut().for_each(|vertex| vertex.distance -= shift);
        shift
    }
}

/// A straight part of a line, between two vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment {
    pub start: Point,
    /// Along the line, for each metre of it.
    pub direction: Vector,
    /// Distance of its start from the line's beginning.
    pub begins_at: Metre,
    /// Distance of its end from the line's beginning.
    pub ends_at: Metre,
}

impl Segment {
    #[inline]
    fn between(start: &Vertex, end: &Vertex) -> Self {
        let length = end.distance - start.distance;
        let direction = (end.point - start.point) / length;
        Self { start: start.point, direction, begins_at: start.distance, ends_at: end.distance }
    }

    /// Distance of a front bumper from the line's beginning, if it is on this segment.
    pub(crate) fn distance_of(&self, front: Point) -> Option<Metre> {
        let along = (front - self.start).dot(&self.direction) / self.scale_squared();
        let aside = (front - (self.start + self.direction * along)).norm_squared();
        let is_on =
            along <= self.ends_at - self.begins_at && along >= -ON_THE_LINE && aside <= ON_THE_LINE * ON_THE_LINE;
        is_on.then_some(self.begins_at + along.max(0.0))
    }

    /// Metres of the plane per metre of the line; exactly 1 where they are the same up to rounding.
    pub fn scale(&self) -> f64 {
        scale(&self.direction)
    }

    /// Whether a metre of the line is one of the plane.
    pub(crate) fn is_to_scale(&self) -> bool {
        self.scale_squared() == 1.0
    }

    fn scale_squared(&self) -> f64 {
        scale_squared(&self.direction)
    }

    /// The point at a distance from the line's beginning; beyond the segment's ends, straight on.
    pub fn at(&self, distance: Metre) -> Point {
        self.start + self.direction * (distance - self.begins_at)
    }
}

/// The length of a segment's direction; exactly 1 where it is 1 up to rounding.
pub(crate) fn scale(direction: &Vector) -> f64 {
    scale_squared(direction).sqrt()
}

/// The square of [`scale`].
fn scale_squared(direction: &Vector) -> f64 {
    let squared = direction.norm_squared();
    if (squared - 1.0).abs() < TO_SCALE { 1.0 } else { squared }
}

/// How many metres along a line of this length a metre of its shape is: 1 unless the two differ by more than rounding.
pub fn stretch(length: Metre, drawn: Metre) -> f64 {
    /// The least difference in m: netconvert rounds lengths and the points of shapes to a centimetre.
    const ROUNDED: Metre = 0.02;
    let differs = (length - drawn).abs() > ROUNDED;
    if differs && drawn > 0.0 && length > 0.0 { length / drawn } else { 1.0 }
}
