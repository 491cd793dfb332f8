//! The path between two poses of a road user: the arc on which its heading turns evenly.
//!
//! A step of 1 s at 15 m/s in a bend of 50 m leaves the straight line by 0.6 m.

use std::f64::consts::PI;

use super::{Point, Vector};
use crate::util::units::{Metre, Radian};

/// The way of a front bumper from one place to the next: a parabola as deep as the arc, within 3 % of it up to 1 rad.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bow {
    from: Point,
    /// To where it ends.
    moved: Vector,
    /// From the middle of the straight line to that of the arc.
    aside: Vector,
    /// By how much the heading turns, −π to π; to the left above 0.
    pub turn: Radian,
}

impl Bow {
    /// Between two places with these headings there.
    pub fn new([from, to]: [Point; 2], headings: [Radian; 2]) -> Self {
        let turn = (headings[1] - headings[0] + PI).rem_euclid(2.0 * PI) - PI;
        let moved = to - from;
        // Turning left it first goes more to the right: an arc of this angle is tan(turn / 4) / 2 of its chord deep.
        let aside = Vector::new(moved.y, -moved.x) * ((turn / 4.0).tan() / 2.0);
        Self { from, moved, aside, turn }
    }

    /// How far it leaves the straight line.
    pub fn depth(&self) -> Metre {
        self.aside.norm()
    }

    /// The place after a part of the way, 0 to 1.
    pub fn at(&self, part: f64) -> Point {
        self.from + self.moved * part + self.aside * (4.0 * part * (1.0 - part))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::rectangle::direction;

    proptest! {
        #[test]
        fn a_bow_follows_the_arc(radius in 5.0..500.0, turn in -1.0..1.0_f64, heading in -4.0..4.0, round in -1..2_i32) {
            let centre = |part: f64| {
                // The place on a circle to the left or right of the origin, after this part of the turn.
                let radius = radius * turn.signum();
                let normal = |angle: f64| Vector::new(-angle.sin(), angle.cos());
                Point::origin() + normal(heading) * radius - normal(heading + turn * part) * radius
            };
            let end = heading + turn + 2.0 * PI * f64::from(round);
            let bow = Bow::new([centre(0.0), centre(1.0)], [heading, end]);
            prop_assert!((bow.turn - turn).abs() < 1e-9);
            let length = radius * turn.abs();
            prop_assert!((bow.at(0.5) - centre(0.5)).norm() < 1e-9 * radius);
            for part in [0.0, 0.2, 0.8, 1.0] {
                prop_assert!((bow.at(part) - centre(part)).norm() < 0.01 * length);
            }
        }
    }

    #[test]
    fn without_a_turn_the_way_is_straight() {
        let to = direction(0.3) * 10.0;
        let bow = Bow::new([Point::origin(), Point::from(to)], [0.3, 0.3]);
        assert_eq!(bow.depth(), 0.0);
        assert!((bow.at(0.25).coords - to * 0.25).norm() < 1e-12);
    }
}
