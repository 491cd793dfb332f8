//! What this scene does not need, why, and what leaving it out saved.
//!
//! Leaving out changes no result. What could be computed all the same is an [`Exclusion`], and `--keep-all` computes it;
//! what is no pair by definition (both stand, both are persons, one on a bridge above the other) is only counted.

use std::fmt;

use serde::Serialize;

use crate::options::Options;
use crate::options::exclusion::Exclusion;

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
