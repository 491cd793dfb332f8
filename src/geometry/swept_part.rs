//! A movement or a part of one, with what bisection needs of it, computed once.

use super::convex::ConvexOutline;
use super::movement::Movement;
use super::polygon::Polygon;
use super::rectangle::Rectangle;
use super::separating_axes::{Contact, ContactInterval, translation};
use super::{Bounds, Vector};
use crate::util::units::Metre;

/// An upper bound on rounding errors, in m.
const ROUNDING: Metre = 1e-6;

/// No part is halved more often, so that no values, NaN included, make the search deep. The longest road user, which turns
/// round within one movement, needs 20 halvings.
const MOST_HALVINGS: u8 = 24;

/// A movement or a part of one.
#[derive(Clone, Copy, Debug)]
pub(super) struct SweptPart {
    pub movement: Movement,
    /// The axes of the first and the last rectangle, normalised.
    axes: [Vector; 2],
    pub bounds: Bounds,
    turn: f64,
    /// Index of its hull, once it is computed.
    hull: Option<u32>,
    /// The axis of the rectangle in the middle, once it is computed.
    middle: Option<Vector>,
    /// Index of the first half, once the part is halved; the second half follows it.
    pub halves: Option<u32>,
    /// How many times a movement was halved for it.
    halvings: u8,
}

impl SweptPart {
    pub fn new(movement: Movement) -> Self {
        let [first, last] = [movement.rectangle(0.0), movement.rectangle(1.0)];
        let mut bounds = first.bounds();
        bounds.join(&last.bounds());
        let turn = (movement.to_axis - movement.from_axis).norm();
        Self {
            movement,
            axes: [first.axis, last.axis],
            bounds,
            turn,
            hull: None,
            middle: None,
            halves: None,
            halvings: 0,
        }
    }

    /// A convex polygon around the area that the part covers.
    pub fn hull<'a>(&mut self, hulls: &'a mut Vec<Polygon>) -> &'a Polygon {
        let index = *self.hull.get_or_insert_with(|| {
            hulls.push(self.movement.hull().into());
            hulls.len() as u32 - 1
        });
        &hulls[index as usize]
    }

    fn middle(&mut self) -> Vector {
        *self.middle.get_or_insert_with(|| self.movement.rectangle(0.5).axis)
    }

    /// Its contact with a convex area if its middle rectangle is translated instead of turned.
    pub(crate) fn slide_to(&mut self, fixed: &ConvexOutline) -> Option<ContactInterval> {
        let axis = self.middle();
        let Movement { from, to, length, width, .. } = self.movement;
        let by = to - from;
        let middle = Rectangle::behind(from + by * 0.5, axis, length, width);
        let start = Rectangle { centre: middle.centre - by * 0.5, ..middle };
        translation(&ConvexOutline::rectangle(&start), &by, fixed)
    }

    /// The part of that translation in which a contact would be better than the known one.
    pub(crate) fn slide_before(&mut self, which: Contact, known: f64) -> Self {
        let axis = self.middle();
        let Movement { from, to, .. } = self.movement;
        let at = from + (to - from) * known;
        let (from, to) = if which == Contact::Entry { (from, at) } else { (at, to) };
        Self::new(Movement { from, from_axis: axis, to, to_axis: axis, ..self.movement })
    }

    pub(crate) fn halve(&mut self) -> [Self; 2] {
        let middle = self.middle();
        let Movement { from, to, .. } = self.movement;
        let at = |part| from + (to - from) * part;
        let first = Movement { from: at(0.0), from_axis: self.axes[0], to: at(0.5), to_axis: middle, ..self.movement };
        let second = Movement { from: at(0.5), from_axis: middle, to: at(1.0), to_axis: self.axes[1], ..self.movement };
        [first, second].map(|half| Self { halvings: self.halvings + 1, ..Self::new(half) })
    }

    /// Whether its hull reaches beyond the area that it covers by no more than a tolerance.
    pub fn fits(&self, tolerance: Metre) -> bool {
        self.excess() <= tolerance || self.halvings >= MOST_HALVINGS
    }

    /// Whether a translation along the middle direction takes its corners where the movement does, to a tolerance.
    pub fn is_straight(&self, tolerance: Metre) -> bool {
        self.bend() <= tolerance || self.halvings >= MOST_HALVINGS
    }

    /// How far the hull reaches beyond the area that the movement covers: on the inner side of a turn the hull cuts the
    /// corner between the sides of the first and the last rectangle.
    fn excess(&self) -> Metre {
        self.turn * self.movement.length / 4.0
    }

    /// How far the turn takes a corner from where a translation along the middle direction would take it.
    fn bend(&self) -> Metre {
        self.turn * (self.movement.length + self.movement.width) / 2.0
    }

    /// How far the hull of a half may reach beyond the hull of the whole: an arc beyond its chord.
    pub(crate) fn stray(&self) -> Metre {
        self.turn * self.turn / 3.0 * (self.movement.length + self.movement.width) + ROUNDING
    }
}
