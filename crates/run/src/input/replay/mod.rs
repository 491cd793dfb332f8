//! Replay: SUMO's fcd-output as frames, through the same checks as a live run. SUMO is not needed.
//!
//! The recording is read twice: once for the routes that the vehicles drove, then step by step. Where paths are those that
//! were driven, a second reader is ahead of the replay. Before that, its beginning tells whether it fits the net and how SUMO
//! moved the vehicles.

mod ahead;
mod clock;
mod columns;
mod complete_route;
mod connections;
mod csv;
pub mod demand;
mod drive;
mod fcd_attributes;
mod future;
mod lanes;
pub mod lights;
mod lists;
mod names;
mod net_match;
mod number;
mod parked;
mod parquet;
pub mod recorded_step;
pub mod recording;
mod remarks;
pub mod routes;
mod source;
pub mod stops;
mod tags;
mod types;
mod update;
mod user;
mod vehicles;
mod xml;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use rustc_hash::FxHashSet;

use crate::net::projection::Projection;
use crate::run::Run;
use crate::{Error, Result};
use ahead::Steps;
use closecall::options::{Mode, Options, PathModel};
use closecall::traffic::frame::State;
use closecall::traffic::net::Net;
use closecall::traffic::placement::Placement;
use closecall::traffic::profile::{Category, Profile};
use closecall::traffic::roster::UserIndex;
use closecall::util::units::Second;
pub use columns::columns_of_fcd;
use future::Future;
use lanes::{Lanes, heading, is_opposite};
use lights::RecordedLights;
use recorded_step::{LeftOut, RecordedRow, RecordedStep};
use recording::Recording;
use routes::Routes;
use stops::RecordedStops;
use types::VehicleTypes;
use user::ReplayedUser;

/// A recording that is replayed into a run.
pub struct Replay {
    path: PathBuf,
    recorded_steps: Steps,
    /// None if the recording is in the net's metres.
    projection: Option<Projection>,
    step: RecordedStep,
    second_step: RecordedStep,
    has_second_step: bool,
    types: VehicleTypes,
    /// Types that no file defines: they are SUMO's default car or pedestrian.
    undefined: BTreeSet<String>,
    lanes: Lanes,
    /// None where paths do not follow lanes.
    routes: Option<Routes>,
    /// None where paths are not those that were driven.
    future: Option<Future>,
    /// None where it is not known what the traffic lights showed.
    lights: Option<RecordedLights>,
    /// Where vehicles stopped on the road; none where that is not known.
    stops: RecordedStops,
    options: Options,
    step_length: Second,
    averaged_over: f64,
    steps: u32,
    /// Rows of vehicles so far, and how many of them are on a lane that the net does not have.
    vehicle_rows: u64,
    unknown_lanes: u64,
    left_out: LeftOut,
    /// The road users in the scene, by the recording's number.
    users: Vec<Option<ReplayedUser>>,
    /// The states of the step's vehicles, if there are persons.
    vehicles: FxHashSet<ExactState>,
    /// For each row of the frame, the index of its row in the step.
    rows: Vec<u32>,
    gone: Vec<UserIndex>,
}

impl Replay {
    /// Opens a recording; `demand_files` are the route and additional files that define its vehicles' types and routes.
    ///
    /// # Errors
    /// An error that names the file and what is wrong with it.
    pub fn open(path: &Path, demand_files: &[PathBuf], net: Option<&Net>, options: &Options) -> Result<Self> {
        Self::open_unless(path, demand_files, net, options, &mut || false)
    }

