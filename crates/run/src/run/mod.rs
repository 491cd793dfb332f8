//! One run, from its first frame to its summary: the detector, the events and the log, in the order of the flow.
//!
//! A source of road users (SUMO, a recording, a script's arrays) drives the run. For each step it calls
//! [`Run::begin_step`], pushes a row into [`Run::frame`] per road user, and calls [`Run::step`] with a function that
//! sets the placement of the rows that the run asks for. A [`recorded::RecordedRun`] adds the log around the steps.

mod entering;
mod net_faults;
mod obstacles;
mod ordinary_driving;
pub mod recorded;
mod results;
pub mod roll_out;
mod setup;
pub mod step;
mod touching_lanes;
mod warm_up;
mod writing;

use std::collections::VecDeque;
use std::sync::{Arc, OnceLock};

use entering::Entering;
use net_faults::NetFaults;
use ordinary_driving::OrdinaryDriving;
use rustc_hash::FxHashSet;

use crate::net::selection::Filter;
use crate::options::RunOptions;
use crate::output::summary::Summary;
use crate::{Error, Result};
use closecall::detection::detector::Detector;
use closecall::detection::path::driven::DrivenPlace;
use closecall::events::{Clips, Conflict, Tracker};
use closecall::geometry::Point;
use closecall::traffic::frame::{Frame, Row, State};
use closecall::traffic::lane_change::LaneChangeReason;
use closecall::traffic::net::{EdgeIndex, LaneIndex, Net};
use closecall::traffic::placement::Placement;
use closecall::traffic::profile::{Category, obstacle_name};
use closecall::traffic::roster::{ProfileIndex, Roster, UserIndex};
use closecall::traffic::signals::Signals;
use closecall::util::remark::Remark;
use closecall::util::units::{Metre, Second};
use warm_up::WarmUp;
use writing::Writing;

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
    /// The vehicles of [`Run::standing`] at a scheduled stop.
    stopped: Vec<UserIndex>,
    /// The edges of persons, of those of [`Run::persons_in_conflict`].
    edges: Vec<(UserIndex, EdgeIndex)>,
    /// All such pairs so far, each in the order of the ids.
    collided_so_far: FxHashSet<[String; 2]>,
    /// Placements asked for so far.
    lane_lookups: u64,
    contact_tolerance: Metre,
    counts_artefacts: bool,
    /// Whether the road users were tracked by sensors.
    is_tracked: bool,
    /// Settings of single types: as the options name the type, and as the roster does.
    type_settings: Vec<(String, String)>,
    /// How long a step lasts: as the source says, or else the time between the first two steps.
    step_length: Option<Second>,
    /// The remarks on the net, once they were asked for.
    net_remarks: OnceLock<Vec<Remark>>,
    summary: Summary,
    ordinary_driving: OrdinaryDriving,
    entering: Entering,
    net_faults: NetFaults,
}

impl Run {
    /// A run that keeps its conflicts in memory.
    ///
    /// # Errors
    /// [`Error::File`], [`Error::Line`] or [`Error::Content`] that names the filter's file and what is wrong with it.
    pub fn new(options: &RunOptions, net: Option<Arc<Net>>) -> Result<Self> {
        let filter = match (&options.log.filter, &net) {
            (Some(path), Some(net)) => Some(Filter::read(path, net)?),
            (Some(path), None) => return Err(Error::content(path, "a filter needs a net")),
            (None, _) => None,
        };
        let mut detector = Detector::new(&options.model, net.clone());
        detector.set_conflicts_only(true);
        Ok(Self {
            roster: Roster::default(),
            frame: Frame::default(),
            detector,
            net,
            filter,
            tracker: Tracker::new(&options.model, options.log.series_file().is_some()),
            warm_up: WarmUp::new(options.log.warmup),
            writing: Writing::default(),
            clips: None,
            conflicts: VecDeque::new(),
            most_conflicts: usize::MAX,
            leaving: Vec::new(),
            obstacles: Vec::new(),
            unplaced: Vec::new(),
            collided: None,
            signals: Signals::default(),
            stopped: Vec::new(),
            edges: Vec::new(),
            collided_so_far: FxHashSet::default(),
            lane_lookups: 0,
            contact_tolerance: options.model.contact_tolerance,
            counts_artefacts: options.model.artefacts,
            is_tracked: false,
            type_settings: type_settings(options),
            step_length: None,
            net_remarks: OnceLock::new(),
            summary: Summary::default(),
            ordinary_driving: OrdinaryDriving::default(),
            entering: Entering::default(),
            net_faults: NetFaults::default(),
        })
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
        self.stopped.clear();
        self.edges.clear();
        self.frame.begin(time);
        for &(user, corner) in &self.obstacles {
            self.frame.push(user, State { x: corner.x, y: corner.y, z: 0.0, heading: 0.0, speed: 0.0 });
        }
    }

