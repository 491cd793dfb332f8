//! The state of a road user that changes lanes.

use crate::detection::path::lanes::LanePath;
use crate::traffic::roster::UserIndex;
use crate::util::units::Radian;

/// A road user that has jumped to another lane.
pub(super) struct Jump {
    /// Its row in the frame.
    pub row: u32,
    pub user: UserIndex,
    /// Its former path, on which it is at the moment of its speed.
    pub path: LanePath,
    /// Its heading there.
    pub heading: Radian,
}
