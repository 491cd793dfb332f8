//! Frame in, encounters out: both phases, one after the other.
//!
//! A pure function of the frames and placements it was given so far: no clock, no randomness, no input or output. One
//! thread updates what is kept between steps, in `candidates` and here. The modules that only read it (`occupancy`,
//! `encounters`, `encounter_values`) run on as many threads as the caller wants, each on its part of the pairs. The results are
//! the same for any number of threads.

mod candidates;
mod chances;
mod course_ahead;
mod cover;
mod driving;
mod encounter_values;
mod encounters;
mod jump;
mod lane_jumps;
mod last_speed;
mod left_out;
mod level;
mod meet;
mod moved_back;
mod neighbours;
mod occupancy;
mod on_request;
mod one_between;
mod overlap;
mod paths;
mod placing;
mod reach;
mod row_order;
pub mod shortcuts;
mod step;
mod straight_pair;
mod timely;
mod work_counts;
mod worker;

use std::iter::repeat_n;
use std::sync::Arc;
use std::time::{Duration, Instant};

use typed_index_collections::TiVec;

use super::broad_phase::Search;
use super::course::LaneChange;
use super::encounter::Encounter;
use super::path::driven::DrivenPlaces;
use super::path::lanes::LanePath;
use super::path::turning::Turning;
use crate::braking::MuModel;
use crate::options::condition::LookAhead;
use crate::options::{Mode, Options};
use crate::traffic::frame::{Frame, State};
use crate::traffic::net::{Net, Overlaps};
use crate::traffic::roster::{Roster, UserIndex};
use crate::util::limits::{ENCOUNTERS, FEWEST_ENCOUNTERS};
use crate::util::threads::{Team, share};
use crate::util::units::{Metre, Second};
use cover::Cover;
use jump::Jump;
use last_speed::LastSpeed;
use one_between::OneBetween;
use paths::Paths;
use reach::{Reach, StepView, User};
use row_order::RowOrder;
use shortcuts::Shortcuts;
use step::StepInputs;
use worker::Worker;

/// Two road users further apart in height than this are not a pair, in m: one is on a bridge.
const LEVEL: Metre = 2.5;

pub use left_out::LeftOut;
pub use work_counts::Work;

/// Finds the encounters of one step after the other.
pub struct Detector {
    work: Work,
    options: Options,
    shortcuts: Shortcuts,
    net: Option<Arc<Net>>,
    /// The lanes of the net that overlap as drawn.
    overlaps: Overlaps,
    routes_may_change: bool,
    sublane: bool,
    /// Over which share of a step, up to its end, a speed is the mean.
    averaged_over: f64,
    /// The rows that have changed lanes in this step, and by how much, if road users are moved back.
    jumps: Vec<Jump>,
    /// The paths of those on the lanes to which they have jumped.
    next_paths: Vec<(UserIndex, LanePath)>,
    /// Those that jumped at the end of the last step.
    jumped: Vec<UserIndex>,
    conflicts_only: bool,
    /// The time of the step, in s; infinite before the first.
    time: Second,
    /// How long the step before took; 0 before the second.
    step: Second,
    /// How far the log's condition looks beyond where both stand; none where it does not.
    look: Option<LookAhead>,
    /// By slot, the road users with reach extended by the look-ahead; empty without one.
    users_further: Vec<User>,
    /// By [`UserIndex`], as long as the road user is in the scene.
    paths: TiVec<UserIndex, LanePath>,
    /// By [`UserIndex`]; empty unless paths are what was driven.
    driven: TiVec<UserIndex, DrivenPlaces>,
    /// By [`UserIndex`]; empty unless paths are arcs.
    turnings: TiVec<UserIndex, Turning>,
    /// By row of the frame, whether the road user is on its path along lanes.
    on_lanes: Vec<bool>,
    /// By [`UserIndex`], the speed in the last step that the road user was in, and the deceleration since the one before.
    speeds: TiVec<UserIndex, LastSpeed>,
    /// By [`UserIndex`], the state that was reported in that step; empty unless road users are moved back.
    reported: TiVec<UserIndex, State>,
    /// By [`UserIndex`], the last change of lanes; none where there was none, or beyond the end.
    lane_changes: TiVec<UserIndex, Option<LaneChange>>,
    /// The road users of the step in slots; those that meet are close in memory.
    search: Search<User>,
    /// The roster's changes until the last step, and the number of road users in that step.
    last_step: (u64, usize),
    order: RowOrder,
    unplaced: Vec<u32>,
    /// By thread, the slots of the pairs whose areas meet.
    pairs: Vec<Vec<(u32, u32)>>,
    workers: Vec<Worker>,
    one_between: OneBetween,
    /// Whether the step has more pairs than can be checked.
    is_crowded: bool,
    team: Team,
    /// How long the narrow phase of the last step takes one thread, about.
    narrow_phase_alone: Duration,
}

