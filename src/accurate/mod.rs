//! Phase 2, accurate: where two road users would meet, and by the angle there of which kind that is.
//!
//! Two that drive straight on, side by side or in line, are a matter of one dimension: [`rear_end`] where they drive
//! the same way, [`frontal`] where they drive towards each other. All others are swept: [`side`]. The paper's own
//! tests are in [`paper`].

pub mod frontal;
pub mod paper;
pub mod rear_end;
pub mod side;

use crate::braking::{self, Brakes, Braking, MuModel};
use crate::encounter::Kind;
use crate::geometry::halves::Halves;
use crate::geometry::polygon::Polygon;
use crate::geometry::rectangle::{Rectangle, plainly_touches};
use crate::geometry::sweep::TOLERANCE;
use crate::geometry::{Bounds, Point, Vector, cross};
use crate::options::Options;
use crate::path::Pose;
use crate::units::{Metre, MetrePerSecond, Radian};

/// Two straight paths are parallel where they deviate by less than this over their length, in m.
const PARALLEL: Metre = 1e-3;

/// What a road user covers between two poses, in boxes that decide quickly where nothing meets.
#[derive(Clone, Copy, Debug)]
pub struct Cover {
    /// The axis-parallel box around it.
    pub bounds: Bounds,
    /// The box along the way: narrow, whichever way that leads.
    pub around: Rectangle,
}

impl Cover {
    /// The boxes around a road user of this length and width at all these poses and between; none of no pose.
    ///
    /// Between two poses it may leave the hull of both by less than the sweep's tolerance.
    pub fn of(poses: &[Pose], length: Metre, width: Metre) -> Option<Self> {
        let rectangles = || poses.iter().map(|pose| Rectangle::behind(pose.front, pose.axis, length, width));
        let mut bounds = Bounds::EMPTY;
        for rectangle in rectangles() {
            bounds.join(&rectangle.bounds());
        }
        let (first, last) = (poses.first()?, poses.last()?);
        let rear = first.front - first.axis * length;
        let axis = (last.front - rear).try_normalize(0.0).unwrap_or(first.axis);
        let around = Rectangle::around(axis, rectangles(), TOLERANCE)?;
        Some(Self { bounds: bounds.grown(TOLERANCE), around })
    }

    /// The same around one that goes straight on from one pose to another, with the box that is known.
    pub fn straight(first: &Pose, last: &Pose, length: Metre, width: Metre, bounds: Bounds) -> Self {
        let now = Rectangle::behind(first.front, first.axis, length, width);
        let around = now.swept(&(last.front - first.front), TOLERANCE);
        Self { bounds, around }
    }

    /// Whether the boxes of two meet.
    pub fn meets(&self, other: &Self) -> bool {
        self.bounds.meet(&other.bounds) && plainly_touches(&self.around, &other.around)
    }
}

impl Cover {
    /// What meets nothing.
    pub const NOWHERE: Self = Self {
        bounds: Bounds::EMPTY,
        around: Rectangle {
            centre: Point::new(0.0, 0.0),
            axis: Vector::new(1.0, 0.0),
            half_length: 0.0,
            half_width: 0.0,
        },
    };
    /// What meets everything: nothing is left out.
    pub const EVERYWHERE: Self = Self {
        bounds: Bounds::EVERYTHING,
        around: Rectangle {
            centre: Point::new(0.0, 0.0),
            axis: Vector::new(1.0, 0.0),
            half_length: 1e12,
            half_width: 1e12,
        },
    };
}

impl From<Bounds> for Cover {
    fn from(bounds: Bounds) -> Self {
        Self { bounds, around: bounds.into() }
    }
}

/// One road user of a pair: what phase 2 needs to know of it.
#[derive(Clone, Copy, Debug)]
pub struct Mover<'a> {
    /// The rectangle of now.
    pub rectangle: Rectangle,
    /// Convex parts of an obstacle; empty for all others.
    pub shape: &'a [Polygon],
    /// Poses from now until it stands and ε further; may be left out of who drives in line.
    pub poses: &'a [Pose],
    /// Whether it drives straight on all the way.
    pub straight: bool,
    /// How far ahead its path is known to go: S + ε, or less where the path ends.
    pub reach: Metre,
    /// The boxes around all that it covers on the way.
    pub cover: &'a Cover,
    /// The same from each pose to the next; none of who drives straight on, where a part is hardly smaller than the whole.
    pub covers: &'a [Cover],
    /// Speed in m/s.
    pub speed: MetrePerSecond,
    /// How it brakes.
    pub brakes: &'a Brakes,
    /// Its stopping distance.
    pub stop: Metre,
}

