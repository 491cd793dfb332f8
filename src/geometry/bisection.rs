//! Where moving rectangles touch: movements are halved until each part hardly turns.
//!
//! The last parts of the one movement are treated as translations, those of the other as hulls ([`super::movement`]). A
//! hull that is not touched leaves out all its parts. Parts, boxes and hulls are kept, so that a later query (another
//! movement, the other direction, the last contact after the first) finds them computed.
//!
//! A half may reach a little beyond the hull of the whole, by the arc beyond its chord. A hull therefore leaves out
//! only what stays clear of it by more than that, and the result equals that of trying all parts, to the last bit.

use super::Bounds;
use super::convex::ConvexOutline;
use super::movement::{Movement, TOLERANCE};
use super::polygon::Polygon;
use super::rectangle::Rectangle;
use super::separating_axes::{Contact, outlines_touch};
use super::swept_part::SweptPart;
use crate::util::units::Metre;

/// Capacity, in parts and in hulls, of an instance that is kept between simulation steps: what the fine sweep of two that
/// follow each other on an arc needs.
const KEPT: usize = 4096;

/// Identifies a movement in a [`Bisection`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part(u32);

/// Movements, and the halves that they have been cut into so far. Reuse one instance to keep its allocations; each
/// query first clears the previous one's movements.
#[derive(Clone, Debug)]
pub struct Bisection {
    /// How exactly movements are swept, in m.
    tolerance: Metre,
    parts: Vec<SweptPart>,
    /// The hulls that have been computed.
    hulls: Vec<Polygon>,
    /// The movements that were added by number.
    numbered: Vec<Option<Part>>,
}

impl Default for Bisection {
    fn default() -> Self {
        Self { tolerance: TOLERANCE, parts: Vec::new(), hulls: Vec::new(), numbered: Vec::new() }
    }
}

impl Bisection {
    /// An instance to be kept between simulation steps: its capacity is allocated at once and does not grow with the
    /// traffic.
    pub fn to_keep() -> Self {
        let mut kept = Self::default();
        kept.parts.reserve(KEPT);
        kept.hulls.reserve(KEPT);
        kept.numbered.reserve(KEPT);
        kept
    }

    /// Sweeps to this tolerance from now on; movements that were added stay, and are cut further where they have to be.
    pub fn sweep_to(&mut self, tolerance: Metre) {
        self.tolerance = tolerance;
    }

    /// How far apart two rectangles may be where the sweep of both finds contact, in m.
    pub(crate) fn inexact(&self) -> Metre {
        2.0 * self.tolerance
    }

    /// Removes all movements; new ones are swept to [`TOLERANCE`].
    pub fn clear(&mut self) {
        self.tolerance = TOLERANCE;
        self.parts.clear();
        self.hulls.clear();
        self.numbered.clear();
    }

    /// Removes all movements, and frees the memory that only rare pairs need.
    pub fn shrink(&mut self) {
        self.clear();
        self.parts.shrink_to(KEPT);
        self.hulls.shrink_to(KEPT);
        self.numbered.shrink_to(KEPT);
    }

    /// Adds a movement.
    pub fn add(&mut self, movement: Movement) -> Part {
        self.parts.push(SweptPart::new(movement));
        Part(self.parts.len() as u32 - 1)
    }

    /// The movement with this number, added on first use.
    pub fn numbered(&mut self, number: usize, movement: impl FnOnce() -> Movement) -> Part {
        if self.numbered.len() <= number {
            self.numbered.resize(number + 1, None);
        }
        if let Some(known) = self.numbered[number] {
            return known;
        }
        let added = self.add(movement());
        self.numbered[number] = Some(added);
        added
    }

    /// The box around the area that a movement covers.
    pub fn bounds(&self, part: Part) -> &Bounds {
        &self.parts[part.0 as usize].bounds
    }

    /// The fraction of a movement, 0 to 1, at which its rectangle touches a convex area; none if it does not.
    pub fn meet(&mut self, of: Part, fixed: &Polygon, which: Contact) -> Option<f64> {
        self.search(of.0, fixed, which, which.none())
    }

    /// [`Bisection::meet`] for a numbered movement and a rectangle. A movement that does not turn needs no halving.
    pub(crate) fn meet_rectangle(
        &mut self,
        (number, movement): (usize, &Movement),
        fixed: &Rectangle,
        which: Contact,
    ) -> Option<f64> {
        if movement.slides() {
            return movement.slide_to(fixed).map(|contact| contact.at(which));
        }
        let part = self.numbered(number, || *movement);
        self.meet(part, &ConvexOutline::rectangle(fixed).into(), which)
    }

