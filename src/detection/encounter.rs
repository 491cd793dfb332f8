//! The result of the detector in one step: pairs with a conflict point, and their measures.

use super::kind::Kind;
use super::measures::table::LoggedValues;
use super::severity::Assessment;
use crate::traffic::net::LaneIndex;
use crate::traffic::roster::UserIndex;
use crate::util::units::{Metre, Probability, Radian, Second};

/// A pair with a conflict point, in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encounter {
    /// The road user with the longer distance to the conflict point.
    pub ego: UserIndex,
    /// The other road user.
    pub foe: UserIndex,
    /// The ego's row in the frame.
    pub ego_row: u32,
    /// The foe's row in the frame.
    pub foe_row: u32,
    /// Kind by the angle at the conflict point.
    pub kind: Kind,
    /// Angle α between the headings at the conflict point, 0 to π.
    pub angle: Radian,
    /// Room that is left.
    pub gap: Metre,
    /// Minimal collision distance μ.
    pub mu: Metre,
    /// gap − μ; the pair is in conflict if it is below 0.
    pub margin: Metre,
    /// Distance of the ego to the conflict point.
    pub ego_distance: Metre,
    /// Distance of the foe until it reaches the conflict point or (cos α > 0) has left it.
    pub foe_distance: Metre,
    /// Whether the foe is at the conflict point already: of a rear-end pair, a leader on the ego's path.
    pub foe_leads: bool,
    /// Front-bumper centre of the ego at the conflict point, or the centre of the front of its carriage that touches, x.
    pub x: Metre,
    /// The same, y.
    pub y: Metre,
    /// Lane of the conflict point, on the ego's path; none without a net.
    pub lane: Option<LaneIndex>,
    /// How deep the rectangles overlap now: the shortest displacement that parts them; 0 where they do not overlap.
    pub overlap: Metre,
    /// Whether they overlap by more than the contact tolerance.
    pub collision: bool,
    /// Measures of a pair in conflict or selected by the log's condition; none of others.
    pub nearness: Option<Nearness>,
    /// The step meets the log's condition if its event's PET is below this: infinite where it does whatever the PET is, minus
    /// infinite where it does not.
    pub pet_below: Second,
}

/// Measures of a pair, in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Nearness {
    /// Smallest distance between the two rectangles now.
    pub clearance: Metre,
    /// The measures that every log has. A crash probability that was not worked out is missing:
    /// [`Detector::crash_probability`](super::detector::Detector::crash_probability) does.
    pub values: LoggedValues,
    /// Upper bounds of the crash probabilities: if the foe goes on as now, and if it brakes fully.
    pub crash_at_most: [Probability; 2],
    /// How they are worked out.
    pub(crate) chances: ChancesIndex,
    /// Whether neither the limit of the DRAC nor the ego's brakes avoid contact.
    pub unavoidable: bool,
    /// How severe it is by the values above, and by how the two brake.
    pub assessment: Assessment,
}

/// Where a step's chances of a pair are: the thread, and the place in its list. It is unrelated to the pair.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ChancesIndex {
    pub worker: u32,
    pub place: u32,
    /// The thread's number of the step: chances are kept until the next one.
    pub step: u32,
}

impl PartialEq for ChancesIndex {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Encounter {
    /// Whether the gap is smaller than μ, or there is none left.
    pub fn in_conflict(&self) -> bool {
        self.margin < 0.0 || self.collision
    }

    /// Whether the paths of the two may cross or merge, so that they may have a PET; a follower's and its leader's are one.
    pub(crate) fn may_cross(&self) -> bool {
        self.kind != Kind::RearEnd || !self.foe_leads
    }

    /// Whether it meets the log's condition, if its event has the PET for it.
    pub fn may_be_logged(&self) -> bool {
        self.pet_below > Second::NEG_INFINITY
    }

    /// Whether it meets the log's condition whatever the PET of its event is.
    pub fn is_logged(&self) -> bool {
        self.pet_below == Second::INFINITY
    }
}
