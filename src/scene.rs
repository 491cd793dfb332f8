//! What this scene does not need, why, and what leaving it out saved.
//!
//! Leaving out changes no result. What could be computed all the same is an [`Exclusion`], and `--keep-all` computes it;
//! what is no pair by definition (both stand, both are persons, one on a bridge above the other) is only counted.

use std::fmt;

use clap::ValueEnum;
use serde::Serialize;

use crate::detector::Detector;
use crate::options::Options;

/// Something that a scene may not need.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Exclusion {
    /// Pairs whose areas do not meet: phase 1. Kept, every pair goes on to phase 2.
    CirclesApart,
    /// Accurate tests of pairs whose ways lie in boxes that do not meet.
    WaysApart,
    /// Sweeps of pairs that drive in line, for which one dimension is enough.
    InLine,
    /// Asking for the lane of who is still on the path laid before.
    KnownPaths,
}

/// What is left out of a run where the scene does not need it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exclusions {
    /// [`Exclusion::CirclesApart`].
    pub circles_apart: bool,
    /// [`Exclusion::WaysApart`].
    pub ways_apart: bool,
    /// [`Exclusion::InLine`].
    pub in_line: bool,
    /// [`Exclusion::KnownPaths`].
    pub known_paths: bool,
}

impl Exclusions {
    /// What these options leave out: all but what they keep.
    pub fn of(options: &Options) -> Self {
        let leaves_out = |what| !options.keep_all && !options.keep.contains(&what);
        Self {
            circles_apart: leaves_out(Exclusion::CirclesApart),
            ways_apart: leaves_out(Exclusion::WaysApart),
            in_line: leaves_out(Exclusion::InLine),
            known_paths: leaves_out(Exclusion::KnownPaths),
        }
    }
}

/// Something that was left out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// What.
    pub what: &'static str,
    /// Why the result is the same without it.
    pub why: &'static str,
    /// How often it was left out; none where it was left out altogether.
    pub times: Option<u64>,
}

impl LeftOut {
    /// Something that the whole run did without.
    pub fn altogether(what: &'static str, why: &'static str) -> Self {
        Self { what, why, times: None }
    }
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { what, why, times } = self;
        match times {
            Some(times) => write!(f, "{what}: left out {times} times ({why})"),
            None => write!(f, "{what}: left out ({why})"),
        }
    }
}

/// What the detector did without.
pub fn left_out(detector: &Detector) -> Vec<LeftOut> {
    let work = detector.work();
    let tests = [
        ("frontal", "no opposing ways within reach", work.frontal == 0),
        ("side", "no crossing or bending ways within reach", work.side + work.swept == 0),
    ];
    let unneeded = tests.into_iter().filter(|(.., unneeded)| *unneeded && detector.leaves_out().in_line);
    let counted = [
        ("pairs", "too far apart to meet before both stand", work.circles_apart),
        ("pairs", "both stand", work.both_stand),
        ("pairs", "more than 2.5 m apart in height", work.other_level),
        ("pairs", "both are persons", work.both_persons),
        ("accurate tests", "the boxes around both ways do not meet", work.ways_apart),
        ("sweeps", "both drive straight on in parallel: one dimension is enough", work.in_line),
        ("lanes asked for", "still on the path laid before, and nobody's route changes", work.known_paths),
    ];
    let done_without = counted.into_iter().filter(|(_, _, times)| *times > 0);
    let done_without = done_without.map(|(what, why, times)| LeftOut { what, why, times: Some(times) });
    unneeded.map(|(what, why, _)| LeftOut::altogether(what, why)).chain(done_without).collect()
}
