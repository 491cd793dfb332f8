//! One run, from its first frame to its summary: the detector, the events and the log, in the order of the flow.
//!
//! A source of road users (SUMO, a recording, a script's arrays) drives the run. For each step it calls
//! [`Run::begin_step`], pushes a row into [`Run::frame`] per road user, and calls [`Run::step`] with a function that
//! sets the placement of the rows that the run asks for. A [`recorded::RecordedRun`] adds the log around the steps.

mod obstacles;
mod own_making;
pub mod recorded;
pub mod step;
mod warm_up;
mod writing;

use std::collections::VecDeque;
use std::sync::Arc;

use own_making::OwnMaking;
use rustc_hash::FxHashSet;

use crate::detection::detector::Detector;
use crate::detection::detector::shortcuts::Shortcuts;
use crate::detection::encounter::Encounter;
use crate::events::{Alarm, Clips, Conflict, PetSoFar, Tracker};
use crate::geometry::Point;
use crate::options::measures::Measures;
use crate::options::{ClipLevel, Options};
use crate::output::formats::Outputs;
use crate::output::log::Log;
use crate::output::summary::{Skipped, Summary};
use crate::traffic::frame::{Frame, Row, State};
use crate::traffic::lane_change::LaneChangeReason;
use crate::traffic::net::filter::Filter;
use crate::traffic::net::{LaneIndex, Net};
use crate::traffic::placement::Placement;
use crate::traffic::profile::{Category, obstacle_name};
use crate::traffic::roster::{ProfileIndex, Roster, UserIndex};
use crate::traffic::signals::Signals;
use crate::util::units::{Metre, Second};
use crate::{Error, Result};
use warm_up::WarmUp;
use writing::Writing;

/// Steps longer than this are worth a remark, in s: on our nets the rate of conflicts at 0.2 s is off by 2 to 24 %, at 0.1 s
/// by 0 to 10 % (docs/step_length.md). The fourth digit is room for rounding in the times of recordings.
const LONG_STEP: Second = 0.1001;

/// One run.
pub struct Run {
    /// The road users in the scene.
    pub roster: Roster,
    /// The road users of the step under way.
    pub frame: Frame,
    detector: Detector,
    net: Option<Arc<Net>>,
    filter: Option<Filter>,
    tracker: Tracker,
    warm_up: WarmUp,
    writing: Writing,
    /// None where no log wants them.
    clips: Option<Clips>,
    /// The closed conflicts that are kept in memory, and how many there may be: the latest.
    conflicts: VecDeque<Conflict>,
    most_conflicts: usize,
    leaving: Vec<UserIndex>,
    obstacles: Vec<(UserIndex, Point)>,
    /// The rows whose placement the step under way needs.
    unplaced: Vec<u32>,
    /// The pairs of ids of which SUMO reports a collision in the step under way; none where it is not asked.
    collided: Option<Vec<[String; 2]>>,
    /// What the traffic lights show; empty where that is not known.
    signals: Signals,
    /// All such pairs so far, each in the order of the ids.
    collided_so_far: FxHashSet<[String; 2]>,
    /// Placements asked for so far.
    lane_lookups: u64,
    contact_tolerance: Metre,
    /// Settings of single types: as the options name the type, and as the roster does.
    type_settings: Vec<(String, String)>,
    /// How long a step lasts: as the source says, or else the time between the first two steps.
    step_length: Option<Second>,
    summary: Summary,
    own_making: OwnMaking,
}

impl Run {
    /// A run that keeps its conflicts in memory.
    ///
    /// # Errors
    /// [`Error::File`], [`Error::Line`] or [`Error::Content`] that names the filter's file and what is wrong with it.
    pub fn new(options: &Options, net: Option<Arc<Net>>) -> Result<Self> {
        let filter = match (&options.filter, &net) {
            (Some(path), Some(net)) => Some(Filter::read(path, net)?),
            (Some(path), None) => return Err(Error::content(path, "a filter needs a net")),
            (None, _) => None,
        };
        let mut detector = Detector::new(options, net.clone());
        detector.set_conflicts_only(true);
        Ok(Self {
            roster: Roster::default(),
            frame: Frame::default(),
            detector,
            net,
            filter,
            tracker: Tracker::new(options),
            warm_up: WarmUp::new(options.warmup),
            writing: Writing::default(),
            clips: None,
            conflicts: VecDeque::new(),
            most_conflicts: usize::MAX,
            leaving: Vec::new(),
            obstacles: Vec::new(),
            unplaced: Vec::new(),
            collided: None,
            signals: Signals::default(),
            collided_so_far: FxHashSet::default(),
            lane_lookups: 0,
            contact_tolerance: options.contact_tolerance,
            type_settings: type_settings(options),
            step_length: None,
            summary: Summary::default(),
            own_making: OwnMaking::default(),
        })
    }