impl Detector {
    /// A detector for a scene; without a net every path is straight (or an arc, if so chosen).
    pub fn new(options: &Options, net: Option<Arc<Net>>) -> Self {
        Self {
            work: Work::default(),
            options: options.clone(),
            shortcuts: Shortcuts::of(options),
            overlaps: net.as_ref().map(|net| net.overlaps()).unwrap_or_default(),
            net,
            routes_may_change: true,
            sublane: false,
            averaged_over: 0.0,
            jumps: Vec::new(),
            next_paths: Vec::new(),
            jumped: Vec::new(),
            reported: TiVec::new(),
            conflicts_only: false,
            time: f64::INFINITY,
            step: 0.0,
            look: look_ahead(options),
            users_further: Vec::new(),
            paths: TiVec::new(),
            driven: TiVec::new(),
            turnings: TiVec::new(),
            on_lanes: Vec::new(),
            speeds: TiVec::new(),
            lane_changes: TiVec::new(),
            search: Search::default(),
            last_step: (0, 0),
            order: RowOrder::default(),
            unplaced: Vec::new(),
            pairs: vec![Vec::new()],
            workers: vec![Worker::default()],
            one_between: OneBetween::default(),
            is_crowded: false,
            team: Team::default(),
            narrow_phase_alone: Duration::ZERO,
        }
    }

    /// Sets the number of threads, at least one; the results are the same.
    pub fn set_threads(&mut self, threads: usize) {
        self.team = Team::new(threads);
        self.pairs.resize_with(self.team.threads(), Vec::new);
        self.workers.resize_with(self.team.threads(), Worker::default);
        for (number, worker) in (0..).zip(&mut self.workers) {
            worker.found.chances.worker = number;
        }
    }

    /// Sets whether routes stay the same while a road user is in the scene. A path then holds until the road user leaves
    /// it. By default routes may change.
    pub fn set_fixed_routes(&mut self, fixed: bool) {
        self.routes_may_change = !fixed;
    }

    /// Whether routes stay the same while a road user is in the scene.
    pub fn has_fixed_routes(&self) -> bool {
        !self.routes_may_change
    }

    /// Sets whether road users move sideways without changing lanes (SUMO's sublane model).
    pub fn set_sublane(&mut self, sublane: bool) {
        self.sublane = sublane;
    }

    /// Whether road users move sideways without changing lanes.
    pub fn sublane(&self) -> bool {
        self.sublane
    }

    /// Sets whether [`Detector::narrow_phase`] may leave out encounters that no condition asks for.
    pub fn set_conflicts_only(&mut self, only: bool) {
        self.conflicts_only = only;
    }

    /// Asks for the lane of every vehicle in every step, because an output needs it.
    pub fn keep_asking_for_lanes(&mut self) {
        self.shortcuts.known_paths = false;
    }

    /// The lanes of the net that overlap as drawn.
    pub fn overlaps(&self) -> &Overlaps {
        &self.overlaps
    }

    /// The shortcuts that are taken.
    pub fn shortcuts(&self) -> Shortcuts {
        self.shortcuts
    }

    /// Both phases of one step for road users without a placement: without a net, or with straight paths.
    ///
    /// With a net call [`Detector::track_paths`], [`Detector::set_placement`] for the rows that it returns,
    /// [`Detector::broad_phase`] and [`Detector::narrow_phase`].
    pub fn step(&mut self, frame: &Frame, roster: &Roster) -> impl ExactSizeIterator<Item = &Encounter> + Clone {
        self.track_paths(frame, roster);
        self.broad_phase(frame, roster);
        self.narrow_phase(frame, roster)
    }

    /// What was left out so far.
    pub fn left_out(&self) -> Vec<LeftOut> {
        left_out::left_out(&self.work(), self.shortcuts)
    }

    /// The work done so far.
    pub fn work(&self) -> Work {
        let known_chances = self.workers.iter().map(|worker| worker.found.chances.left_out()).sum();
        Work { sorted_anew: self.search.sorted_anew(), known_chances, ..self.work }
    }

    /// Forgets a road user that has left the scene, as its index may be given to another.
    pub fn forget(&mut self, user: UserIndex) {
        self.lose(user);
        if let Some(places) = self.driven.get_mut(user) {
            places.clear();
        }
    }

    /// Forgets what was known of a road user that is not in the step.
    fn lose(&mut self, user: UserIndex) {
        self.next_paths.retain(|(other, _)| *other != user);
        if let Some(path) = self.paths.get_mut(user) {
            path.clear();
        }
        if let Some(speed) = self.speeds.get_mut(user) {
            *speed = LastSpeed::default();
        }
        if let Some(change) = self.lane_changes.get_mut(user) {
            *change = None;
        }
        if let Some(turning) = self.turnings.get_mut(user) {
            turning.clear();
        }
    }

