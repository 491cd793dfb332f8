//! A table of trajectories, and what its columns are.

use std::path::Path;

use super::mapping::Mapping;

/// A file, and how it is read.
pub(super) struct Table<'a> {
    pub path: &'a Path,
    pub mapping: Mapping,
    /// The names of its columns.
    pub names: Vec<String>,
}
