//! The data that both phases share for each road user of a step, and how far it reaches until it stands.

use typed_index_collections::TiSlice;

use super::cover::{Cover, reach};
use super::last_speed::LastSpeed;
use super::paths::{PathSource, Paths};
use super::shortcuts::Shortcuts;
use crate::braking::stopping_distance_paper;
use crate::detection::broad_phase::{Area, Circle, Slot};
use crate::detection::path::track::Track;
use crate::geometry::movement::TOLERANCE;
use crate::geometry::rectangle::{Rectangle, direction};
use crate::geometry::{Bounds, Vector};
use crate::options::{Mode, Options, PathModel};
use crate::traffic::frame::{Frame, Row, State};
use crate::traffic::profile::Category;
use crate::traffic::roster::{ProfileIndex, Roster, UserIndex};
use crate::util::units::{Metre, Radian};

/// Whether a road user moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    /// It has a speed.
    Moves,
    /// It stands, and moved in the step before.
    HasStopped,
    /// It has entered the scene, or was put elsewhere, after the moment to which the others are moved back: where it was then is
    /// not known.
    Appears,
    /// It stands, and stood in the step before or has just entered the scene.
    Rests,
}

/// A road user in the current step, besides its row of the frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct User {
    pub heading: Radian,
    /// Unit vector of the heading.
    pub axis: Vector,
    /// Its row of the frame.
    pub row: u32,
    pub index: UserIndex,
    pub profile: ProfileIndex,
    pub category: Category,
    pub motion: Motion,
    /// Whether it goes straight on until it stands: without lanes or an arc, or on a lane that leads straight on.
    pub ahead: bool,
    pub on_lanes: bool,
    /// Whether it is seen as its carriages, because they do not stand and stay in one line.
    pub bends: bool,
}

/// The current step, as both phases read it.
#[derive(Clone, Copy)]
pub(super) struct StepView<'a> {
    pub frame: &'a Frame,
    pub roster: &'a Roster,
    pub turns: PathSource,
    pub epsilon: Metre,
    /// Whether road users are moved back to a moment before the end of the step.
    pub is_earlier: bool,
    pub on_lanes: &'a [bool],
    /// By [`UserIndex`], the speed in the last step that the road user was in.
    pub speeds: &'a TiSlice<UserIndex, LastSpeed>,
    pub paths: Paths<'a>,
}

/// A row of the frame and its road user's type.
#[derive(Clone, Copy, Default)]
pub(super) struct RowView {
    pub row: Row,
    pub profile: ProfileIndex,
}

impl StepView<'_> {
    /// Reads a row.
    #[inline]
    pub fn see(&self, row: u32) -> RowView {
        let row = self.frame.row(row);
        RowView { row, profile: self.roster.type_of(row.user) }
    }

    /// The road user of a row. Mostly it was also the `last` in its slot; where the heading is the same, so is the axis,
    /// and sine and cosine are not computed again.
    // Always inlined: as a call it would write the result twice, at 15 ns per road user.
    #[inline(always)]
    pub fn user(&self, row: u32, seen: &RowView, last: &User) -> User {
        let RowView { row: Row { user: index, ref state }, profile: type_index } = *seen;
        let (profile, moves) = (self.roster.profile_at(type_index), state.moves());
        let axis = if last.heading == state.heading { last.axis } else { direction(state.heading) };
        let on_lanes = self.turns.has_tracks() && self.on_lanes[row as usize];
        let goes_straight = || {
            let (track, lines) = self.paths.track(index);
            let length = if profile.carriages > 1 { profile.length } else { profile.chord };
            track.goes_straight(lines, &axis, length, reach(state, profile, self.epsilon))
        };
        let ahead = match self.turns {
            PathSource::Straight => true,
            PathSource::Arcs => profile.category == Category::Obstacle,
            PathSource::Lanes | PathSource::Driven if on_lanes => goes_straight(),
            PathSource::Lanes => !moves || profile.category != Category::Vehicle,
            PathSource::Driven => true,
        };
        let last = || self.speeds.get(index);
        let is_new = || last().is_none_or(|last| last.speed.is_nan());
        let bends = profile.carriages > 1 && on_lanes && !ahead && {
            let (track, lines) = self.paths.track(index);
            !track.is_straight(lines, profile.length, reach(state, profile, self.epsilon))
        };
        User {
            heading: state.heading,
            axis,
            row,
            index,
            profile: type_index,
            category: profile.category,
            motion: match moves {
                _ if self.is_earlier && is_new() => Motion::Appears,
                true => Motion::Moves,
                false if last().is_some_and(|last| last.speed > 0.0) => Motion::HasStopped,
                false => Motion::Rests,
            },
            ahead,
            on_lanes,
            bends,
        }
    }

    /// A road user predicted beyond where it stands, so that it may turn on the way: on its lanes, also if it stands on them.
    pub fn further(&self, user: &User) -> User {
        let has_path = || self.paths.of(user.index).is_some_and(|path| !path.track.is_empty());
        let may_have = match self.turns {
            PathSource::Lanes => user.category == Category::Vehicle,
            PathSource::Driven => user.category != Category::Obstacle,
            PathSource::Straight | PathSource::Arcs => false,
        };
        let on_lanes = user.on_lanes || (may_have && has_path());
        let ahead = user.ahead && !on_lanes;
        let bends = on_lanes && !ahead && self.roster.profile_at(user.profile).carriages > 1;
        User { on_lanes, ahead, bends, ..*user }
    }
}