    /// The narrow phase: finds the pairs that would meet, in the order of the frame's rows. Call
    /// [`Detector::broad_phase`] with the same frame first.
    pub fn narrow_phase(
        &mut self,
        frame: &Frame,
        roster: &Roster,
    ) -> impl ExactSizeIterator<Item = &Encounter> + Clone {
        let mut workers = std::mem::take(&mut self.workers);
        for worker in &mut workers {
            worker.found.clear();
            worker.occupancy.begin(self.search.slots().len());
            worker.further.begin(self.users_further.len());
        }
        let scene = self.scene(frame, roster);
        // What the last step took tells how many threads this one is worth: a pair takes 0.05 to 10 µs.
        let begun = Instant::now();
        let threads = self.team.busy_for(self.narrow_phase_alone);
        let share = share(threads, self.pairs.iter().map(Vec::len).sum());
        let parts = self.pairs.iter().flat_map(|pairs| pairs.chunks(share));
        let most = FEWEST_ENCOUNTERS.max(frame.len() * ENCOUNTERS.count());
        self.team.each(workers.iter_mut().take(threads), parts, |worker, pairs| scene.meet_all(worker, pairs, most));
        self.is_crowded |= workers.iter().map(|worker| worker.found.encounters.len()).sum::<usize>() > most;
        for (_, met) in workers.iter().flat_map(|worker| &worker.found.unmeasured) {
            for slot in met.slots {
                let scene = self.scene(frame, roster).as_met(met.further);
                let user = *scene.user(slot);
                if user.on_lanes {
                    let ahead = scene.distance_to_measure(&user, &met.meeting);
                    self.lengthen(roster, &user, ahead);
                }
            }
        }
        let scene = self.scene(frame, roster);
        let has_more = |worker: &Worker| !worker.found.unmeasured.is_empty();
        let busy = workers.iter().filter(|worker| has_more(worker)).count();
        let parts = workers.iter_mut().filter(|worker| has_more(worker));
        self.team.each(repeat_n((), busy), parts, |(), worker| scene.measure_all(worker));
        self.narrow_phase_alone = begun.elapsed() * threads as u32;
        self.order.sort(frame.len(), &workers);
        for worker in &mut workers {
            self.work += std::mem::take(&mut worker.work);
            worker.found.scratch.halves.shrink();
        }
        self.workers = workers;
        self.encounters()
    }

    /// The encounters of the last step that were retained.
    pub fn encounters(&self) -> impl ExactSizeIterator<Item = &Encounter> + Clone {
        self.order.sorted(&self.workers)
    }

    /// Keeps only the encounters for which `keep` returns true.
    pub fn retain(&mut self, keep: impl FnMut(&mut Encounter) -> bool) {
        self.order.retain(&mut self.workers, keep);
    }

    /// The step as both phases read it.
    fn sight<'a>(&'a self, frame: &'a Frame, roster: &'a Roster) -> StepView<'a> {
        let (turns, epsilon) = (self.turns(), self.options.epsilon);
        StepView {
            frame,
            roster,
            turns,
            epsilon,
            is_earlier: self.behind() > 0.0,
            on_lanes: &self.on_lanes,
            speeds: &self.speeds,
            paths: self.all_paths(),
        }
    }

    fn all_paths(&self) -> Paths<'_> {
        Paths::new(&self.paths, self.net.as_deref())
    }

    fn scene<'a>(&'a self, frame: &'a Frame, roster: &'a Roster) -> StepInputs<'a> {
        StepInputs {
            options: &self.options,
            shortcuts: self.shortcuts,
            conflicts_only: self.conflicts_only,
            frame,
            roster,
            flat_net: self.net.as_deref().filter(|net| net.rise() < LEVEL),
            overlaps: &self.overlaps,
            paths: self.all_paths(),
            turnings: &self.turnings,
            speeds: &self.speeds,
            reach: Reach::new(frame, roster, &self.options, self.shortcuts, self.all_paths()),
            users: self.search.slots(),
            cover: Cover::UntilTheyStand,
            look: self.look,
            users_further: &self.users_further,
        }
    }

    /// The furthest prediction of pairs.
    fn cover(&self) -> Cover {
        self.look.map_or(Cover::UntilTheyStand, Cover::Further)
    }
}

/// How far pairs have to be looked for beyond where both stand; none where they have not.
fn look_ahead(options: &Options) -> Option<LookAhead> {
    let look = LookAhead { rss: options.mu == MuModel::Rss, ..options.log.look_ahead() };
    (options.mode == Mode::Closecall && !look.is_none()).then_some(look)
}
