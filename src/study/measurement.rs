//! What the study measures: an axis for each choice, and a row for each method on each set of items.

use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::Result;
use crate::util::units::Second;

/// A choice that closecall makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// How to decide whether two rectangles touch.
    Volume,
    /// How to find the pairs that are near each other.
    Candidates,
    /// Positions checked now and then, or swept.
    Time,
    /// Model of μ, or the braking equations integrated.
    Braking,
    /// f32 or f64, and from which origin.
    Numbers,
    /// Where a road user will go.
    Path,
}

impl Axis {
    /// All of them, in the order of the flow from a pair to its path.
    pub const ALL: [Self; 6] = [Self::Volume, Self::Candidates, Self::Time, Self::Braking, Self::Numbers, Self::Path];

    /// The name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Volume => "volume",
            Self::Candidates => "candidates",
            Self::Time => "time",
            Self::Braking => "braking",
            Self::Numbers => "numbers",
            Self::Path => "path",
        }
    }
}

/// One method on one set of items: a row of `study.csv`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measurement {
    /// The choice.
    pub axis: Axis,
    /// The method.
    pub method: &'static str,
    /// The set of items, and the method's own parameter if it has one.
    pub parameter: String,
    /// What the error is.
    pub error_name: &'static str,
    /// The error, 0 for none.
    pub error: f64,
    /// Share of what should be found that is not.
    pub false_negative_rate: f64,
    /// Share of what is found that should not be, or of what should not be found that is.
    pub false_positive_rate: f64,
    /// Median run time.
    pub ns_per_item: f64,
    /// How many items each run had.
    pub items: usize,
    /// Whether no other method on the same items has less error in less time.
    pub on_pareto_front: bool,
    /// The set of items: what may be compared with each other.
    #[serde(skip)]
    pub scene: String,
    /// Whether closecall does it so.
    #[serde(skip)]
    pub default: bool,
}

/// What to measure, and with what.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Fewer items and repetitions: all axes within two minutes.
    pub quick: bool,
    /// The folder of the scenarios that the path axis runs.
    pub nets: PathBuf,
}

/// The scenes of these rows, in their order.
pub(super) fn scenes(rows: &[Measurement]) -> Vec<&str> {
    let mut scenes = Vec::new();
    for row in rows {
        if !scenes.contains(&row.scene.as_str()) {
            scenes.push(row.scene.as_str());
        }
    }
    scenes
}

/// Runs a SUMO configuration up to a time and writes its fcd-output, every 0.1 s.
pub type Record<'a> = dyn FnMut(&Path, &Path, Second) -> Result<()> + 'a;
