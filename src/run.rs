//! One run, from its first frame to its summary: the detector, the events and the log, in the order of the flow.
//!
//! Whoever has the data drives it, step by step: [`Run::begin`], a row into [`Run::frame`] per road user,
//! [`Run::follow`], [`Run::place`] for the rows that it names, [`Run::finish_step`] (or its parts, to time them); after
//! the last step [`Run::finish`].

use std::sync::Arc;

use crate::Result;
use crate::detection::detector::Detector;
use crate::detection::detector::{LeftOut, shortcuts::Shortcuts};
use crate::detection::encounter::Encounter;
use crate::events::{Alarm, Conflict, Tracker};
use crate::geometry::Point;
use crate::geometry::polygon::convex_parts;
use crate::options::Options;
use crate::output::formats::Outputs;
use crate::output::log::Log;
use crate::output::summary::Summary;
use crate::traffic::frame::{Frame, Row, State};
use crate::traffic::net::Net;
use crate::traffic::net::filter::Filter;
use crate::traffic::placement::Placement;
use crate::traffic::profile::{Category, Profile, obstacle_name};
use crate::traffic::roster::{ProfileIndex, Roster, UserIndex};
use crate::util::units::Second;

/// One run.
pub struct Run {
    /// Who is in the scene.
    pub roster: Roster,
    /// The road users of the step under way.
    pub frame: Frame,
    detector: Detector,
    net: Option<Arc<Net>>,
    filter: Option<Filter>,
    tracker: Tracker,
    log: Option<Log>,
    outputs: Outputs,
    keeps: bool,
    conflicts: Vec<Conflict>,
    leaving: Vec<UserIndex>,
    obstacles: Vec<(UserIndex, Point)>,
    /// What the options say of single types: as they name it, and as the roster does.
    settings: Vec<(String, String)>,
    summary: Summary,
}