impl Default for User {
    /// An empty slot.
    fn default() -> Self {
        Self {
            heading: 0.0,
            axis: Vector::new(1.0, 0.0),
            row: 0,
            index: UserIndex(0),
            profile: ProfileIndex(0),
            category: Category::Obstacle,
            motion: Motion::Rests,
            ahead: true,
            on_lanes: false,
            bends: false,
        }
    }
}

impl Slot for User {
    fn item(&self) -> u32 {
        self.row
    }

    fn set_item(&mut self, item: u32) {
        self.row = item;
    }

    fn who(&self) -> u32 {
        self.index.0
    }
}

/// How far road users reach until they stand, or further.
#[derive(Clone, Copy)]
pub(super) struct Reach<'a> {
    frame: &'a Frame,
    roster: &'a Roster,
    paths: Paths<'a>,
    epsilon: Metre,
    cover: Cover,
    /// Whether a known path is searched by the box around it, not by a circle.
    has_boxes: bool,
    /// Whether the paper's circle and stopping distance apply.
    on_paper: bool,
    /// Whether road users without lanes turn.
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
        let cover = Cover::UntilTheyStand;
        Self { frame, roster, paths, epsilon: options.epsilon, cover, has_boxes, on_paper, on_arcs }
    }

    /// The same with another cover.
    pub(super) fn with(self, cover: Cover) -> Self {
        Self { cover, ..self }
    }

    /// The area that a road user may cover within the cover and ε further.
    pub(super) fn area(&self, user: &User) -> Area {
        self.area_of(user, self.frame.state(user.row))
    }

    /// The same for a state already read.
    // Always inlined, for the same reason as `user`.
    #[inline(always)]
    pub(super) fn area_of(&self, user: &User, state: &State) -> Area {
        let (profile, front) = (self.roster.profile_at(user.profile), state.front());
        let reach = if self.on_paper {
            stopping_distance_paper(state.speed, &profile.brakes) + self.epsilon
        } else {
            self.cover.reach(state, profile, self.epsilon)
        };
        if user.category == Category::Obstacle {
            let mut bounds = Bounds::EMPTY;
            self.roster.shape(user.index).iter().for_each(|part| bounds.join(&part.bounds));
            return bounds.into();
        }
        let drawn_length = self.paths.drawn_length(user.index, profile.length);
        if user.ahead && self.has_boxes {
            let (front, length) = (front + user.axis * reach, drawn_length + reach);
            let beside = if user.on_lanes { Track::beside_heading(length) } else { 0.0 };
            let bounds = Rectangle::behind(front, user.axis, length, profile.width).bounds();
            return bounds.grown(TOLERANCE + beside).into();
        }
        if user.bends || (user.on_lanes && self.has_boxes) {
            // The front of each carriage is on the line; no part of it is further from there than this.
            let beside = drawn_length + profile.width / 2.0;
            let behind = if user.bends { profile.length } else { 0.0 };
            let (track, lines) = self.paths.track(user.index);
            return track.bounds(lines, behind, reach).grown(TOLERANCE + beside).into();
        }
        if self.on_arcs {
            // Its tail swings out and may reach further than its front.
            let behind = profile.length.hypot(profile.width / 2.0);
            return Circle { x: front.x, y: front.y, radius: reach + behind + TOLERANCE }.into();
        }
        let centre = front - user.axis * (drawn_length / 2.0);
        let diagonal = (drawn_length * drawn_length + profile.width * profile.width).sqrt();
        Circle { x: centre.x, y: centre.y, radius: reach + diagonal / 2.0 }.into()
    }
}
