//! An open conflict in its last step.

use super::why::Artefact;
use crate::detection::encounter::Nearness;
use crate::detection::kind::{Kind, Severity};
use crate::geometry::Point;
use crate::traffic::roster::UserIndex;
use crate::util::units::{Metre, Second};

/// The PET of a conflict, or its lower bound so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PetSoFar {
    /// The second has entered the conflict area this long after the first left it, in s.
    Known(Second),
    /// The first has left it for so long, in s, and the second has not entered it yet.
    AtLeast(Second),
}

/// The road users of an open conflict and its current severity, as painted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alarm {
    /// The ego of the last step that meets the log's condition.
    pub ego: UserIndex,
    /// The foe of that step.
    pub foe: UserIndex,
    /// The severity in that step.
    pub severity: Severity,
    /// What the conflict is so far, if it is none of traffic's.
    pub artefact: Option<Artefact>,
    /// The kind in that step.
    pub kind: Kind,
    /// The ego's front at the conflict point of that step, or that of its carriage that touches.
    pub at: Point,
    /// That step, in s.
    pub time: Second,
    /// The margin in that step, in m.
    pub margin: Metre,
    /// The measures of that step; with the crash probability if [`Tracker::keep_probabilities`](super::Tracker::keep_probabilities)
    /// was called.
    pub nearness: Option<Nearness>,
}