impl Run {
    /// A run that keeps its conflicts in memory.
    ///
    /// # Errors
    /// An error that names the filter's file and what is wrong with it.
    pub fn new(options: &Options, net: Option<Arc<Net>>) -> Result<Self> {
        let filter = match (&options.filter, &net) {
            (Some(path), Some(net)) => Some(Filter::read(path, net)?),
            (Some(path), None) => return Err(crate::Error::content(path, "a filter needs a net")),
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
            tracker: Tracker::default(),
            log: None,
            outputs: Outputs::default(),
            keeps: true,
            conflicts: Vec::new(),
            leaving: Vec::new(),
            obstacles: Vec::new(),
            settings: settings(options),
            summary: Summary::default(),
        })
    }

    /// Writes the conflicts to a log too, and no longer keeps them in memory unless `keeps`.
    pub fn log_to(&mut self, log: Log, keeps: bool) {
        self.log = Some(log);
        self.keeps = keeps;
    }

    /// Writes other files too, besides the log.
    pub fn write_to(&mut self, outputs: Outputs) {
        if outputs.want_lanes() {
            self.detector.keep_asking_for_lanes();
        }
        self.outputs = outputs;
    }

    /// What is left out.
    pub fn shortcuts(&self) -> Shortcuts {
        self.detector.shortcuts()
    }

    /// Looks at each step with so many threads, at least one; the results are the same.
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

    /// Whether no road user's route changes while it is in the scene.
    pub fn has_fixed_routes(&self) -> bool {
        self.detector.has_fixed_routes()
    }

    /// Takes a vehicle or person of a type that the roster has into the scene.
    pub fn enter(&mut self, id: &str, profile: ProfileIndex) -> UserIndex {
        let user = self.roster.enter(id, profile);
        match self.roster.profile_of(user).category {
            Category::Vehicle => self.summary.exposure.vehicles += 1,
            Category::Person => self.summary.exposure.persons += 1,
            Category::Obstacle => {}
        }
        user
    }

    /// Takes a static obstacle into the scene, where it stays: a polygon of this type and outline.
    ///
    /// # Errors
    /// [`crate::Error::Value`] where the outline has fewer than three points or a point that is none.
    pub fn enter_obstacle(&mut self, id: &str, polygon_type: &str, outline: &[Point]) -> Result<()> {
        if outline.len() < 3 || outline.iter().any(|point| !(point.x + point.y).is_finite()) {
            return Err(crate::Error::Value(format!("polygon \"{id}\" needs three points at least, all finite")));
        }
        let shape = convex_parts(outline).into();
        let profile = self.roster.profile(Profile::obstacle(polygon_type))?;
        self.obstacles.push((self.roster.enter_shaped(id, profile, shape), outline[0]));
        Ok(())
    }

    /// Lets a road user leave the scene; it must not be in a later frame.
    pub fn leave(&mut self, user: UserIndex) {
        self.leaving.push(user);
    }

    /// Begins the step at `time`, with an empty frame.
    pub fn begin(&mut self, time: Second) {
        match self.time() {
            None => self.summary.begin = time,
            Some(last) => self.expose(time - last),
        }
        self.summary.steps += 1;
        self.summary.end = time;
        self.frame.begin(time);
        for &(user, place) in &self.obstacles {
            self.frame.push(user, State { x: place.x, y: place.y, z: 0.0, heading: 0.0, speed: 0.0 });
        }
    }

    /// The time of the step under way; none before the first.
    pub fn time(&self) -> Option<Second> {
        (self.summary.steps > 0).then_some(self.frame.time)
    }

    /// Counts the traffic of the step before, which lasted this long.
    fn expose(&mut self, lasted: Second) {
        let exposure = &mut self.summary.exposure;
        for Row { user, state } in self.frame.rows() {
            if self.roster.profile_of(user).category == Category::Vehicle {
                exposure.vehicle_kilometres += state.speed * lasted / 1e3;
                exposure.vehicle_hours += lasted / 3600.0;
            }
        }
    }

    /// Where everybody is now; returns the rows that have to be placed.
    pub fn track_paths(&mut self) -> &[u32] {
        self.detector.track_paths(&self.frame, &self.roster)
    }

    /// Whether the road user of a row, if it still has its route, is on the path laid before: nobody needs to know where it
    /// is on the net.
    pub fn keeps_path(&self, row: u32) -> bool {
        !self.outputs.want_lanes() && self.detector.keeps_path(row)
    }

    /// Whether the route that a road user was said to have is known from this place in it on.
    pub fn knows_route(&self, user: UserIndex, position: usize) -> bool {
        self.detector.knows_route(user, position)
    }

    /// Says where the road user of a row is on the net.
    pub fn set_placement(&mut self, row: u32, placement: &Placement) {
        self.detector.set_placement(&self.frame, &self.roster, row, placement);
        self.outputs.place(row, placement);
    }

    /// Both phases, the events and the log.
    ///
    /// # Errors
    /// As [`Run::write`].
    pub fn finish_step(&mut self) -> Result<()> {
        self.broad_phase();
        self.narrow_phase();
        self.close_conflicts();
        self.write()
    }

    /// Phase 1.
    pub fn broad_phase(&mut self) {
        self.detector.broad_phase(&self.frame, &self.roster);
    }

    /// Phase 2.
    pub fn narrow_phase(&mut self) {
        let Self { detector, net, filter, .. } = self;
        _ = detector.narrow_phase(&self.frame, &self.roster);
        detector.retain(|found| {
            if let (true, None, Some(net)) = (found.in_conflict(), found.lane, &net) {
                found.lane = net.lane_at(Point::new(found.x, found.y));
            }
            found.in_conflict() && filter.as_ref().is_none_or(|filter| filter.holds(found.lane))
        });
    }

    /// The events.
    pub fn close_conflicts(&mut self) {
        let (detector, frame, roster) = (&self.detector, &self.frame, &self.roster);
        let path = |row| detector.path(frame, roster, row);
        let closed = self.tracker.step(frame, roster, detector.encounters(), path);
        settle(closed, &mut self.summary, self.keeps.then_some(&mut self.conflicts));
    }

    /// The log and the other files; ends the step.
    ///
    /// # Errors
    /// An error that names the log's file if it cannot be written.
    pub fn write(&mut self) -> Result<()> {
        let closed = self.tracker.closed();
        if let Some(log) = &mut self.log {
            if !closed.is_empty() {
                log.append_conflicts(closed, self.net.as_deref(), &self.roster)?;
            }
            log.append_encounters(self.frame.time, self.detector.encounters(), &self.roster)?;
        }
        self.outputs.step(&self.frame, &self.roster, self.net.as_deref())?;
        self.outputs.conflicts(closed)?;
        self.tracker.forget_closed();
        // Only now may their indices be given to others: the events of this step have seen that they are gone.
        for user in self.leaving.drain(..) {
            self.roster.leave(user);
            self.detector.forget(user);
            self.outputs.forget(user);
        }
        Ok(())
    }

    /// The pairs that were in conflict in the last step.
    pub fn in_conflict(&self) -> impl ExactSizeIterator<Item = &Encounter> {
        self.detector.encounters()
    }

    /// The conflicts that go on in this step.
    pub fn alarms(&self) -> impl Iterator<Item = Alarm> {
        self.tracker.alarms()
    }

    /// The conflicts that are kept in memory, and those that go on as they are now.
    pub fn conflicts(&self) -> Vec<Conflict> {
        self.conflicts.iter().cloned().chain(self.tracker.open(&self.roster)).collect()
    }

    /// The net, if there is one.
    pub fn net(&self) -> Option<&Net> {
        self.net.as_deref()
    }

    /// What was found so far, conflicts that go on included.
    pub fn summary(&self) -> Summary {
        let mut summary = self.summary.clone();
        for conflict in self.tracker.open(&self.roster) {
            summary.add(&conflict);
        }
        summary
    }

    /// How many conflicts have closed so far.
    pub fn conflicts_so_far(&self) -> u64 {
        self.summary.count(None, None)
    }

    /// Closes what is still open and adds it to the log; what the caller did without is added to what was left out.
    ///
    /// # Errors
    /// An error that names the log's file if it cannot be written.
    pub fn finish(&mut self, left_out: Vec<LeftOut>) -> Result<Summary> {
        let closed = self.tracker.finish(&self.roster);
        if let Some(log) = &mut self.log {
            log.append_conflicts(closed, self.net.as_deref(), &self.roster)?;
        }
        self.outputs.conflicts(closed)?;
        self.outputs.finish()?;
        settle(closed, &mut self.summary, self.keeps.then_some(&mut self.conflicts));
        self.summary.left_out = self.detector.left_out();
        self.summary.left_out.extend(left_out);
        let unmet = self.settings.iter().filter(|(_, name)| !self.roster.has_any_of(name));
        let remarks = unmet.map(|(setting, _)| format!("{setting}: nobody of this type was in the scene"));
        self.summary.remarks = remarks.collect();
        Ok(self.summary.clone())
    }

    /// Takes back the files besides the log: the input could not be used after all.
    pub fn discard_outputs(&mut self) {
        std::mem::take(&mut self.outputs).discard();
    }

    /// The log, taken away from the run.
    pub fn take_log(&mut self) -> Option<Log> {
        self.log.take()
    }
}

/// The settings of single types, in order, each with the name that somebody of the type has.
fn settings(options: &Options) -> Vec<(String, String)> {
    let types = options.types.keys().map(|name| (format!("[type.{name}]"), name.clone()));
    let obstacles = options.obstacles.iter().map(|name| (format!("obstacles {name}"), obstacle_name(name)));
    let mut settings = types.chain(obstacles).collect::<Vec<_>>();
    settings.sort_unstable();
    settings
}

fn settle(closed: &[Conflict], summary: &mut Summary, kept: Option<&mut Vec<Conflict>>) {
    for conflict in closed {
        summary.add(conflict);
    }
    if let Some(kept) = kept {
        kept.extend_from_slice(closed);
    }
}
