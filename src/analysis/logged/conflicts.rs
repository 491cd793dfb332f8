//! What the place of a logged conflict tells.

use crate::output::schema::LoggedConflict;

impl LoggedConflict {
    /// The edge of the conflict point; empty without a lane.
    pub fn edge(&self) -> &str {
        self.lane.rsplit_once('_').map_or("", |(edge, _)| edge)
    }

    /// The junction of the conflict point; empty where it is not within one.
    pub fn junction(&self) -> &str {
        let within = self.edge().strip_prefix(':');
        within.and_then(|edge| edge.rsplit_once('_')).map_or("", |(junction, _)| junction)
    }
}
