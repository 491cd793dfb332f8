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
//! | I want to | with |
//! |---|---|
//! | look at single frames | [`Detector`] |
//! | follow conflicts over a whole run, with a log | [`Run`] |
//! | check a recording of SUMO | [`Replay`] into a [`Run`] |
//! | know μ of two road users | [`mu`] |
//!
//! The folder `examples/` has a program for each. SI units throughout; positions are front-bumper centres.
//!
//! # Features
//! The default has all of them. Without any, the library has the detector, runs, the log and replay.
//!
//! | feature | adds |
//! |---|---|
//! | `cli` | the command line, options from text, logs read back, statistics, the report, regression tests |
//! | `parquet` | sweeps, whose logs are Parquet files, and recordings in Parquet |
//! | `plot` | charts as PNG or SVG |
//! | `study` | the study of error against run time, and the stress cases |

// With some features off, parts that only those features use are left without a caller.
#![cfg_attr(not(all(feature = "parquet", feature = "study")), allow(dead_code, unused_imports))]

#[cfg(feature = "cli")]
mod analysis;
#[cfg(feature = "cli")]
mod batch;
mod braking;
#[cfg(feature = "cli")]
pub mod cli;
mod detection;
mod error;
mod events;
mod geometry;
mod input;
#[doc(hidden)]
pub mod internals;
mod options;
mod output;
mod run;
#[cfg(feature = "study")]
mod study;
mod traffic;
mod util;

pub use braking::{Brakes, Braking, MuModel, mu, response_left};
pub use detection::detector::Detector;
pub use detection::encounter::{Encounter, Nearness};
pub use detection::kind::{Kind, Severity};
pub use detection::severity::{Consequence, NearnessLevel};
pub use error::{Error, Result};
pub use events::{Alarm, Artefact, Cause, Causes, Conflict, Manoeuvre, PetSoFar, Snapshot, Surroundings, Tracker};
pub use geometry::Point;
pub use input::replay::Replay;
pub use options::condition::Condition;
pub use options::shortcut::Shortcut;
pub use options::{Align, BrakeSystem, Deceleration, Mode, Options, PathModel, TypeOptions};
pub use output::folder::LogFolder;
pub use output::formats::OutputFiles;
pub use output::palette;
pub use output::record::RunRecord;
pub use output::summary::Summary;
pub use run::Run;
pub use run::recorded::{Ending, RecordedRun};
pub use traffic::frame::{Frame, State};
pub use traffic::net::{EdgeIndex, LaneIndex, Net, Overlap, Overlaps};
pub use traffic::placement::Placement;
pub use traffic::profile::{Category, Profile};
pub use traffic::roster::{ProfileIndex, Roster, UserIndex};
pub use traffic::sumo_type::SumoType;