    /// What the user should know before the run: how the net is drawn, and whether steps of this length are too long.
    pub fn opening_remarks(&self, step_length: Option<Second>) -> Vec<String> {
        let net = self.net.iter().flat_map(|net| net.remarks(self.detector.overlaps(), self.contact_tolerance));
        let steps = step_length.filter(|length| *length > LONG_STEP).map(|length| {
            format!(
                "steps of {length} s are long: what happens within a step is not seen, so that counts and TTC depend on the \
                 step length; 0.1 s is better (SUMO's --step-length), and closecall study SCENARIO measures by how much"
            )
        });
        net.chain(steps).collect()
    }

    /// Writes the conflicts to a log too, with clips from this severity on.
    pub fn set_log(&mut self, log: Log, clips: ClipLevel) {
        self.writing.log = Some(log);
        self.clips = Clips::new(clips);
    }

    /// Counts closed conflicts, but does not keep them in memory for [`Run::conflicts`].
    pub fn drop_closed_conflicts(&mut self) {
        self.keep_closed_conflicts(0);
    }

    /// Keeps at most this many closed conflicts in memory for [`Run::conflicts`], the latest.
    pub fn keep_closed_conflicts(&mut self, most: usize) {
        self.most_conflicts = most;
    }

    /// Why the log and the other files are no longer written, if that is so.
    pub fn log_error(&self) -> Option<&str> {
        self.writing.error.as_deref()
    }

    /// Writes other files besides the log.
    fn set_outputs(&mut self, outputs: Outputs) {
        if outputs.want_lanes() {
            self.detector.keep_asking_for_lanes();
        }
        self.writing.outputs = outputs;
    }

    /// States how long a step lasts; by default as long as the time between the first two.
    pub fn set_step_length(&mut self, length: Second) {
        self.step_length = Some(length);
    }

    /// How long a step lasts, if it is known.
    pub fn step_length(&self) -> Option<Second> {
        self.step_length
    }

    /// The shortcuts that the run takes.
    pub fn shortcuts(&self) -> Shortcuts {
        self.detector.shortcuts()
    }

    /// Checks each step with this many threads, at least one. The number does not change the results.
    pub fn set_threads(&mut self, threads: usize) {
        self.detector.set_threads(threads);
    }

    /// States whether every road user keeps its route while it is in the scene; by default routes may change.
    pub fn set_fixed_routes(&mut self, fixed: bool) {
        self.detector.set_fixed_routes(fixed);
    }

    /// States whether road users move sideways without changing lanes (SUMO's sublane model).
    pub fn set_sublane(&mut self, sublane: bool) {
        self.detector.set_sublane(sublane);
    }

    /// Whether road users move sideways without changing lanes.
    pub fn sublane(&self) -> bool {
        self.detector.sublane()
    }

    /// The measures that are computed besides those that every run has.
    pub fn measures(&self) -> Measures {
        self.detector.measures()
    }

    /// Whether no road user's route changes while it is in the scene.
    pub fn has_fixed_routes(&self) -> bool {
        self.detector.has_fixed_routes()
    }

    /// States over which share of a step, up to its end, a road user's speed is the mean: 1 for SUMO's Euler update, 0 for its
    /// ballistic one and for measured speeds.
    pub fn set_averaged_over(&mut self, share: f64) {
        self.detector.set_averaged_over(share);
    }

    /// Whether road users are moved back by half a step, to the moment to which their speeds belong.
    pub fn aligns(&self) -> bool {
        self.detector.aligns()
    }

    /// A vehicle or person enters the scene; the roster has its profile.
    pub fn enter(&mut self, id: &str, profile: ProfileIndex) -> UserIndex {
        let user = self.roster.enter(id, profile);
        self.warm_up.enter(self.roster.profile_of(user).category, &mut self.summary.exposure);
        user
    }