    /// As [`Replay::open`]; `stopped` is asked now and then whether to stop.
    ///
    /// # Errors
    /// Those of [`Replay::open`], and [`Error::Stopped`].
    pub fn open_unless(
        path: &Path,
        demand_files: &[PathBuf],
        net: Option<&Net>,
        options: &Options,
        stopped: &mut dyn FnMut() -> bool,
    ) -> Result<Self> {
        let (types, planned) = demand::read(demand_files, net.unwrap_or(&Net::default()))?;
        let mut recording = Recording::open(path)?;
        let mut step = RecordedStep::default();
        let mut second_step = RecordedStep::default();
        // The step length, which is how long a person walks on, follows from the first two steps.
        if !recording.next_step(&mut step)? {
            return Err(Error::content(path, "the recording has no steps"));
        }
        let has_second_step = match recording.next_step(&mut second_step) {
            Ok(more) => more,
            Err(Error::CutShort { .. }) => {
                return Err(Error::content(path, "the recording is cut short within its first two steps"));
            }
            Err(error) => return Err(error),
        };
        let step_length = if has_second_step { second_step.time - step.time } else { 1.0 };
        let projection = net.map(|net| net_match::projection(path, net)).transpose()?.flatten();
        let on_lanes = net.filter(|_| options.path == PathModel::Lanes);
        let routes = on_lanes.map(|net| Routes::read(path, net, planned, projection.as_ref(), stopped)).transpose()?;
        let is_driven = options.path == PathModel::Driven && options.mode == Mode::Closecall;
        let future = if is_driven { Some(Future::open(path)?) } else { None };
        Ok(Self {
            path: path.to_path_buf(),
            recorded_steps: Steps::InPlace(recording),
            averaged_over: update::averaged_over(path, projection.as_ref())?,
            projection,
            step,
            second_step,
            has_second_step,
            types,
            undefined: BTreeSet::new(),
            lanes: Lanes::default(),
            routes,
            future,
            lights: None,
            stops: RecordedStops::default(),
            options: options.clone(),
            step_length,
            steps: 0,
            vehicle_rows: 0,
            unknown_lanes: 0,
            left_out: LeftOut::default(),
            users: Vec::new(),
            vehicles: FxHashSet::default(),
            rows: Vec::new(),
            gone: Vec::new(),
        })
    }

    /// Reads the steps ahead, in a thread of its own.
    ///
    /// # Errors
    /// [`Error::Value`] where the system gives no thread.
    pub fn read_ahead(self) -> Result<Self> {
        Ok(Self { recorded_steps: self.recorded_steps.read_ahead()?, ..self })
    }

    /// States in each step what the traffic lights of the net showed, as this file of SUMO's says.
    ///
    /// # Errors
    /// Those of [`RecordedLights::open`].
    pub fn set_lights(&mut self, path: &Path, net: &Net) -> Result<()> {
        self.lights = Some(RecordedLights::open(path, net)?);
        Ok(())
    }

    /// States in each step which vehicles stop on the road, as this file of SUMO's says.
    ///
    /// # Errors
    /// An error that names the file, the line and what is wrong; a file of something else is refused.
    pub fn set_stops(&mut self, path: &Path) -> Result<()> {
        self.stops = RecordedStops::read(path)?;
        Ok(())
    }

    /// Checks the next step; returns its time, or none where the recording has ended.
    ///
    /// # Errors
    /// Those of [`Recording::next_step`] and [`Run::step`].
    pub fn next(&mut self, run: &mut Run) -> Result<Option<Second>> {
        self.steps += 1;
        if self.steps == 2 {
            if !self.has_second_step {
                return Ok(None);
            }
            std::mem::swap(&mut self.step, &mut self.second_step);
        } else if self.steps > 2 && !self.recorded_steps.next_step(&mut self.step)? {
            return Ok(None);
        }
        run.begin_step(self.step.time);
        if let Some(lights) = &mut self.lights {
            lights.show(run, self.step.time)?;
        }
        self.fill(run)?;
        self.stops.show(run, self.step.time);
        self.show_edges(run);
        run.step(|run, rows| rows.iter().try_for_each(|row| self.place(run, *row)))?;
        Ok(Some(self.step.time))
    }

    /// The time between the first two steps, in s.
    pub fn step_length(&self) -> Second {
        self.step_length
    }

    /// Over which share of a step a recorded speed is the mean: 1 for SUMO's Euler update, 0 for its ballistic one.
    pub fn averaged_over(&self) -> f64 {
        self.averaged_over
    }

    /// The number of road users in the step.
    pub fn road_users(&self) -> usize {
        self.step.rows().len()
    }

