//! # closecall
//!
//! **How close was that?** closecall finds traffic conflicts: pairs of road users that come closer than they safely can.
//!
//! Road users come in as a [`Frame`], one per simulation step; a [`Roster`] holds what stays the same about them. The
//! [`Detector`] finds the pairs that would meet, and compares for each the room that is left, the gap, with the minimal
//! collision distance [μ](mu) that both need to brake. A pair with a negative margin (gap − μ) is in conflict; what lasts
//! over several steps becomes one [`Conflict`] with its measures: TTC, DRAC, PET, ΔV.
//!
//! ```
//! use closecall::{Detector, Frame, Kind, Options, Profile, Roster, State, SumoType};
//!
//! let options = Options::default();
//! let mut roster = Roster::default();
//! let car = roster.profile(Profile::vehicle(&SumoType::car("car"), &options))?;
//! let leader = roster.enter("leader", car);
//! let follower = roster.enter("follower", car);
//!
//! // Front bumpers in m, headings in rad counter-clockwise from east, speeds in m/s.
//! let mut frame = Frame::default();
//! frame.begin(0.0);
//! frame.push(leader, State { x: 40.0, y: 0.0, z: 0.0, heading: 0.0, speed: 5.0 });
//! frame.push(follower, State { x: 0.0, y: 0.0, z: 0.0, heading: 0.0, speed: 25.0 });
//!
//! let mut detector = Detector::new(&options, None);
//! let encounter = detector.step(&frame, &roster).next().copied().unwrap();
//! assert_eq!((encounter.ego, encounter.kind), (follower, Kind::RearEnd));
//! assert!(encounter.in_conflict());
//! # Ok::<(), closecall::Error>(())
//! ```
//!
//! | module | what is in it, in the order of the data's story |
//! |---|---|
//! | [`util`] | units, limits, numbers, threads |
//! | [`geometry`] | rectangles, outlines, lines; whether two touch, and when |
//! | [`braking`] | the stopping distance, and [μ](mu) by its models |
//! | [`options`] | the settings of the method |
//! | [`traffic`] | the road users of a step, what stays the same about them, the net |
//! | [`detection`] | frames in, [encounters](Encounter) out |
//! | [`events`] | encounters over several steps become a [`Conflict`] ([`Tracker`]) |
//!
//! Files are not this crate's: `closecall-run` reads nets and recordings, and writes logs. SI units throughout; positions are
//! front-bumper centres. The feature `clap` makes the options arguments of a command line.

pub mod braking;
pub mod detection;
mod error;
pub mod events;
pub mod geometry;
pub mod options;
pub mod traffic;
pub mod util;

pub use braking::{Brakes, Braking, MuModel, mu, response_left};
pub use detection::detector::Detector;
pub use detection::encounter::{Encounter, Nearness};
pub use detection::kind::{Kind, Severity};
pub use detection::severity::{Consequence, NearnessLevel};
pub use error::{Error, Result};
pub use events::{Alarm, Artefact, Cause, Causes, Conflict, Manoeuvre, PetSoFar, Snapshot, Surroundings, Tracker};
pub use geometry::Point;
pub use options::condition::Condition;
pub use options::shortcut::Shortcut;
pub use options::{Align, BrakeSystem, Deceleration, Mode, Options, PathModel, TypeOptions};
pub use traffic::frame::{Frame, State};
pub use traffic::net::{EdgeIndex, LaneIndex, Net, Overlap, Overlaps};
pub use traffic::placement::Placement;
pub use traffic::profile::{Category, Profile};
pub use traffic::roster::{ProfileIndex, Roster, UserIndex};
pub use traffic::sumo_type::SumoType;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_public_types_may_go_to_another_thread() {
        fn check<T: Send>() {}
        check::<(Detector, Tracker, Frame, Roster, Net)>();
        check::<(Options, Condition, Profile, SumoType, Placement)>();
        check::<(Encounter, Conflict, Alarm, Snapshot, Causes)>();
        check::<Error>();
    }
}
