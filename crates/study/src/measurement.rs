//! The study's data: an axis for each choice, and a row for each method on each set of items.

use std::path::{Path, PathBuf};

use serde::Serialize;
use strum::{IntoStaticStr, VariantArray};

use closecall::util::units::Second;
use closecall::util::variants::array;
use closecall_run::Result;

/// A choice in closecall's design.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, Serialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Axis {
    /// The test whether two rectangles touch.
    Volume,
    /// The search for pairs that are near each other.
    Candidates,
    /// Positions checked at intervals, or swept.
    Time,
    /// The model of μ, or integration of the braking equations.
    Braking,
    /// How long a driver can wait: in closed form, or by small steps.
    Late,
    /// The quadrature of the crash probability, or draws.
    Probability,
    /// The crash probability by the formula, or by roll-outs in SUMO.
    RollOuts,
    /// f32 or f64, and the origin of coordinates.
    Numbers,
    /// How exactly a turn is swept.
    Turning,
    /// The window of states from which the curvature of an arc is taken.
    Curvature,
    /// The prediction of a road user's path.
    Path,
    /// The decimals and the period of a recording.
    Recording,
    /// How deep an overlap is a collision.
    Tolerance,
    /// The measures that are logged only if they are chosen.
    Measures,
    /// The intervals and tests of statistics, on known processes.
    Coverage,
}

impl Axis {
    /// All axes, in the order of tables and charts.
    pub const ALL: [Self; Self::VARIANTS.len()] = array(Self::VARIANTS);

    /// Whether its items are runs of SUMO.
    pub fn needs_sumo(self) -> bool {
        matches!(self, Self::RollOuts | Self::Path | Self::Recording | Self::Tolerance | Self::Measures)
    }

    /// The name in files and tables.
    pub fn name(self) -> &'static str {
        self.into()
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
    /// The definition of the error.
    pub error_name: &'static str,
    /// The error, 0 for none.
    pub error: f64,
    /// The share of true cases that the method misses.
    pub false_negative_rate: f64,
    /// The share of false cases that the method reports, or of its reports that are false.
    pub false_positive_rate: f64,
    /// The median run time per item.
    pub ns_per_item: f64,
    /// The number of items of each run.
    pub items: usize,
    /// Whether no other method on the same items has less error in less time.
    pub on_pareto_front: bool,
    /// The set of items; only methods on the same set are compared.
    #[serde(skip)]
    pub scene: String,
    /// Whether this is closecall's choice.
    #[serde(skip)]
    pub default: bool,
}

/// The extent of a study.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Fewer items and repetitions, so that all axes take about two minutes.
    pub quick: bool,
    /// The folder of the scenarios for the axes that need SUMO.
    pub nets: PathBuf,
}

impl Measurement {
    /// The kind of traffic of a scene of [`Axis::Candidates`], without its number of road users.
    pub(super) fn traffic(&self) -> &str {
        self.scene.split(", ").next().unwrap_or_default()
    }
}

/// Runs a SUMO configuration up to a time and writes its fcd-output, every 0.1 s.
pub type Recorder<'a> = dyn FnMut(&Path, &Path, Second) -> Result<()> + 'a;

/// Runs a SUMO configuration up to a time, with steps of 0.1 s, and rolls out its worst conflict: the count is the last argument.
pub type Roller<'a> = dyn FnMut(&Path, Second, u32) -> Result<RolledOut> + 'a;

/// A conflict that was rolled out.
#[derive(Clone, Debug)]
pub struct RolledOut {
    /// When it opened, in s.
    pub begin: Second,
    /// The processor time before the first roll-out: of the run that saves the states and of the baselines, in s.
    pub before: Second,
    /// Whether each roll-out has a contact, and its processor time in s.
    pub roll_outs: Vec<(bool, Second)>,
}

/// What an axis has SUMO do.
pub enum Simulator<'a> {
    /// Recordings.
    Record(&'a mut Recorder<'a>),
    /// Roll-outs.
    RollOut(&'a mut Roller<'a>),
}
