//! Whether road users are moved back to the moment to which their speeds belong.

use serde::Serialize;

/// Whether road users are moved back by half a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Align {
    /// Where SUMO's Euler update has moved them.
    #[default]
    Auto,
    /// In every source of road users.
    Always,
    /// Nowhere.
    Never,
}
