//! The conflicts of which a run keeps clips.

use serde::Serialize;

/// The mildest severity of which `clips.jsonl.gz` has clips.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum ClipLevel {
    /// No clips.
    None,
    /// All conflicts.
    Caution,
    /// Serious and critical ones.
    Serious,
    /// Critical ones.
    #[default]
    Critical,
}

impl ClipLevel {
    /// Whether it is the default.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }
}
