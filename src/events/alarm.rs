//! An open conflict in its last step.

use crate::detection::encounter::Nearness;
use crate::detection::kind::{Kind, Severity};
use crate::geometry::Point;
use crate::traffic::roster::UserIndex;
use crate::util::units::{Metre, Second};

/// The road users of an open conflict and its current severity, as painted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alarm {
    /// The ego of the last step that meets the log's condition.
    pub ego: UserIndex,
    /// The foe of that step.
    pub foe: UserIndex,
    /// The severity in that step.
    pub severity: Severity,
    /// The kind in that step.
    pub kind: Kind,
    /// The ego's front at the conflict point of that step, or that of its carriage that touches.
    pub at: Point,
    /// That step, in s.
    pub time: Second,
    /// The margin in that step, in m.
    pub margin: Metre,
    /// The measures of that step.
    pub nearness: Option<Nearness>,
}
