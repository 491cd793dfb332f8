//! Who is where and how far each needs to stand; phase 1: which pairs may meet before they do.

use std::ops::Range;

use super::{Detector, Turning, User};
use crate::braking::{stopping_distance, stopping_distance_paper};
use crate::frame::{Frame, ProfileIndex, Roster, Row, State, UserIndex};
use crate::geometry::lines::Lines;
use crate::geometry::rectangle::{Rectangle, direction};
use crate::geometry::sweep::TOLERANCE;
use crate::geometry::{Bounds, Point, Vector};
use crate::net::{LaneIndex, Net};
use crate::options::{Mode, Options, PathModel};
use crate::path::lanes::LanePath;
use crate::path::track::Track;
use crate::path::{arc, turn};
use crate::precollision::{Area, Circle, Slot};
use crate::profile::{Category, Profile};
use crate::scene::Exclusions;
use crate::table::{add, fill};
use crate::team::share;
use crate::units::Metre;

impl Detector {
    /// Who is still on its path. Returns the frame's rows whose lane the detector has to know for both phases; the caller
    /// says it with [`Detector::place`], and leaves out whom it cannot place.
    ///
    /// A path that is laid in another step may be another one, within what counts as being on it: so everybody is
    /// followed, in a pair or not, and what phase 1 leaves out changes no path.
    pub fn follow(&mut self, frame: &Frame, roster: &Roster) -> &[u32] {
        if self.paths.len() < roster.len() {
            fill(&mut self.paths, roster.len(), LanePath::default());
        }
        self.work.rows += frame.len() as u64;
        self.unplaced.clear();
        self.on_lanes.clear();
        fill(&mut self.on_lanes, frame.len(), false);
        if self.turns() == Turns::ByLanes {
            for (row, Row { user, state }) in frame.rows().enumerate() {
                if state.moves() && roster.profile_of(user).category == Category::Vehicle {
                    self.keep_on_path(row, user, state.front());
                }
            }
        }
        &self.unplaced
    }

    /// Phase 1: which pairs may meet.
    pub fn approach(&mut self, frame: &Frame, roster: &Roster) {
        self.lengthen_all(frame, roster);
        self.look(frame, roster);
        if self.turns() == Turns::ByArcs {
            fill(&mut self.turnings, self.paths.len(), Turning::default());
            self.turn(frame);
        }
        self.find_pairs(frame, roster);
    }

    /// What makes road users turn.
    pub(super) fn turns(&self) -> Turns {
        match self.options.path {
            _ if self.options.mode == Mode::Paper => Turns::Not,
            PathModel::Arc => Turns::ByArcs,
            PathModel::Lanes if self.net.is_some() => Turns::ByLanes,
            PathModel::Lanes | PathModel::Straight => Turns::Not,
        }
    }

    /// Everybody in its slot, with the area of now.
    fn look(&mut self, frame: &Frame, roster: &Roster) {
        let (turns, epsilon) = (self.turns(), self.options.epsilon);
        let paths = Paths::new(&self.paths, self.net.as_deref());
        let sight = Sight { frame, roster, turns, epsilon, on_lanes: &self.on_lanes, paths };
        let reach = Reach::new(frame, roster, &self.options, self.leaves_out, paths);
        let who_is_there = (roster.changes(), frame.len());
        let are_same = std::mem::replace(&mut self.who_was_there, who_is_there) == who_is_there;
        self.search.lay(
            frame.len(),
            &self.team,
            are_same,
            |user| frame.row_of(UserIndex(user)),
            |row| sight.see(row),
            |seen, user| {
                *user = sight.user(user.row, seen, user);
                reach.area_of(user, &seen.row.state)
            },
        );
    }

    /// How the paths of now turn, where they are arcs.
    fn turn(&mut self, frame: &Frame) {
        for user in self.search.slots() {
            let front = frame.state(user.row).front();
            let turning = &mut self.turnings[user.index.0 as usize];
            if let Some((last, last_axis)) = turning.last {
                turning.curvature = arc::curvature(turn(&last_axis, &user.axis), (front - last).norm());
            }
            turning.last = Some((front, user.axis));
        }
    }