    /// The fraction of a movement at which its rectangle touches the area that another movement covers, or `known` if
    /// that is better.
    pub fn touch(&mut self, of: Part, other: Part, which: Contact, known: f64) -> f64 {
        self.search_swept(of.0, other.0, which, known)
    }

    /// [`Bisection::touch`] for numbered movements. Two movements that do not turn need no halving.
    pub(crate) fn touch_numbered(
        &mut self,
        (number, movement): (usize, &Movement),
        (other_number, other): (usize, &Movement),
        which: Contact,
        known: f64,
    ) -> f64 {
        if let (true, Some(covered)) = (movement.slides(), other.covered()) {
            return movement.slide_to(&covered).map_or(known, |contact| which.better(known, contact.at(which)));
        }
        let part = self.numbered(number, || *movement);
        let other = self.numbered(other_number, || *other);
        self.touch(part, other, which, known)
    }

    /// The other's hull rules out quickly that the two touch; where it does not, the other is halved until its hull
    /// fits.
    fn search_swept(&mut self, of: u32, other: u32, which: Contact, known: f64) -> f64 {
        if which.is_best(known) || !self.bounds(Part(of)).meet(self.bounds(Part(other))) {
            return known;
        }
        let whole = self.parts[of as usize].movement;
        let area = &mut self.parts[other as usize];
        let fits = area.fits(self.tolerance);
        let stray = area.stray();
        let hull = *area.hull(&mut self.hulls);
        if !fits && known != which.none() && self.is_clear(of, &hull, stray, which, known) {
            return known;
        }
        // A half's hull may reach beyond the hull of the whole, so a hull that does not fit only decides whether there
        // is a contact at all.
        let Some(found) = self.search(of, &hull, which, if fits { known } else { which.none() }) else { return known };
        if fits {
            return which.better(known, found);
        }
        let place = whole.rectangle(found.min(1.0)).centre;
        let first = self.halve(other);
        let room = |half: u32| (self.parts[half as usize].movement.rectangle(0.5).centre - place).norm_squared();
        // The nearer half first: the contact found there rules out most of the other half.
        let halves = if room(first) <= room(first + 1) { [first, first + 1] } else { [first + 1, first] };
        halves.into_iter().fold(known, |known, half| self.search_swept(of, half, which, known))
    }

    /// Where a part touches a convex area, if that is better than the known contact.
    fn search(&mut self, of: u32, fixed: &Polygon, which: Contact, known: f64) -> Option<f64> {
        if which.is_best(known) {
            return None;
        }
        let part = &mut self.parts[of as usize];
        if part.is_straight(self.tolerance) {
            let near = if known == which.none() { part.bounds } else { part.slide_before(which, known).bounds };
            if !near.grown(2.0 * self.tolerance).meet(&fixed.bounds) {
                return None;
            }
            return part.slide_to(&fixed.outline).map(|contact| contact.at(which));
        }
        if !part.bounds.meet(&fixed.bounds) || !outlines_touch(&part.hull(&mut self.hulls).outline, &fixed.outline) {
            return None;
        }
        let first = self.halve(of);
        which.halves().into_iter().find_map(|half| {
            let found = self.search(first + half, fixed, which, 2.0 * known - f64::from(half))?;
            Some(if half == 0 { (found / 2.0).min(0.5) } else { 0.5 + found / 2.0 })
        })
    }

    /// Whether every place with a contact better than the known one is so far from a hull that nothing within `stray`
    /// of that hull is touched.
    fn is_clear(&mut self, of: u32, hull: &Polygon, stray: Metre, which: Contact, known: f64) -> bool {
        if which.is_best(known) {
            return true;
        }
        let part = &mut self.parts[of as usize];
        let room = stray + part.stray() + self.tolerance;
        if !part.bounds.grown(room).meet(&hull.bounds)
            || part.hull(&mut self.hulls).outline.is_further_than(room, &hull.outline)
        {
            return true;
        }
        if part.is_straight(self.tolerance) {
            let better = part.slide_before(which, known);
            return !better.bounds.grown(room).meet(&hull.bounds)
                || better.movement.hull().is_further_than(room, &hull.outline);
        }
        let first = self.halve(of);
        // The half that ends at the known contact is the likelier one to be near.
        which
            .halves()
            .into_iter()
            .rev()
            .all(|half| self.is_clear(first + half, hull, stray, which, 2.0 * known - f64::from(half)))
    }

    /// The index of a part's first half, which the second half follows.
    fn halve(&mut self, part: u32) -> u32 {
        let whole = &mut self.parts[part as usize];
        if let Some(first) = whole.halves {
            return first;
        }
        let halves = whole.halve();
        let first = self.parts.len() as u32;
        self.parts.extend(halves);
        self.parts[part as usize].halves = Some(first);
        first
    }
}