    /// The numbers of vehicles and persons that ever were in the scene, in the warm-up too.
    pub fn entered(&self) -> [u64; 2] {
        self.warm_up.entered()
    }

    /// A road user leaves the scene; it must not be in a later frame.
    pub fn leave(&mut self, user: UserIndex) {
        self.warm_up.leave(self.roster.profile_of(user).category);
        self.leaving.push(user);
    }

    /// Begins the step at `time`, with an empty frame.
    pub fn begin_step(&mut self, time: Second) {
        if let Some(last) = self.time() {
            self.step_length.get_or_insert(time - last);
            self.count_exposure(time - last);
        }
        if self.summary.steps == 0 {
            self.summary.begin = time;
        }
        self.warm_up.begin_step(time);
        self.summary.steps += u64::from(self.warm_up.is_over());
        self.summary.end = time;
        self.frame.begin(time);
        for &(user, corner) in &self.obstacles {
            self.frame.push(user, State { x: corner.x, y: corner.y, z: 0.0, heading: 0.0, speed: 0.0 });
        }
    }

    /// States the pairs of ids of which SUMO reports a collision in the step under way.
    pub fn set_collisions_of_sumo(&mut self, collided: Vec<[String; 2]>) {
        let counted = collided.iter().filter(|_| self.warm_up.is_over()).cloned();
        self.collided_so_far.extend(counted.map(|mut pair| {
            pair.sort_unstable();
            pair
        }));
        self.summary.collisions_sumo.get_or_insert_default().reported = self.collided_so_far.len() as u64;
        self.collided = Some(collided);
    }

    /// States what a traffic light, by its place in [`Net::lights`], shows in the step under way.
    pub fn set_signal(&mut self, light: u32, state: &str) {
        self.signals.set(light, self.frame.time, state);
    }

    /// The time of the step under way, if one has begun.
    pub fn time(&self) -> Option<Second> {
        self.warm_up.has_begun().then_some(self.frame.time)
    }

    /// Counts the traffic of the frame's step, which lasted this long, unless it was a step of the warm-up.
    fn count_exposure(&mut self, lasted: Second) {
        if !self.warm_up.is_over() {
            return;
        }
        let exposure = &mut self.summary.exposure;
        for Row { user, state } in self.frame.rows() {
            if self.roster.profile_of(user).category == Category::Vehicle {
                exposure.vehicle_kilometres += state.speed * lasted / 1e3;
                exposure.vehicle_hours += lasted / 3600.0;
            }
        }
    }

    /// Whether the road user of a row is still on its predicted path, so that its lane is not needed as long as its
    /// route is the same.
    pub fn keeps_path(&self, row: u32) -> bool {
        !self.writing.outputs.want_lanes() && self.detector.keeps_path(row)
    }

    /// Whether the route last given for a road user is known from this position in it.
    pub fn knows_route(&self, user: UserIndex, position: usize) -> bool {
        self.detector.knows_route(user, position)
    }

    /// Sets where on the net the road user of a row is.
    pub fn set_placement(&mut self, row: u32, placement: &Placement) {
        self.detector.set_placement(&self.frame, &self.roster, row, placement);
        self.writing.outputs.place(row, placement);
    }

    /// By how many lanes the road user of a row has changed in the step under way, positive towards lanes of a higher index;
    /// none if it has not. Its placement is set.
    pub fn changed_lanes(&self, row: u32) -> Option<i32> {
        let change = self.detector.lane_change(self.frame.user(row)).filter(|change| change.time == self.frame.time)?;
        let index = |lane: LaneIndex| Some(self.net.as_ref()?.lanes[lane.0 as usize].index as i32);
        Some(index(change.to)? - index(change.from)?)
    }

    /// States why the road user of a row has changed lanes in this step: SUMO's `vehicle.getLaneChangeState`.
    pub fn set_lane_change_state(&mut self, row: u32, state: i32) {
        self.detector.set_lane_change_reason(self.frame.user(row), LaneChangeReason::of(state));
    }

    /// The pairs that met the log's condition in the last step, or will with the PET of their events.
    pub fn in_conflict(&self) -> impl ExactSizeIterator<Item = &Encounter> {
        self.detector.encounters()
    }

    /// The expected path of a road user's front bumper, from where it is; empty where it is absent in this step.
    pub fn path(&self, user: UserIndex) -> Vec<Point> {
        let row = self.frame.row_of(user);
        row.map_or_else(Vec::new, |row| self.detector.path(&self.frame, &self.roster, row))
    }

