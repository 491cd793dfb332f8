//! The rules by which conflicts are serious or critical.

use serde::Serialize;

/// How the severity of a conflict is determined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum SeverityRule {
    /// By a table of how near a crash was and what it would have meant.
    #[default]
    Levels,
    /// By the time that is left and the probability of a crash, with settable thresholds.
    TimeLeft,
    /// By TTC (FHWA-HRT-08-051) and DRAC (Archer 2005), with settable thresholds.
    Fhwa,
    /// By the default thresholds of SUMO's device.ssm: TTC 3 s, DRAC 3 m/s².
    Ssm,
}