    /// States whether the road users were tracked by sensors, whose errors are then looked for.
    pub fn set_tracked(&mut self, is_tracked: bool) {
        self.is_tracked = is_tracked;
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

    /// The vehicles that are there, were in conflict in the last step and stood then: whether they stop there is a cause.
    pub fn standing(&self) -> Vec<UserIndex> {
        self.tracker.standing().filter(|user| self.frame.row_of(*user).is_some()).collect()
    }

    /// States that one of [`Run::standing`] is at a scheduled stop, and does not park off the road.
    pub fn set_stopped(&mut self, user: UserIndex) {
        self.stopped.push(user);
    }

    /// The persons that are there and were in conflict in the last step, if there is a net: the edge on which SUMO has them
    /// tells whether they are on a crossing.
    pub fn persons_in_conflict(&self) -> Vec<UserIndex> {
        let is_person = |user: &UserIndex| self.roster.profile_of(*user).category == Category::Person;
        let is_there = |user: &UserIndex| self.net.is_some() && self.frame.row_of(*user).is_some();
        self.tracker.in_conflict().filter(is_there).filter(is_person).collect()
    }

    /// States the edge on which SUMO has one of [`Run::persons_in_conflict`].
    pub fn set_edge(&mut self, person: UserIndex, edge: &str) {
        self.edges.extend(self.net.as_ref().and_then(|net| net.edge(edge)).map(|edge| (person, edge)));
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

    /// Counts the vehicles that enter junctions, unless the step is one of the warm-up.
    fn count_entering(&mut self) {
        let Self { net: Some(net), frame, detector, entering, .. } = self else { return };
        if self.warm_up.is_over() {
            // One that stands enters nothing.
            for Row { user, .. } in frame.rows().filter(|row| row.state.moves()) {
                if let Some(lane) = detector.lane(user) {
                    entering.see(net, user, lane);
                }
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

    /// States places to which a road user will drive, or where it is now, for `--path driven`.
    pub(crate) fn drive(&mut self, user: UserIndex, places: impl IntoIterator<Item = DrivenPlace>) {
        self.detector.drive(user, places);
    }

    /// By how many lanes the road user of a row has changed in the step under way, positive towards lanes of a higher index;
    /// none if it has not. Its placement is set.
    pub fn changed_lanes(&self, row: u32) -> Option<i32> {
        let change = self.detector.lane_change(self.frame.user(row)).filter(|change| change.time == self.frame.time)?;
        let index = |lane: LaneIndex| Some(self.net.as_ref()?.lanes[lane].index as i32);
        Some(index(change.to)? - index(change.from)?)
    }

    /// States why the road user of a row has changed lanes in this step: SUMO's `vehicle.getLaneChangeState`.
    pub fn set_lane_change_state(&mut self, row: u32, state: i32) {
        self.detector.set_lane_change_reason(self.frame.user(row), LaneChangeReason::of(state));
    }
}

/// The settings of single types in order, each with the profile name of road users of that type.
fn type_settings(options: &RunOptions) -> Vec<(String, String)> {
    let types = options.model.types.keys().map(|name| (format!("[type.{name}]"), name.clone()));
    let obstacles = options.log.obstacles.iter().map(|name| (format!("obstacles {name}"), obstacle_name(name)));
    let mut settings = types.chain(obstacles).collect::<Vec<_>>();
    settings.sort_unstable();
    settings
}
