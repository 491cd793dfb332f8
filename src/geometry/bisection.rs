//! Where rectangles on their way touch: their steps, cut in halves until each part hardly turns.
//!
//! Of the one the last parts are translations, of the other hulls ([`super::sweep`]); between them, a hull that is not
//! touched leaves out all parts of it. Whoever asks again (another step, the other direction, the last touch after the
//! first) finds the parts, their boxes and hulls as they are.
//!
//! A half may reach a little beyond the hull of the whole, by the arc beyond its chord. So what has been found leaves out
//! only what stays clear of it by more than that, and the result is that of trying all parts, to the last bit.

use super::convex::ConvexOutline;
use super::polygon::Polygon;
use super::rectangle::Rectangle;
use super::separating_axes::{ContactInterval, outlines_touch, translation};
use super::sweep::{Step, TOLERANCE};
use super::{Bounds, Vector};
use crate::util::units::Metre;

/// More than rounding can move anything, in m.
const ROUNDING: Metre = 1e-6;

/// Memory for so many parts and hulls is taken at once where it is kept from step to step, and no more. In
/// `sumo_nets/town` one pair of 8,000 needs more than half of it.
const KEPT: usize = 256;

/// Which touch is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contact {
    /// Where two begin to touch.
    Entry,
    /// Where they touch last; 1 and more where they still do at the end.
    Exit,
}

impl Contact {
    /// What every touch is better than.
    pub fn none(self) -> f64 {
        match self {
            Self::Entry => f64::INFINITY,
            Self::Exit => f64::NEG_INFINITY,
        }
    }

    /// Where that is in a contact.
    fn of(self, contact: ContactInterval) -> f64 {
        match self {
            Self::Entry => contact.enter,
            Self::Exit => contact.leave,
        }
    }

    /// Whether no part of a step can be better than this.
    fn is_best(self, part: f64) -> bool {
        match self {
            Self::Entry => part <= 0.0,
            Self::Exit => part >= 1.0,
        }
    }

    fn better(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Entry => a.min(b),
            Self::Exit => a.max(b),
        }
    }

    /// The halves of a step in the order in which they are searched.
    fn halves(self) -> [u32; 2] {
        match self {
            Self::Entry => [0, 1],
            Self::Exit => [1, 0],
        }
    }
}

/// A step among [`Bisection`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part(u32);

/// Steps, and the halves that they were cut in so far. Whoever has it keeps its memory; who asks forgets the steps of
/// whoever asked before.
#[derive(Clone, Debug, Default)]
pub struct Bisection {
    parts: Vec<Swept>,
    /// Of those parts that were asked for theirs.
    hulls: Vec<Polygon>,
    /// Where the steps stand whose number is known.
    numbered: Vec<Option<Part>>,
}

/// A step or a part of it, and what was computed of it.
#[derive(Clone, Copy, Debug)]
struct Swept {
    step: Step,
    /// The axes of the first and the last rectangle, normalised.
    axes: [Vector; 2],
    bounds: Bounds,
    turn: f64,
    /// Where its hull stands.
    hull: Option<u32>,
    /// The axis of the rectangle in the middle.
    middle: Option<Vector>,
    /// The first half, which the second one stands behind.
    halves: Option<u32>,
}

impl Swept {
    fn new(step: Step) -> Self {
        let [first, last] = [step.rectangle(0.0), step.rectangle(1.0)];
        let mut bounds = first.bounds();
        bounds.join(&last.bounds());
        let turn = (step.to_axis - step.from_axis).norm();
        Self { step, axes: [first.axis, last.axis], bounds, turn, hull: None, middle: None, halves: None }
    }

