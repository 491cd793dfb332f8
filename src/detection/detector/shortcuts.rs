//! The shortcuts of a run: all but those that the options disable.

use crate::options::Options;
use crate::options::shortcut::Shortcut;

/// The shortcuts of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shortcuts {
    /// [`Shortcut::AreasApart`].
    pub areas_apart: bool,
    /// [`Shortcut::PathsApart`].
    pub paths_apart: bool,
    /// [`Shortcut::InLine`].
    pub in_line: bool,
    /// [`Shortcut::KnownPaths`].
    pub known_paths: bool,
    /// [`Shortcut::KnownChances`].
    pub known_chances: bool,
}

impl Shortcuts {
    /// All but those that these options disable.
    pub fn of(options: &Options) -> Self {
        let shortcuts = |what| !options.no_shortcuts.contains(&what);
        Self {
            areas_apart: shortcuts(Shortcut::AreasApart),
            paths_apart: shortcuts(Shortcut::PathsApart),
            in_line: shortcuts(Shortcut::InLine),
            known_paths: shortcuts(Shortcut::KnownPaths),
            known_chances: shortcuts(Shortcut::KnownChances),
        }
    }
}
