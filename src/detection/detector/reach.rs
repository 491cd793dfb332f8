//! What both phases know of each road user in the current step, and how far it reaches until it stands.

use super::shortcuts::Shortcuts;
use crate::braking::{stopping_distance, stopping_distance_paper};
use crate::detection::broad_phase::{Area, Circle, Slot};
use crate::detection::path::lanes::LanePath;
use crate::detection::path::track::Track;
use crate::geometry::polylines::Lines;
use crate::geometry::rectangle::{Rectangle, direction};
use crate::geometry::sweep::TOLERANCE;
use crate::geometry::{Bounds, Point, Vector};
use crate::options::{Mode, Options, PathModel};
use crate::traffic::frame::{Frame, Row, State};
use crate::traffic::net::{LaneIndex, Net};
use crate::traffic::profile::{Category, Profile};
use crate::traffic::roster::{ProfileIndex, Roster, UserIndex};
use crate::util::units::{Metre, Radian};

/// How a road user turns, as far as the last two steps tell.
#[derive(Clone, Debug, Default)]
pub(super) struct Turning {
    pub last: Option<(Point, Vector)>,
    pub curvature: f64,
}

/// What the phases know of a road user in the step under way, besides its row of the frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct User {
    pub heading: Radian,
    /// Where that leads.
    pub axis: Vector,
    /// Which row of the frame.
    pub row: u32,
    pub index: UserIndex,
    pub profile: ProfileIndex,
    pub category: Category,
    /// Whether it goes straight on until it stands: it has no lanes and no arc, or its lane leads straight on.
    pub ahead: bool,
    pub on_lanes: bool,
}

/// What makes road users turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PathSource {
    Straight,
    Arcs,
    Lanes,
}

/// Everybody's path, and the lines of the net's lanes, on which most of them are.
#[derive(Clone, Copy)]
pub(super) struct Paths<'a> {
    paths: &'a [LanePath],
    of_net: &'a Lines,
}

impl<'a> Paths<'a> {
    pub(super) fn new(paths: &'a [LanePath], net: Option<&'a Net>) -> Self {
        Self { paths, of_net: lines_of(net) }
    }

    /// Where somebody is, and on which lines.
    pub(super) fn track(&self, user: UserIndex) -> (&'a Track, &'a Lines) {
        let path = &self.paths[user.0 as usize];
        (&path.track, path.lines(self.of_net))
    }

    /// The lane at a way ahead of somebody.
    pub(super) fn lane_at(&self, user: UserIndex, way: Metre) -> Option<LaneIndex> {
        self.paths[user.0 as usize].lane_at(self.of_net, way)
    }
}

pub(super) fn lines_of(net: Option<&Net>) -> &Lines {
    net.map_or(Lines::NONE, |net| &net.lines)
}

/// What the step under way says of everybody.
#[derive(Clone, Copy)]
pub(super) struct StepView<'a> {
    pub frame: &'a Frame,
    pub roster: &'a Roster,
    pub turns: PathSource,
    pub epsilon: Metre,
    pub on_lanes: &'a [bool],
    pub paths: Paths<'a>,
}

/// What is said of who stands in a row, fetched from where it is.
#[derive(Clone, Copy, Default)]
pub(super) struct RowView {
    pub row: Row,
    pub profile: ProfileIndex,
}

impl StepView<'_> {
    /// What is said of who stands in a row.
    #[inline]
    pub fn see(&self, row: u32) -> RowView {
        let row = self.frame.row(row);
        RowView { row, profile: self.roster.type_of(row.user) }
    }

    /// Who stands in a row. Whoever was `last` in its slot is mostly the same: one that heads as it did has the same axis,
    /// without asking for sine and cosine.
    // Always: by a call it would be written twice, and the second time wait for the first, 15 ns per road user.
    #[inline(always)]
    pub fn user(&self, row: u32, seen: &RowView, last: &User) -> User {
        let RowView { row: Row { user: index, ref state }, profile: type_index } = *seen;
        let (profile, moves) = (self.roster.profile_at(type_index), state.moves());
        let axis = if last.heading == state.heading { last.axis } else { direction(state.heading) };
        let on_lanes = self.turns == PathSource::Lanes && self.on_lanes[row as usize];
        let goes_straight = || {
            let (track, lines) = self.paths.track(index);
            track.goes_straight(lines, &axis, profile.chord, stop(state, profile) + self.epsilon)
        };
        User {
            heading: state.heading,
            axis,
            row,
            index,
            profile: type_index,
            category: profile.category,
            ahead: match self.turns {
                PathSource::Straight => true,
                PathSource::Arcs => profile.category == Category::Obstacle,
                PathSource::Lanes if on_lanes => goes_straight(),
                PathSource::Lanes => !moves || profile.category != Category::Vehicle,
            },
            on_lanes,
        }
    }
}