    fn hull<'a>(&mut self, hulls: &'a mut Vec<Polygon>) -> &'a Polygon {
        let place = *self.hull.get_or_insert_with(|| {
            hulls.push(self.step.hull().into());
            hulls.len() as u32 - 1
        });
        &hulls[place as usize]
    }

    fn middle(&mut self) -> Vector {
        *self.middle.get_or_insert_with(|| self.step.rectangle(0.5).axis)
    }

    /// Its contact with a convex area, as a translation of the rectangle in its middle.
    fn slide_to(&mut self, fixed: &ConvexOutline) -> Option<ContactInterval> {
        let (axis, Step { from, to, length, width, .. }) = (self.middle(), self.step);
        let by = to - from;
        let middle = Rectangle::behind(from + by * 0.5, axis, length, width);
        let start = Rectangle { centre: middle.centre - by * 0.5, ..middle };
        translation(&ConvexOutline::rectangle(&start), &by, fixed)
    }

    /// The part of that translation which is better than what is known.
    fn slide_before(&mut self, which: Contact, known: f64) -> Self {
        let (axis, Step { from, to, .. }) = (self.middle(), self.step);
        let at = from + (to - from) * known;
        let (from, to) = if which == Contact::Entry { (from, at) } else { (at, to) };
        Self::new(Step { from, from_axis: axis, to, to_axis: axis, ..self.step })
    }

    fn halve(&mut self) -> [Self; 2] {
        let (middle, Step { from, to, .. }) = (self.middle(), self.step);
        let at = |part| from + (to - from) * part;
        let first = Step { from: at(0.0), from_axis: self.axes[0], to: at(0.5), to_axis: middle, ..self.step };
        let second = Step { from: at(0.5), from_axis: middle, to: at(1.0), to_axis: self.axes[1], ..self.step };
        [Self::new(first), Self::new(second)]
    }

    /// How far the hull reaches beyond what the step covers: on the inner side of a turn it cuts the corner between
    /// the sides of the first and the last rectangle.
    fn excess(&self) -> Metre {
        self.turn * self.step.length / 4.0
    }

    /// How far turning takes a corner from where a translation in the middle's direction would take it.
    fn bend(&self) -> Metre {
        self.turn * (self.step.length + self.step.width) / 2.0
    }

    /// How far the hull of a part of it may reach beyond its own: an arc beyond its chord.
    fn stray(&self) -> Metre {
        self.turn * self.turn / 3.0 * (self.step.length + self.step.width) + ROUNDING
    }
}

impl Bisection {
    /// With all the memory that is kept from step to step, so that it does not grow with what is looked at.
    pub fn to_keep() -> Self {
        let room = Self { parts: Vec::with_capacity(KEPT), hulls: Vec::with_capacity(KEPT), ..Self::default() };
        Self { numbered: Vec::with_capacity(KEPT), ..room }
    }

    /// Forgets all steps.
    pub fn clear(&mut self) {
        self.parts.clear();
        self.hulls.clear();
        self.numbered.clear();
    }

    /// Does so, and gives back the memory that hardly anybody needs.
    pub fn shrink(&mut self) {
        self.clear();
        self.parts.shrink_to(KEPT);
        self.hulls.shrink_to(KEPT);
        self.numbered.shrink_to(KEPT);
    }

    /// Adds a step.
    pub fn add(&mut self, step: Step) -> Part {
        self.parts.push(Swept::new(step));
        Part(self.parts.len() as u32 - 1)
    }

    /// The step with this number; added when it is asked for first.
    pub fn numbered(&mut self, number: usize, step: impl FnOnce() -> Step) -> Part {
        if self.numbered.len() <= number {
            self.numbered.resize(number + 1, None);
        }
        if let Some(known) = self.numbered[number] {
            return known;
        }
        let added = self.add(step());
        self.numbered[number] = Some(added);
        added
    }

    /// The box around the area that a step covers.
    pub fn bounds(&self, part: Part) -> &Bounds {
        &self.parts[part.0 as usize].bounds
    }

    /// The part of a step, 0 to 1, at which its rectangle touches a convex area; none if it does not.
    pub fn meet(&mut self, of: Part, fixed: &Polygon, which: Contact) -> Option<f64> {
        self.search(of.0, fixed, which, which.none())
    }