    /// Fills the run's frame with the rows of the step.
    fn fill(&mut self, run: &mut Run) -> Result<()> {
        if let Some(projection) = &self.projection {
            self.step.project(projection).map_err(|message| Error::content(&self.path, message))?;
        }
        if let Some(future) = &mut self.future {
            future.look_from(self.step.time, self.projection.as_ref());
        }
        self.left_out += self.step.left_out;
        self.vehicles.clear();
        if self.step.persons() > 0 {
            self.vehicles.extend(self.step.rows().iter().filter(|row| !row.person).map(exact_state));
        }
        self.rows.clear();
        self.rows.resize(run.frame.len(), u32::MAX);
        for index in 0..self.step.rows().len() {
            let row = self.step.rows()[index];
            let user = match self.users.get_mut(row.user as usize) {
                Some(Some(user)) => user.index,
                _ => self.enter(&row, run)?,
            };
            if let Some(places) = self.future.as_mut().and_then(|future| future.take(row.user)) {
                run.drive(user, places);
            }
            if !row.person && self.is_parked(&row, run.net()) {
                continue;
            }
            // SUMO gives a person that rides in a vehicle the vehicle's position; it is not a road user of its own.
            if row.person && self.vehicles.contains(&exact_state(&row)) {
                continue;
            }
            let state = State { x: row.x, y: row.y, z: row.z, heading: heading(&row), speed: row.speed };
            if run.frame.push(user, state) {
                self.rows.push(index as u32);
            }
        }
        for user in self.step.gone() {
            self.gone.extend(self.users.get_mut(*user as usize).and_then(Option::take).map(|user| user.index));
            if let Some(future) = &mut self.future {
                future.leave(*user);
            }
        }
        self.gone.sort_unstable();
        self.gone.drain(..).for_each(|user| run.leave(user));
        Ok(())
    }

    /// States the edges of persons in conflict.
    fn show_edges(&self, run: &mut Run) {
        for person in run.persons_in_conflict() {
            let row = run.frame.row_of(person).and_then(|row| self.rows.get(row as usize));
            if let Some(recorded) = row.and_then(|index| self.step.rows().get(*index as usize)) {
                run.set_edge(person, self.recorded_steps.lane(recorded.lane));
            }
        }
    }

    /// A road user enters the scene.
    fn enter(&mut self, row: &RecordedRow, run: &mut Run) -> Result<UserIndex> {
        let type_name = match self.recorded_steps.type_name(row) {
            // A recording may lack its types (--fcd-output.attributes); the route files have them too.
            "" => self.types.of_user(self.recorded_steps.id(row.user), row.person).unwrap_or_default(),
            name => name,
        };
        let category = if row.person { Category::Person } else { Category::Vehicle };
        let profile = match run.roster.profile_named(type_name, category) {
            Some(known) => known,
            None => {
                if !self.types.define(type_name) {
                    self.undefined.insert(type_name.to_owned());
                }
                let sumo = self.types.named(type_name, row.person);
                let profile = if row.person {
                    Profile::person(&sumo, &self.options, self.step_length)
                } else {
                    Profile::vehicle(&sumo, &self.options)
                };
                run.roster.profile(profile)?
            }
        };
        let user = run.enter(self.recorded_steps.id(row.user), profile);
        let number = match &mut self.routes {
            Some(routes) if !row.person => Some(routes.enter()?),
            _ => None,
        };
        let place = row.user as usize;
        if self.users.len() <= place {
            self.users.resize_with(place + 1, || None);
        }
        self.users[place] = Some(ReplayedUser::new(user, number));
        Ok(user)
    }

    /// Sets the placement of a row of the frame, if the net has its lane.
    fn place(&mut self, run: &mut Run, row: u32) -> Result<()> {
        let Some(&index) = self.rows.get(row as usize) else { return Ok(()) };
        let recorded = self.step.rows().get(index as usize).filter(|recorded| !recorded.person);
        let (Some(recorded), Some(net)) = (recorded, run.net()) else { return Ok(()) };
        let Some(Some(user)) = self.users.get_mut(recorded.user as usize) else { return Ok(()) };
        let Some(lane) = self.lanes.lane(recorded.lane, |lane| self.recorded_steps.lane(lane), net) else {
            return Ok(());
        };
        if user.route.is_none()
            && let (Some(routes), Some(number)) = (&mut self.routes, user.number)
        {
            user.route = Some(routes.of(number)?);
        }
        // The recording's steps are numbered from 0 where its routes are read.
        user.advance_to(self.steps - 1);
        if is_opposite(recorded, net, lane) {
            user.oppose(net, net.lanes[lane].edge);
        }
        let is_new = !run.knows_route(user.index, user.route_position);
        let placement = Placement {
            lane,
            position: recorded.position,
            route: is_new.then(|| user.edges()),
            route_position: user.route_position,
            lateral_speed: recorded.lateral_speed,
        };
        run.set_placement(row, &placement);
        Ok(())
    }
}

/// Position, angle and speed as bits.
type ExactState = [u64; 4];

fn exact_state(row: &RecordedRow) -> ExactState {
    [row.x, row.y, row.angle, row.speed].map(f64::to_bits)
}
