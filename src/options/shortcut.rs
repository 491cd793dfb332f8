//! What a run leaves out where the scene does not need it, one by one: what `--keep` names.

use clap::ValueEnum;

/// Something that a scene may not need.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Shortcut {
    /// Pairs whose areas do not meet: phase 1. Kept, every pair goes on to phase 2.
    AreasApart,
    /// Accurate tests of pairs whose ways lie in boxes that do not meet.
    PathsApart,
    /// Sweeps of pairs that drive in line, for which one dimension is enough.
    InLine,
    /// Asking for the lane of who is still on the path laid before.
    KnownPaths,
}