    /// The pairs whose areas meet, those that each thread has found.
    fn find_pairs(&mut self, frame: &Frame, roster: &Roster) {
        let paths = Paths::new(&self.paths, self.net.as_deref());
        let reach = Reach::new(frame, roster, &self.options, self.leaves_out, paths);
        let (search, count, all) = (&self.search, self.search.slots().len(), !self.leaves_out.circles_apart);
        let busy = self.team.busy(count);
        let share = share(busy, count);
        let parts = (0..count.div_ceil(share)).map(|part| part * share..count.min((part + 1) * share));
        self.pairs.iter_mut().for_each(Vec::clear);
        self.team.each(self.pairs.iter_mut().take(busy), parts, |pairs, part| {
            let mut found = |a: u32, b: u32| add(pairs, (a, b));
            let area = |slot: u32| reach.area(&search.slots()[slot as usize]);
            match (all, search.has_round()) {
                (true, _) => every_pair(part, &mut found),
                (false, false) => search.sweep(part, &mut found),
                (false, true) => search.sweep(part, |a, b| {
                    if area(a).circles_meet(&area(b)) {
                        found(a, b);
                    }
                }),
            }
        });
        let found = self.pairs.iter().map(|pairs| pairs.len() as u64).sum::<u64>();
        self.work.circles_apart += all_pairs(count) - found;
        self.work.pairs += found;
    }

    /// Follows a row's path along the lanes, or asks for its lane.
    fn keep_on_path(&mut self, row: usize, user: UserIndex, front: Point) {
        let of_net = lines_of(self.net.as_deref());
        self.on_lanes[row] = self.paths[user.0 as usize].follow(of_net, front);
        if self.leaves_out.known_paths && !self.routes_may_change && self.on_lanes[row] {
            self.work.known_paths += 1;
        } else {
            self.unplaced.push(row as u32);
        }
    }
}

/// What makes road users turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turns {
    Not,
    ByArcs,
    ByLanes,
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

fn lines_of(net: Option<&Net>) -> &Lines {
    net.map_or(Lines::NONE, |net| &net.lines)
}

/// What the step under way says of everybody.
#[derive(Clone, Copy)]
pub(super) struct Sight<'a> {
    pub frame: &'a Frame,
    pub roster: &'a Roster,
    pub turns: Turns,
    pub epsilon: Metre,
    pub on_lanes: &'a [bool],
    pub paths: Paths<'a>,
}

/// What is said of who stands in a row, fetched from where it is.
#[derive(Clone, Copy, Default)]
pub(super) struct Seen {
    row: Row,
    profile: ProfileIndex,
}

impl Sight<'_> {
    /// What is said of who stands in a row.
    #[inline]
    pub fn see(&self, row: u32) -> Seen {
        let row = self.frame.row(row);
        Seen { row, profile: self.roster.type_of(row.user) }
    }

    /// Who stands in a row. Whoever was `last` in its slot is mostly the same: one that heads as it did has the same axis,
    /// without asking for sine and cosine.
    // Always: by a call it would be written twice, and the second time wait for the first, 15 ns per road user.
    #[inline(always)]
    pub fn user(&self, row: u32, seen: &Seen, last: &User) -> User {
        let Seen { row: Row { user: index, ref state }, profile: type_index } = *seen;
        let (profile, moves) = (self.roster.profile_at(type_index), state.moves());
        let axis = if last.heading == state.heading { last.axis } else { direction(state.heading) };
        let on_lanes = self.turns == Turns::ByLanes && self.on_lanes[row as usize];
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
                Turns::Not => true,
                Turns::ByArcs => profile.category == Category::Obstacle,
                Turns::ByLanes if on_lanes => goes_straight(),
                Turns::ByLanes => !moves || profile.category != Category::Vehicle,
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

/// Each of these slots with all before it.
fn every_pair(slots: Range<usize>, mut found: impl FnMut(u32, u32)) {
    for slot in slots {
        (0..slot).for_each(|other| found(other as u32, slot as u32));
    }
}

/// How many pairs so many road users are.
fn all_pairs(count: usize) -> u64 {
    let count = count as u64;
    count * count.saturating_sub(1) / 2
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
        leaves_out: Exclusions,
        paths: Paths<'a>,
    ) -> Self {
        let on_paper = options.mode == Mode::Paper;
        let has_boxes = leaves_out.ways_apart && !on_paper;
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
