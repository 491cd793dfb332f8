//! Where the road users are and how far each needs to stop; the broad phase: which pairs may meet before they stand.

use std::ops::Range;

use super::Detector;
use super::last_speed::LastSpeed;
use super::paths::{PathSource, Paths, lines_of};
use super::reach::{Reach, StepView};
use crate::detection::path::lanes::LanePath;
use crate::detection::path::turning::Turning;
use crate::options::{Mode, PathModel};
use crate::traffic::frame::{Frame, Row, State};
use crate::traffic::profile::{Category, Profile};
use crate::traffic::roster::{Roster, UserIndex};
use crate::util::index::make_room;
use crate::util::limits::{FEWEST_PAIRS, PAIRS};
use crate::util::threads::share;
use crate::util::units::{Metre, MetrePerSecond};

/// Pairs in one step if every pair is kept; they take half a gibibyte.
const MOST_OF_ALL: usize = 1 << 26;
/// Road users whose pairs are found before it is asked whether there are too many.
const PIECE: usize = 1024;
/// Between two steps a road user may be this many times as fast as in both: recordings leave out steps.
const FASTER: f64 = 2.0;
/// It may have been moved this far besides, in m: a vehicle that SUMO parks or lets start.
const LEAST_DRIVEN: Metre = 5.0;

impl Detector {
    /// Where road users are too many for the step to be checked: the one with the most others near it.
    pub fn crowd(&self, frame: &Frame, roster: &Roster) -> Option<String> {
        if !self.is_crowded {
            return None;
        }
        let mut near = vec![0_u32; self.search.slots().len()];
        for (a, b) in self.pairs.iter().flatten() {
            near[*a as usize] += 1;
            near[*b as usize] += 1;
        }
        let (user, others) = self.search.slots().iter().zip(near).max_by_key(|(_, others)| *others)?;
        let (id, state) = (roster.id(user.index), frame.state(user.row));
        Some(format!(
            "too many road users in one place: \"{id}\" at ({:.1}, {:.1}) is near at least {others} others",
            state.x, state.y
        ))
    }

    /// Checks which road users are still on their paths. Returns the rows of the frame whose lane the detector needs for
    /// both phases. The caller sets it with [`Detector::set_placement`], and skips those it cannot place.
    ///
    /// A path built in another step may differ within the tolerance of being on it. So every road user is followed,
    /// whether in a pair or not, and what the broad phase leaves out changes no path.
    pub fn track_paths(&mut self, frame: &Frame, roster: &Roster) -> &[u32] {
        if self.paths.len() < roster.len() {
            make_room(&mut self.paths.raw, roster.len());
            self.paths.resize_with(roster.len(), LanePath::default);
        }
        self.step = (frame.time - self.time).max(0.0);
        self.time = frame.time;
        self.work.rows += frame.len() as u64;
        self.unplaced.clear();
        self.redo_jumps();
        self.on_lanes.clear();
        self.on_lanes.resize(frame.len(), false);
        if self.turns() == PathSource::Driven {
            self.lay_driven(frame, roster);
        }
        if self.turns() == PathSource::Lanes {
            for (row, Row { user, state }) in frame.rows().enumerate() {
                let profile = roster.profile_of(user);
                if profile.category != Category::Vehicle {
                    continue;
                }
                if state.moves() {
                    self.keep_on_path(row, user, profile, &state);
                } else {
                    self.stop_on_path(row, user, profile, &state);
                    // It still bends along the path on which it came.
                    self.on_lanes[row] = profile.carriages > 1 && !self.paths[user].track.is_empty();
                }
            }
        }
        &self.unplaced
    }

    /// The broad phase: finds the pairs that may meet.
    pub fn broad_phase(&mut self, frame: &Frame, roster: &Roster) {
        self.lengthen_all(frame, roster);
        self.update_areas(frame, roster);
        if self.turns() == PathSource::Arcs {
            self.turnings.resize_with(self.paths.len(), Turning::default);
            self.turn(frame);
        }
        self.find_pairs(frame, roster);
    }

    /// Where paths come from.
    pub(super) fn turns(&self) -> PathSource {
        match self.options.path {
            _ if self.options.mode == Mode::Paper => PathSource::Straight,
            PathModel::Arc => PathSource::Arcs,
            PathModel::Driven => PathSource::Driven,
            PathModel::Lanes if self.net.is_some() => PathSource::Lanes,
            PathModel::Lanes | PathModel::Straight => PathSource::Straight,
        }
    }

    /// Updates every road user's slot and area.
    fn update_areas(&mut self, frame: &Frame, roster: &Roster) {
        let (turns, epsilon) = (self.turns(), self.options.epsilon);
        let paths = Paths::new(&self.paths, self.net.as_deref());
        let sight = StepView {
            frame,
            roster,
            turns,
            epsilon,
            is_earlier: self.behind() > 0.0,
            on_lanes: &self.on_lanes,
            speeds: &self.speeds,
            paths,
        };
        let reach = Reach::new(frame, roster, &self.options, self.shortcuts, paths).with(self.cover());
        let (this_step, look) = ((roster.changes(), frame.len()), self.look);
        let are_same = std::mem::replace(&mut self.last_step, this_step) == this_step;
        self.search.update(
            frame.len(),
            &self.team,
            are_same,
            |user| frame.row_of(UserIndex(user)),
            |row| sight.see(row),
            |seen, user| {
                *user = sight.user(user.row, seen, user);
                match look {
                    None => reach.area_of(user, &seen.row.state),
                    Some(_) => reach.area_of(&sight.further(user), &seen.row.state),
                }
            },
        );
        self.users_further.clear();
        if self.look.is_some() {
            self.users_further.extend(self.search.slots().iter().map(|user| sight.further(user)));
        }
        self.take_speeds(frame);
    }

