//! The paths of all road users, on the lines of the net or on their own.

use typed_index_collections::TiSlice;

use crate::detection::path::Pose;
use crate::detection::path::lanes::LanePath;
use crate::detection::path::track::Track;
use crate::geometry::movement::TOLERANCE;
use crate::geometry::polylines::Lines;
use crate::traffic::net::{LaneIndex, Net};
use crate::traffic::roster::UserIndex;
use crate::util::units::Metre;

/// Where paths come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PathSource {
    Straight,
    Arcs,
    Lanes,
    Driven,
}

impl PathSource {
    /// Whether road users have tracks that they follow.
    pub(super) fn has_tracks(self) -> bool {
        matches!(self, Self::Lanes | Self::Driven)
    }
}

/// All paths, and the lines of the net's lanes, which most of them follow.
#[derive(Clone, Copy)]
pub(super) struct Paths<'a> {
    paths: &'a TiSlice<UserIndex, LanePath>,
    of_net: &'a Lines,
}

impl<'a> Paths<'a> {
    pub(super) fn new(paths: &'a TiSlice<UserIndex, LanePath>, net: Option<&'a Net>) -> Self {
        Self { paths, of_net: lines_of(net) }
    }

    /// The lines of the net's lanes.
    pub(super) fn of_net(&self) -> &'a Lines {
        self.of_net
    }

    /// A road user's path, if it ever had one.
    pub(super) fn of(&self, user: UserIndex) -> Option<&'a LanePath> {
        self.paths.get(user)
    }

    /// A road user's track, and the lines that it is on.
    pub(super) fn track(&self, user: UserIndex) -> (&'a Track, &'a Lines) {
        let path = &self.paths[user];
        (&path.track, path.lines(self.of_net))
    }

    /// Whether distances along these poses, if they lie on a straight line, are those of the plane.
    pub(super) fn is_to_scale(&self, poses: &[Pose]) -> bool {
        match poses {
            [first, ..] if self.of_net.is_stretched() => {
                poses.iter().all(|pose| ((pose.front - first.front).norm() - pose.distance).abs() <= TOLERANCE)
            }
            _ => true,
        }
    }

    /// Metres of the plane per metre of the lane that a road user is on.
    pub(super) fn scale(&self, user: UserIndex) -> f64 {
        match self.of(user) {
            Some(path) if self.of_net.is_stretched() => path.track.scale(path.lines(self.of_net)),
            _ => 1.0,
        }
    }

    /// How long a road user of this length is as SUMO draws the lanes that it is on.
    pub(super) fn drawn_length(&self, user: UserIndex, length: Metre) -> Metre {
        match self.of(user) {
            Some(path) if self.of_net.is_stretched() => path.track.drawn_length(path.lines(self.of_net), length),
            _ => length,
        }
    }

    /// The lane at a distance ahead of a road user.
    pub(super) fn lane_at(&self, user: UserIndex, ahead: Metre) -> Option<LaneIndex> {
        self.paths[user].lane_at(self.of_net, ahead)
    }
}

pub(super) fn lines_of(net: Option<&Net>) -> &Lines {
    net.map_or(Lines::NONE, |net| &net.lines)
}
