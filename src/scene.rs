//! What this scene does not need, why, and what leaving it out saved.
//!
//! Leaving out changes no result: each entry is a pair or a question that could not have become a conflict.

use std::fmt;

use serde::Serialize;

use crate::detector::Work;
use crate::net::Net;

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
pub fn left_out(work: &Work, net: Option<&Net>) -> Vec<LeftOut> {
    let counted = [
        ("pairs", "both stand", work.both_stand),
        ("pairs", "more than 2.5 m apart in height", work.other_level),
        ("pairs", "both are persons", work.both_persons),
        ("accurate tests", "the boxes around both ways do not meet", work.ways_apart),
        ("sweeps", "both drive on parallel straight lines: one dimension", work.in_line),
        ("lanes asked for", "still on the path laid before", work.known_paths),
    ];
    let mut all = Vec::new();
    if net.is_some_and(|net| !net.has_levels) {
        all.push(LeftOut::altogether("heights", "the net is flat"));
    }
    all.extend(counted.into_iter().filter(|(_, _, times)| *times > 0).map(|(what, why, times)| LeftOut {
        what,
        why,
        times: Some(times),
    }));
    all
}