    /// Takes the speeds of the step, and forgets what is known of road users that are absent from it: SUMO's teleports put
    /// them elsewhere.
    fn take_speeds(&mut self, frame: &Frame) {
        make_room(&mut self.speeds.raw, self.paths.len());
        self.speeds.resize(self.paths.len(), LastSpeed::default());
        let (count, step) = (self.speeds.len(), self.step);
        let busy = self.team.busy(count);
        let share = share(busy, count);
        let parts = self.speeds.raw.chunks_mut(share).enumerate();
        self.team.each(self.workers.iter_mut().take(busy), parts, |worker, (part, speeds)| {
            for (user, last) in (part * share..).zip(speeds) {
                let user = UserIndex(user as u32);
                match frame.row_of(user) {
                    Some(row) => last.take(frame.state(row).speed, step),
                    None if last.is_known() => worker.absent.push(user),
                    None => {}
                }
            }
        });
        for number in 0..busy {
            while let Some(user) = self.workers[number].absent.pop() {
                self.lose(user);
            }
        }
    }

    /// Updates the curvature of the paths, where they are arcs.
    fn turn(&mut self, frame: &Frame) {
        for user in self.search.slots() {
            let front = frame.state(user.row).front();
            self.turnings[user.index].see(frame.time, front, user.axis);
        }
    }

    /// Finds the pairs whose areas meet, each thread its part.
    fn find_pairs(&mut self, frame: &Frame, roster: &Roster) {
        let paths = Paths::new(&self.paths, self.net.as_deref());
        let reach = Reach::new(frame, roster, &self.options, self.shortcuts, paths).with(self.cover());
        let users = if self.look.is_some() { &self.users_further } else { self.search.slots() };
        let (search, count, all) = (&self.search, self.search.slots().len(), !self.shortcuts.areas_apart);
        let busy = self.team.busy(count);
        let share = share(busy, count);
        let parts = (0..count.div_ceil(share)).map(|part| part * share..count.min((part + 1) * share));
        self.pairs.iter_mut().for_each(Vec::clear);
        let most = if all { MOST_OF_ALL } else { FEWEST_PAIRS.max(count * PAIRS.count()) };
        self.team.each(self.pairs.iter_mut().take(busy), parts, |pairs, part| {
            // A crowd in one place makes a billion near pairs: those found so far suffice to refuse it.
            for piece in part.clone().step_by(PIECE).map(|start| start..part.end.min(start + PIECE)) {
                if pairs.len() > most {
                    break;
                }
                let area = |slot: u32| reach.area(&users[slot as usize]);
                let mut found = |a: u32, b: u32| pairs.push((a, b));
                match (all, search.has_round()) {
                    (true, _) => every_pair(piece, &mut found),
                    (false, false) => search.sweep(piece, &mut found),
                    (false, true) => search.sweep(piece, |a, b| {
                        if area(a).circles_meet(&area(b)) {
                            found(a, b);
                        }
                    }),
                }
            }
        });
        let found = self.pairs.iter().map(|pairs| pairs.len() as u64).sum::<u64>();
        self.is_crowded = found > most as u64;
        self.work.areas_apart += all_pairs(count) - found;
        self.work.pairs += found;
    }

    /// Follows a row's path along the lanes, or adds it to those whose lane is needed.
    fn keep_on_path(&mut self, row: usize, user: UserIndex, profile: &Profile, state: &State) {
        let of_net = lines_of(self.net.as_deref());
        let driven = self.driven_at_most(user, state.speed);
        self.on_lanes[row] = self.paths[user].follow(of_net, state.front(), driven);
        if !self.on_lanes[row] {
            self.take_jump(row as u32, user, profile, state);
        }
        if self.shortcuts.known_paths && !self.routes_may_change && self.on_lanes[row] {
            self.work.known_paths += 1;
        } else {
            self.unplaced.push(row as u32);
        }
    }

    /// How far a road user may have driven in this step, with a reserve: where one lane leads back beside the other, the way
    /// to a place across may be far.
    pub(super) fn driven_at_most(&self, user: UserIndex, speed: MetrePerSecond) -> Metre {
        let last = self.speeds.get(user).map_or(f64::NAN, |last| last.speed);
        if last.is_nan() { f64::INFINITY } else { FASTER * last.max(speed) * self.step + LEAST_DRIVEN }
    }

    /// Follows the path of a vehicle that has stopped, and removes it if the vehicle stopped elsewhere. Where lanes are
    /// longer or shorter than drawn, the lane of a vehicle without a path is needed, as its drawn length depends on it.
    fn stop_on_path(&mut self, row: usize, user: UserIndex, profile: &Profile, state: &State) {
        let of_net = lines_of(self.net.as_deref());
        let driven = self.driven_at_most(user, 0.0);
        let path = &mut self.paths[user];
        if !path.track.is_empty()
            && !path.track.is_at(path.lines(of_net), state.front())
            && !path.follow(of_net, state.front(), driven)
        {
            self.take_jump(row as u32, user, profile, state);
            self.paths[user].clear();
        }
        let of_net = lines_of(self.net.as_deref());
        let path = &self.paths[user];
        if path.track.is_empty() && of_net.is_stretched() {
            self.unplaced.push(row as u32);
        }
    }
}

/// Pairs each of these slots with all before it.
fn every_pair(slots: Range<usize>, mut found: impl FnMut(u32, u32)) {
    for slot in slots {
        (0..slot).for_each(|other| found(other as u32, slot as u32));
    }
}

/// The number of pairs among `count` road users.
fn all_pairs(count: usize) -> u64 {
    let count = count as u64;
    count * count.saturating_sub(1) / 2
}