impl Mover<'_> {
    /// Length in m.
    pub fn length(&self) -> Metre {
        2.0 * self.rectangle.half_length
    }

    /// Width in m.
    pub fn width(&self) -> Metre {
        2.0 * self.rectangle.half_width
    }

    /// Its part in μ.
    pub fn braking(&self) -> Braking<'_> {
        Braking { speed: self.speed, brakes: self.brakes }
    }
}

/// Where an ego meets a foe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// Way of the ego to the meeting place.
    pub ego_way: Metre,
    /// Way of the foe until it is there.
    pub foe_way: Metre,
    /// The ego's rectangle there.
    pub ego: Rectangle,
    /// The foe's axis there; none for an obstacle, which the ego meets with its front.
    pub foe_axis: Option<Vector>,
    /// Whether the foe is out of the way as soon as it moves: a leader in the lane.
    pub leads: bool,
}

impl Meeting {
    /// The angle α between the two headings.
    pub fn angle(&self) -> Radian {
        match self.foe_axis {
            Some(axis) => angle_between(&self.ego.axis, &axis),
            None => std::f64::consts::PI,
        }
    }

    /// The ego's front-bumper centre.
    pub fn place(&self) -> Point {
        self.ego.centre + self.ego.axis * self.ego.half_length
    }
}

/// Where a pair meets that does not touch now, and whether the first of it is the ego: the one with the longer way,
/// of equal ones the first if `a_is_smaller` says that its id is.
pub fn meet(a: &Mover, b: &Mover, a_is_smaller: &impl Fn() -> bool) -> Option<(bool, Meeting)> {
    if drive_in_line(a, b) {
        meet_in_one_dimension(a, b, a_is_smaller)
    } else {
        side::meet(&mut Halves::default(), a, b, false, a_is_smaller)
    }
}

/// Whether both drive straight on, side by side or in line.
pub fn drive_in_line(a: &Mover, b: &Mover) -> bool {
    if !a.straight || !b.straight || !a.shape.is_empty() || !b.shape.is_empty() {
        return false;
    }
    lead_alike([&a.rectangle.axis, &b.rectangle.axis], [a.stop + a.length(), b.stop + b.length()])
}

/// Whether two axes lead so much the same way, or the opposite one, that over neither of these lengths they deviate.
pub fn lead_alike([a, b]: [&Vector; 2], [length, other]: [Metre; 2]) -> bool {
    cross(a, b).abs() * length.max(other) <= PARALLEL
}

/// Whether two that drive in line drive towards each other, or away from each other.
pub fn drive_opposed(a: &Mover, b: &Mover) -> bool {
    a.rectangle.axis.dot(&b.rectangle.axis) <= 0.0
}

/// Where two that drive in line meet; `true` where the first of them is the ego.
pub fn meet_in_one_dimension(a: &Mover, b: &Mover, a_is_smaller: &impl Fn() -> bool) -> Option<(bool, Meeting)> {
    let axis = a.rectangle.axis;
    let between = b.rectangle.centre - a.rectangle.centre;
    if cross(&axis, &between).abs() > a.rectangle.half_width + b.rectangle.half_width {
        return None;
    }
    let along = between.dot(&axis);
    let ahead = along.abs() - a.rectangle.half_length - b.rectangle.half_length;
    if !drive_opposed(a, b) {
        let (ego_is_a, ego, foe) = if along > 0.0 { (true, a, b) } else { (false, b, a) };
        rear_end::in_line(ego, foe, ahead).map(|meeting| (ego_is_a, meeting))
    } else if along > 0.0 {
        frontal::in_line(a, b, ahead, a_is_smaller)
    } else {
        None
    }
}

/// The angle between two directions, 0 to π.
pub fn angle_between(a: &Vector, b: &Vector) -> Radian {
    let (across, along) = (cross(a, b).abs(), a.dot(b));
    // What atan2 says of 0, without asking it: most who follow each other head exactly the same way.
    if across == 0.0 && along > 0.0 { 0.0 } else { across.atan2(along) }
}

/// σ = cos α.
pub fn sigma(angle: Radian) -> f64 {
    if angle == 0.0 { 1.0 } else { angle.cos() }
}

/// The kind of a conflict at this angle.
pub fn kind_at(angle: Radian, options: &Options) -> Kind {
    if angle < options.rear_end_below {
        Kind::RearEnd
    } else if angle > options.frontal_above {
        Kind::Frontal
    } else {
        Kind::Side
    }
}

/// The room that is left: max(way_ego − σ·way_foe, 0).
pub fn gap(ego_way: Metre, foe_way: Metre, sigma: f64) -> Metre {
    (ego_way - sigma * foe_way).max(0.0)
}

/// The minimal collision distance of a pair.
pub fn mu(model: MuModel, ego: &Mover, foe: &Mover, sigma: f64, epsilon: Metre) -> Metre {
    braking::mu(model, ego.braking(), foe.braking(), sigma, epsilon)
}
