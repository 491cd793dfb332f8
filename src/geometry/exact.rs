//! Whether two rectangles touch, decided without error.
//!
//! The test is that of separating axes, first in f64 with a bound on the rounding error. Only where the bound leaves
//! the answer open is it computed in exact arithmetic (adaptive predicates, Shewchuk 1997).
//!
//! The corners of a rectangle follow exactly from its f64 centre, axis and half dimensions: the sides are at right
//! angles, but the axis need not have length 1.

use super::rectangle::Rectangle;
use super::{Vector, cross, left_of};
use crate::util::double_double::{two_product, two_sum};

/// Bound on the relative rounding error of the f64 form: about twenty operations, each with an error of 2⁻⁵³.
const ROUNDING: f64 = 32.0 * f64::EPSILON;
/// A factor above the rounding error of a square.
const SURELY_MORE: f64 = 1.0 + 1e-9;
/// Most terms that one axis needs: the distance of the centres and the reach of both rectangles.
const TERMS: usize = 40;

/// Whether two rectangles share a point; touching counts.
///
/// All four axes need only the products of the two rectangles' axes: the reach across one's side is that along it with
/// sine and cosine exchanged.
pub fn touches(a: &Rectangle, b: &Rectangle) -> bool {
    let between = b.centre - a.centre;
    let (cosine, sine) = (a.axis.dot(&b.axis).abs(), cross(&a.axis, &b.axis).abs());
    let (square_a, square_b) = (a.axis.norm_squared(), b.axis.norm_squared());
    let (along_a, across_a) = (between.dot(&a.axis).abs(), cross(&a.axis, &between).abs());
    let (along_b, across_b) = (between.dot(&b.axis).abs(), cross(&b.axis, &between).abs());
    let room = [
        along_a - (a.half_length * square_a + b.half_length * cosine + b.half_width * sine),
        across_a - (a.half_width * square_a + b.half_length * sine + b.half_width * cosine),
        along_b - (b.half_length * square_b + a.half_length * cosine + a.half_width * sine),
        across_b - (b.half_width * square_b + a.half_length * sine + a.half_width * cosine),
    ];
    let sizes = sizes(a, b);
    // The difference of the centres has a rounding error relative to its own size.
    let bound = ROUNDING * (between.x.abs() + between.y.abs() + 2.0 * sizes) * square_a.max(square_b).max(1.0);
    let widest = room[0].max(room[1]).max(room[2].max(room[3]));
    if widest.abs() > bound {
        return widest < 0.0;
    }
    let axes = [a.axis, left_of(&a.axis), b.axis, left_of(&b.axis)];
    axes.iter().zip(room).all(|(axis, room)| room < -bound || meet_along_exactly(a, b, axis))
}

/// Whether two rectangles are too far apart to touch, whatever their headings. Faster than [`touches`] where most pairs
/// are far apart; wasted where they are not.
pub(crate) fn are_far_apart(a: &Rectangle, b: &Rectangle) -> bool {
    let (sizes, longer_axis) = (sizes(a, b), a.axis.norm_squared().max(b.axis.norm_squared()));
    (b.centre - a.centre).norm_squared() > sizes * sizes * longer_axis * SURELY_MORE
}

/// More than the reach of both from their centres together, in lengths of the longer axis.
fn sizes(a: &Rectangle, b: &Rectangle) -> f64 {
    a.half_length + a.half_width + b.half_length + b.half_width
}

fn meet_along_exactly(a: &Rectangle, b: &Rectangle, axis: &Vector) -> bool {
    let mut sum = Sum::default();
    let centres = [(a.centre.x, b.centre.x, axis.x), (a.centre.y, b.centre.y, axis.y)];
    let between = |sum: &mut Sum, sign: f64| {
        for (from, to, factor) in centres {
            let difference = two_sum(to, -from);
            sum.add_product(sign * factor, difference.0);
            sum.add_product(sign * factor, difference.1);
        }
    };
    let mut distance = Sum::default();
    between(&mut distance, 1.0);
    // |distance| − reach of both ≤ 0
    between(&mut sum, distance.sign());
    for rectangle in [a, b] {
        for (side, half) in [(rectangle.axis, rectangle.half_length), (left_of(&rectangle.axis), rectangle.half_width)]
        {
            let mut along = Sum::default();
            along.add_product(side.x, axis.x);
            along.add_product(side.y, axis.y);
            let sign = along.sign();
            for term in along.terms() {
                sum.add_product(-sign * half, *term);
            }
        }
    }
    sum.sign() <= 0.0
}

/// An exact sum of f64 as an expansion: terms that do not overlap, smallest first.
struct Sum {
    terms: [f64; TERMS],
    count: usize,
}

