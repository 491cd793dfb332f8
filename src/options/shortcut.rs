//! Work that a run skips where the scene does not need it; `--no-shortcuts` disables all shortcuts, or those it names.

use serde::Serializer;
use strum::{IntoStaticStr, VariantArray};

/// Work that a scene may not need.
#[derive(Clone, Copy, Debug, PartialEq, Eq, IntoStaticStr, VariantArray)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[strum(serialize_all = "kebab-case")]
pub enum Shortcut {
    /// The broad phase leaves out pairs whose areas do not meet. If kept, every pair enters the narrow phase.
    #[cfg_attr(feature = "clap", value(alias = "areas_apart"))]
    AreasApart,
    /// The narrow phase leaves out pairs whose paths lie in boxes that do not meet.
    #[cfg_attr(feature = "clap", value(alias = "paths_apart"))]
    PathsApart,
    /// Pairs in line are not swept: one dimension is enough.
    #[cfg_attr(feature = "clap", value(alias = "in_line"))]
    InLine,
    /// A road user that is still on its known path is not asked for its lane.
    #[cfg_attr(feature = "clap", value(alias = "known_paths"))]
    KnownPaths,
    /// A crash probability is not worked out where an upper bound shows that it decides nothing.
    #[cfg_attr(feature = "clap", value(alias = "known_chances"))]
    KnownChances,
}

impl Shortcut {
    /// All of them.
    pub const ALL: &'static [Self] = Self::VARIANTS;

    /// The names of all.
    #[cfg(feature = "clap")]
    pub(super) fn names() -> impl Iterator<Item = &'static str> {
        Self::ALL.iter().map(|one| one.into())
    }
}

/// Writes whether these are all.
pub(super) fn are_all<S: Serializer>(shortcuts: &[Shortcut], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_bool(Shortcut::ALL.iter().all(|one| shortcuts.contains(one)))
}