    /// The same of the step with this number and a rectangle; one that never turns needs no halves.
    pub fn meet_rectangle(&mut self, (number, step): (usize, &Step), fixed: &Rectangle, which: Contact) -> Option<f64> {
        if step.slides() {
            return step.slide_to(fixed).map(|contact| which.of(contact));
        }
        let part = self.numbered(number, || *step);
        self.meet(part, &ConvexOutline::rectangle(fixed).into(), which)
    }

    /// The part of a step at which its rectangle touches the area that another step covers, or `known` if that is
    /// better.
    pub fn touch(&mut self, of: Part, other: Part, which: Contact, known: f64) -> f64 {
        self.search_swept(of.0, other.0, which, known)
    }

    /// The same of the steps with these numbers; two that never turn need no halves.
    pub fn touch_numbered(
        &mut self,
        (number, step): (usize, &Step),
        (of_other, other): (usize, &Step),
        which: Contact,
        known: f64,
    ) -> f64 {
        if let (true, Some(covered)) = (step.slides(), other.covered()) {
            return step.slide_to(&covered).map_or(known, |contact| which.better(known, which.of(contact)));
        }
        let part = self.numbered(number, || *step);
        let other = self.numbered(of_other, || *other);
        self.touch(part, other, which, known)
    }

    /// The other's hull decides quickly where they do not touch; where they do, it is cut in halves until it fits.
    fn search_swept(&mut self, of: u32, other: u32, which: Contact, known: f64) -> f64 {
        if which.is_best(known) || !self.bounds(Part(of)).meet(self.bounds(Part(other))) {
            return known;
        }
        let (whole, area) = (self.parts[of as usize].step, &mut self.parts[other as usize]);
        let (fits, stray, hull) = (area.excess() <= TOLERANCE, area.stray(), *area.hull(&mut self.hulls));
        if !fits && known != which.none() && self.is_clear(of, &hull, stray, which, known) {
            return known;
        }
        // A half's hull may reach beyond that of the whole: of this one no more counts than whether it is touched.
        let Some(found) = self.search(of, &hull, which, if fits { known } else { which.none() }) else { return known };
        if fits {
            return which.better(known, found);
        }
        let place = whole.rectangle(found.min(1.0)).centre;
        let first = self.halve(other);
        let room = |half: u32| (self.parts[half as usize].step.rectangle(0.5).centre - place).norm_squared();
        // What is found in the nearer half leaves out most of the other.
        let halves = if room(first) <= room(first + 1) { [first, first + 1] } else { [first + 1, first] };
        halves.into_iter().fold(known, |known, half| self.search_swept(of, half, which, known))
    }

    /// Where a part touches a convex area, if that is better than what is known.
    fn search(&mut self, of: u32, fixed: &Polygon, which: Contact, known: f64) -> Option<f64> {
        if which.is_best(known) {
            return None;
        }
        let part = &mut self.parts[of as usize];
        if part.bend() <= TOLERANCE {
            let near = if known == which.none() { part.bounds } else { part.slide_before(which, known).bounds };
            if !near.grown(2.0 * TOLERANCE).meet(&fixed.bounds) {
                return None;
            }
            return part.slide_to(&fixed.outline).map(|contact| which.of(contact));
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

    /// Whether all that is better than what is known stays so clear of a hull that it touches nothing which strays from
    /// that by so much.
    fn is_clear(&mut self, of: u32, hull: &Polygon, stray: Metre, which: Contact, known: f64) -> bool {
        if which.is_best(known) {
            return true;
        }
        let part = &mut self.parts[of as usize];
        let room = stray + part.stray() + TOLERANCE;
        if !part.bounds.grown(room).meet(&hull.bounds)
            || part.hull(&mut self.hulls).outline.is_further_than(room, &hull.outline)
        {
            return true;
        }
        if part.bend() <= TOLERANCE {
            let better = part.slide_before(which, known);
            return !better.bounds.grown(room).meet(&hull.bounds)
                || better.step.hull().is_further_than(room, &hull.outline);
        }
        let first = self.halve(of);
        // The half that ends at what is known is the likelier one to be near.
        which
            .halves()
            .into_iter()
            .rev()
            .all(|half| self.is_clear(first + half, hull, stray, which, 2.0 * known - f64::from(half)))
    }

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