impl Default for Sum {
    fn default() -> Self {
        Self { terms: [0.0; TERMS], count: 0 }
    }
}

impl Sum {
    fn terms(&self) -> &[f64] {
        &self.terms[..self.count]
    }

    /// Shewchuk's Grow-Expansion, without the zeros.
    fn add(&mut self, value: f64) {
        let mut carry = value;
        let mut kept = 0;
        for index in 0..self.count {
            let (high, low) = two_sum(carry, self.terms[index]);
            if low != 0.0 {
                self.terms[kept] = low;
                kept += 1;
            }
            carry = high;
        }
        if carry != 0.0 {
            self.terms[kept] = carry;
            kept += 1;
        }
        self.count = kept;
    }

    fn add_product(&mut self, a: f64, b: f64) {
        let (high, low) = two_product(a, b);
        self.add(low);
        self.add(high);
    }

    /// −1, 0 or 1: the sign of the largest term.
    fn sign(&self) -> f64 {
        self.terms().last().map_or(0.0, |largest| largest.signum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use num_rational::BigRational;
    use num_traits::Signed;
    use proptest::prelude::*;

    fn exact(value: f64) -> BigRational {
        BigRational::from_float(value).unwrap()
    }

    /// The definition, in rational arithmetic.
    fn reference(a: &Rectangle, b: &Rectangle) -> bool {
        let dot = |u: &Vector, v: &Vector| exact(u.x) * exact(v.x) + exact(u.y) * exact(v.y);
        [a.axis, left_of(&a.axis), b.axis, left_of(&b.axis)].iter().all(|axis| {
            let between = (exact(b.centre.x) - exact(a.centre.x)) * exact(axis.x)
                + (exact(b.centre.y) - exact(a.centre.y)) * exact(axis.y);
            let reach = |r: &Rectangle| {
                dot(&r.axis, axis).abs() * exact(r.half_length)
                    + dot(&left_of(&r.axis), axis).abs() * exact(r.half_width)
            };
            between.abs() <= reach(a) + reach(b)
        })
    }

    /// A second rectangle that touches the front of the first to within some units in the last place.
    fn nearly_touching(a: &Rectangle, heading: f64, length: f64, width: f64, nudge: i32) -> Rectangle {
        let mut b = Rectangle::new(a.centre, heading, length, width);
        let reach = a.half_length
            + b.half_length * a.axis.dot(&b.axis).abs()
            + b.half_width * a.axis.dot(&left_of(&b.axis)).abs();
        let x = a.centre.x + a.axis.x * reach;
        b.centre = Point::new(x * (1.0 + f64::from(nudge) * f64::EPSILON), a.centre.y + a.axis.y * reach);
        b
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]
        #[test]
        fn no_decision_is_wrong_at_contact_to_the_last_place(
            x in -1e7..1e7, y in -1e3..1e3, heading in -4.0..4.0, turn in prop_oneof![Just(0.0), Just(1e-16), -4.0..4.0],
            length in 0.0..20.0, width in 0.0..3.0, other in 0.001..100.0, nudge in -4..=4,
        ) {
            let a = Rectangle::new(Point::new(x, y), heading, length, width);
            let b = nearly_touching(&a, heading + turn, other, width, nudge);
            let truth = reference(&a, &b);
            prop_assert_eq!(touches(&a, &b), truth);
            prop_assert_eq!(touches(&b, &a), truth);
        }

        #[test]
        fn random_pairs_are_decided_as_in_rational_arithmetic(
            x in -15.0..15.0, y in -10.0..10.0, heading in -4.0..4.0, turn in -4.0..4.0,
        ) {
            let a = Rectangle::new(Point::origin(), heading, 5.0, 1.8);
            let b = Rectangle::new(Point::new(x, y), heading + turn, 12.0, 2.5);
            let truth = reference(&a, &b);
            prop_assert_eq!(touches(&a, &b), truth);
            prop_assert!(!(are_far_apart(&a, &b) && truth));
        }
    }

    #[test]
    fn what_plain_separating_axes_get_wrong_is_right_here() {
        let wrong = (0..5_000_u32).filter(|number| {
            let heading = f64::from(*number) * 4e-4;
            let a = Rectangle::new(Point::new(0.3, 0.2), heading, 5.0, 1.8);
            let b = nearly_touching(&a, heading * 3.0, 4.0, 2.0, 0);
            let truth = reference(&a, &b);
            assert_eq!(touches(&a, &b), truth);
            crate::geometry::contact::plainly_touches(&a, &b) != truth
        });
        assert!(wrong.count() > 100);
    }
}
