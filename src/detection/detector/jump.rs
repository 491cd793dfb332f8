//! What is kept of a road user that changes lanes: SUMO moves it to another lane at the end of a step.

use crate::detection::path::lanes::LanePath;
use crate::traffic::roster::UserIndex;

/// A road user that has jumped to another lane.
pub(super) struct Jump {
    /// Its row in the frame.
    pub row: u32,
    pub user: UserIndex,
    /// Its former path, on which it is at the moment of its speed.
    pub path: LanePath,
}
