//! The work that a run left out, why, and how often.
//!
//! Leaving out changes no result. Pairs that cannot conflict by definition (both stand, both are persons, on different
//! levels) are only counted.

use std::fmt;

use serde::Serialize;

use super::shortcuts::Shortcuts;
use super::work::Work;

/// A kind of work that was left out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// The kind of work.
    pub what: &'static str,
    /// Why the result is the same without it.
    pub why: &'static str,
    /// How often it was left out; none where the whole run did without.
    pub times: Option<u64>,
}

impl LeftOut {
    /// Work that the whole run did without.
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

/// What the detector left out, by its counts.
pub(super) fn left_out(work: &Work, shortcuts: Shortcuts) -> Vec<LeftOut> {
    let tests = [
        ("frontal", "no opposing ways within reach", work.frontal == 0),
        ("side", "no crossing or bending ways within reach", work.side + work.swept == 0),
    ];
    let unneeded = tests.into_iter().filter(|(.., unneeded)| *unneeded && shortcuts.in_line);
    let counted = [
        ("pairs", "too far apart to meet before both stand", work.areas_apart),
        ("pairs", "both stand", work.both_stand),
        ("pairs", "more than 2.5 m apart in height", work.other_level),
        ("pairs", "both are persons", work.both_persons),
        ("accurate tests", "the boxes around both ways do not meet", work.paths_apart),
        ("sweeps", "both drive straight on in parallel: one dimension is enough", work.in_line),
        ("lanes asked for", "still on the path laid before, and nobody's route changes", work.known_paths),
    ];
    let done_without = counted.into_iter().filter(|(_, _, times)| *times > 0);
    let done_without = done_without.map(|(what, why, times)| LeftOut { what, why, times: Some(times) });
    unneeded.map(|(what, why, _)| LeftOut::altogether(what, why)).chain(done_without).collect()
}