impl Default for User {
    /// Nobody yet.
    fn default() -> Self {
        Self {
            heading: 0.0,
            axis: Vector::new(1.0, 0.0),
            row: 0,
            index: UserIndex(0),
            profile: ProfileIndex(0),
            category: Category::Obstacle,
            ahead: true,
            on_lanes: false,
        }
    }
}

impl Slot for User {
    fn item(&self) -> u32 {
        self.row
    }

    fn give(&mut self, item: u32) {
        self.row = item;
    }

    fn who(&self) -> u32 {
        self.index.0
    }
}

/// How far somebody of this type still moves.
#[inline(always)]
pub(super) fn stop(state: &State, profile: &Profile) -> Metre {
    if state.moves() { stopping_distance(state.speed, &profile.brakes) } else { 0.0 }
}

/// How far road users reach until they stand.
#[derive(Clone, Copy)]
pub(super) struct Reach<'a> {
    frame: &'a Frame,
    roster: &'a Roster,
    paths: Paths<'a>,
    epsilon: Metre,
    /// Whether whose way is known has a box around that.
    has_boxes: bool,
    /// Whether the distance counts, whichever way that is, and the stopping distance is that of the paper.
    on_paper: bool,
    /// Whether who has no lanes turns.
    on_arcs: bool,
}

impl<'a> Reach<'a> {
    pub(super) fn new(
        frame: &'a Frame,
        roster: &'a Roster,
        options: &Options,
        shortcuts: Shortcuts,
        paths: Paths<'a>,
    ) -> Self {
        let on_paper = options.mode == Mode::Paper;
        let has_boxes = shortcuts.paths_apart && !on_paper;
        let on_arcs = options.path == PathModel::Arc && !on_paper;
        Self { frame, roster, paths, epsilon: options.epsilon, has_boxes, on_paper, on_arcs }
    }

    /// What somebody may cover until it stands, and ε further.
    pub(super) fn area(&self, user: &User) -> Area {
        self.area_of(user, self.frame.state(user.row))
    }

    /// The same of somebody whose state is at hand.
    // Always, for the same reason.
    #[inline(always)]
    pub(super) fn area_of(&self, user: &User, state: &State) -> Area {
        let (profile, front) = (self.roster.profile_at(user.profile), state.front());
        let stop =
            if self.on_paper { stopping_distance_paper(state.speed, &profile.brakes) } else { stop(state, profile) };
        let reach = stop + self.epsilon;
        if user.category == Category::Obstacle {
            let mut bounds = Bounds::EMPTY;
            self.roster.shape(user.index).iter().for_each(|part| bounds.join(&part.bounds));
            return bounds.into();
        }
        if user.ahead && self.has_boxes {
            let (front, length) = (front + user.axis * reach, profile.length + reach);
            let beside = if user.on_lanes { Track::beside_heading(length) } else { 0.0 };
            let bounds = Rectangle::behind(front, user.axis, length, profile.width).bounds();
            return bounds.grown(TOLERANCE + beside).into();
        }
        if user.on_lanes && self.has_boxes {
            // Its front is on the line ahead, the rest of it nowhere further from there than that.
            let behind = profile.length + profile.width / 2.0;
            let (track, lines) = self.paths.track(user.index);
            return track.bounds_ahead(lines, reach).grown(TOLERANCE + behind).into();
        }
        if self.on_arcs {
            // Its tail swings out: it may get further than its front.
            let behind = profile.length.hypot(profile.width / 2.0);
            return Circle { x: front.x, y: front.y, radius: reach + behind + TOLERANCE }.into();
        }
        let centre = front - user.axis * (profile.length / 2.0);
        let diagonal = (profile.length * profile.length + profile.width * profile.width).sqrt();
        Circle { x: centre.x, y: centre.y, radius: reach + diagonal / 2.0 }.into()
    }
}