    /// The conflicts that are still open in this step.
    pub fn alarms(&self) -> impl Iterator<Item = Alarm> {
        self.tracker.alarms()
    }

    /// The conflicts that are over and wait for their PET, as in their last step.
    pub fn waiting(&self) -> impl Iterator<Item = Alarm> {
        self.tracker.waiting()
    }

    /// The PET of an open or waiting conflict, or its lower bound in this step.
    pub fn pet_so_far(&self, alarm: &Alarm) -> Option<PetSoFar> {
        let ahead = |user| {
            let row = self.frame.row_of(user);
            row.map(|row| self.detector.ahead(&self.frame, &self.roster, row)).unwrap_or_default()
        };
        self.tracker.pet_so_far(alarm, ahead)
    }

    /// The number of the first of [`Run::conflicts`], as in the log: closed conflicts before it are no longer in memory.
    pub fn first_number(&self) -> u64 {
        self.closed_conflicts() + 1 - self.conflicts.len() as u64
    }

    /// The closed conflicts that are kept in memory, in the order in which they closed.
    pub fn closed(&self) -> impl Iterator<Item = &Conflict> {
        self.conflicts.iter()
    }

    /// The closed conflicts that are kept in memory, then the open ones as they are now.
    pub fn conflicts(&self) -> Vec<Conflict> {
        self.conflicts.iter().cloned().chain(self.tracker.open(&self.roster)).collect()
    }

    /// The net, if there is one.
    pub fn net(&self) -> Option<&Net> {
        self.net.as_deref()
    }

    /// What was found so far, open conflicts included.
    pub fn summary(&self) -> Summary {
        let mut summary = self.summary.clone();
        for conflict in self.tracker.open(&self.roster) {
            summary.add(&conflict);
        }
        summary
    }

    /// The number of conflicts that have closed so far.
    pub fn closed_conflicts(&self) -> u64 {
        self.summary.count(None, None)
    }

    /// Closes the open conflicts and writes them; returns the summary.
    ///
    /// # Errors
    /// [`Error::File`] that names what cannot be written; the run is over then too, and counted.
    pub fn finish(&mut self) -> Result<Summary> {
        self.count_exposure(self.step_length.unwrap_or_default());
        let first = self.closed_conflicts() + 1;
        let closed = self.tracker.finish(&self.roster);
        let clips = self.clips.as_mut().map_or_else(Vec::new, |clips| clips.finish(closed, first));
        let written = self.writing.finish(closed, &clips, &self.roster, self.net.as_deref());
        count(closed, &mut self.summary, &mut self.conflicts, self.most_conflicts);
        closed.iter().for_each(|conflict| self.own_making.count(conflict, &self.roster, self.net.as_deref()));
        self.summary.left_out = self.detector.left_out();
        self.summary.skipped = Skipped::of(&self.detector.work(), self.lane_lookups);
        let unmet = self.type_settings.iter().filter(|(_, name)| !self.roster.has_any_of(name));
        let remarks = unmet.map(|(setting, _)| format!("{setting}: no road user of this type was in the scene"));
        let own_making = self.own_making.remarks(&self.roster);
        self.summary.remarks = remarks.chain(self.warm_up.remark()).chain(own_making).collect();
        written.map(|()| self.summary.clone())
    }
}

/// The settings of single types in order, each with the profile name of road users of that type.
fn type_settings(options: &Options) -> Vec<(String, String)> {
    let types = options.types.keys().map(|name| (format!("[type.{name}]"), name.clone()));
    let obstacles = options.obstacles.iter().map(|name| (format!("obstacles {name}"), obstacle_name(name)));
    let mut settings = types.chain(obstacles).collect::<Vec<_>>();
    settings.sort_unstable();
    settings
}

/// Counts closed conflicts, and keeps the latest `most` of them.
fn count(closed: &[Conflict], summary: &mut Summary, kept: &mut VecDeque<Conflict>, most: usize) {
    for conflict in closed {
        summary.add(conflict);
    }
    let new = &closed[closed.len().saturating_sub(most)..];
    kept.drain(..(kept.len() + new.len()).saturating_sub(most).min(kept.len()));
    kept.extend(new.iter().cloned());
}
