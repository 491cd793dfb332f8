//! Encounters become conflicts: one event per pair and run of steps that meet the log's condition.
//!
//! An event opens at the first step that meets the condition and closes when it has not been met for [`CLOSES_AFTER`] or
//! one of the two has left the scene. Where the paths of both may cross, it then waits for its PET, as long as one may be
//! (`longest_pet`), and as long again while the second is in the conflict area.
//!
//! Where the condition asks for the PET, a pair is followed over all steps that meet it if the PET is short enough. Whether
//! it is, is known at the end: then the whole event is one conflict. Otherwise only what meets the rest of the condition is
//! logged, each run of such steps as a conflict of its own.

mod alarm;
mod chosen_measures;
mod clips;
mod event;
mod extremes;
mod moment;
mod past;
mod snapshot;
mod span;
mod struck;
mod substep;
mod tracker;
mod under_way;
mod why;

pub use alarm::{Alarm, PetSoFar};
pub use clips::{Clip, ClipCategory, ClipSignal, ClipUser, Clips, MOST, Scene};
pub use event::Conflict;
pub use moment::Moment;
pub use snapshot::Snapshot;
pub use tracker::Tracker;
pub use under_way::CLOSES_AFTER;
pub use why::{Artefact, Cause, Causes, Manoeuvre, STANDS, Surroundings};
