//! Work that a run skips where the scene does not need it; `--no-shortcuts` disables all shortcuts, or those it names.

use serde::Serializer;

/// Work that a scene may not need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
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
    pub const ALL: [Self; 4] = [Self::AreasApart, Self::PathsApart, Self::InLine, Self::KnownPaths];
    /// Their names.
    #[cfg(feature = "clap")]
    pub(super) const ALL_NAMES: [&str; 4] = ["areas-apart", "paths-apart", "in-line", "known-paths"];
}

/// Writes whether these are all.
pub(super) fn are_all<S: Serializer>(shortcuts: &[Shortcut], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_bool(Shortcut::ALL.iter().all(|one| shortcuts.contains(one)))
}
