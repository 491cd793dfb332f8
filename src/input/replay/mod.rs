//! Replay: SUMO's fcd-output as frames, through the same checks as a live run. No SUMO is needed.
//!
//! The recording is read twice: once for the routes that everybody drove, then step by step.

mod csv;
mod lanes;
mod names;
mod number;
pub mod recording;
pub mod routes;
pub mod rows;
mod source;
pub mod types;
mod xml;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rustc_hash::FxHashSet;

use crate::geometry::{Bounds, Point};
use crate::options::{Options, PathModel};
use crate::run::Run;
use crate::traffic::frame::State;
use crate::traffic::net::{EdgeFunction, EdgeIndex, LaneIndex, Net};
use crate::traffic::placement::Placement;
use crate::traffic::profile::{Category, Profile};
use crate::traffic::roster::UserIndex;
use crate::util::units::{Metre, Second};
use crate::{Error, Result};
use lanes::Lanes;
use recording::Recording;
use routes::Routes;
use rows::{Row, Step};
use types::Types;

/// Who is further than this from where its lane is, in m, is on another net, or in degrees.
const ELSEWHERE: Metre = 100.0;

/// Of types that are defined nowhere so many are named.
const NAMED: usize = 5;

/// A recording that is being replayed into a run.
pub struct Replay {
    path: PathBuf,
    recording: Recording,
    /// Whether anybody was found to be where its lane is.
    is_on_net: bool,
    step: Step,
    following: Step,
    has_following: bool,
    types: Types,
    /// Types that are defined nowhere, and so are SUMO's default car or pedestrian.
    undefined: BTreeSet<String>,
    lanes: Lanes,
    /// None where paths are not laid along lanes.
    routes: Option<Routes>,
    options: Options,
    step_length: Second,
    steps: u64,
    /// By the recording's number of the user.
    live: Vec<Option<Live>>,
    /// Where the vehicles of the step are, if there are persons.
    vehicles: FxHashSet<Stand>,
    /// Which of the step's rows stands in each row of the frame.
    rows: Vec<u32>,
    approaching: Vec<u32>,
    gone: Vec<UserIndex>,
}

/// Somebody in the scene.
struct Live {
    user: UserIndex,
    /// Which of the recording's vehicles it is; none of a person, and where paths are not laid along lanes.
    number: Option<u64>,
    /// Read when it is first needed.
    route: Option<Arc<[EdgeIndex]>>,
    route_position: usize,
    /// The recording's number of the lane that it was on last.
    lane: u32,
}

impl Replay {
    /// Opens a recording; `type_files` are the route and additional files that define its vehicle types.
    ///
    /// # Errors
    /// An error that names the file and what is wrong with it.
    pub fn open(path: &Path, type_files: &[PathBuf], net: &Net, options: &Options) -> Result<Self> {
        let types = Types::read(type_files)?;
        let mut recording = Recording::open(path)?;
        let (mut step, mut following) = (Step::default(), Step::default());
        // Two steps say how long one lasts: as long as a person walks on.
        if !recording.next_step(&mut step)? {
            return Err(Error::content(path, "the recording has no steps"));
        }
        let has_following = match recording.next_step(&mut following) {
            Ok(more) => more,
            Err(Error::CutShort { .. }) => {
                return Err(Error::content(path, "the recording is cut short within its first two steps"));
            }
            Err(error) => return Err(error),
        };
        let step_length = if has_following { following.time - step.time } else { 1.0 };
        let by_lanes = options.path == PathModel::Lanes;
        Ok(Self {
            path: path.to_path_buf(),
            recording,
            is_on_net: false,
            step,
            following,
            has_following,
            types,
            undefined: BTreeSet::new(),
            lanes: Lanes::default(),
            routes: if by_lanes { Some(Routes::read(path, net)?) } else { None },
            options: options.clone(),
            step_length,
            steps: 0,
            live: Vec::new(),
            vehicles: FxHashSet::default(),
            rows: Vec::new(),
            approaching: Vec::new(),
            gone: Vec::new(),
        })
    }

    /// Checks the next step; returns its time, or none where the recording has ended.
    ///
    /// # Errors
    /// As [`Recording`] and [`Run`] have them.
    pub fn next(&mut self, run: &mut Run) -> Result<Option<Second>> {
        self.steps += 1;
        if self.steps == 2 {
            if !self.has_following {
                return Ok(None);
            }
            std::mem::swap(&mut self.step, &mut self.following);
        } else if self.steps > 2 && !self.recording.next_step(&mut self.step)? {
            return Ok(None);
        }
        run.begin(self.step.time);
        self.fill(run)?;
        self.approaching.clear();
        self.approaching.extend_from_slice(run.track_paths());
        for index in 0..self.approaching.len() {
            self.place(run, self.approaching[index])?;
        }
        run.finish_step()?;
        Ok(Some(self.step.time))
    }

    /// What there is to say of the types so far: which of them are defined nowhere.
    pub fn remark(&self) -> Option<String> {
        let named = |name: &String| if name.is_empty() { "(none)".to_owned() } else { format!("\"{name}\"") };
        let names = self.undefined.iter().take(NAMED).map(named).collect::<Vec<_>>().join(", ");
        let more = match self.undefined.len().saturating_sub(NAMED) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        (!names.is_empty()).then(|| {
            format!("types {names}{more}: no file defines them, so they are SUMO's default car or pedestrian (--route-files)")
        })
    }

    /// The number of road users in the step.
    pub fn road_users(&self) -> usize {
        self.step.rows().len()
    }

    fn fill(&mut self, run: &mut Run) -> Result<()> {
        self.vehicles.clear();
        if self.step.persons() > 0 {
            self.vehicles.extend(self.step.rows().iter().filter(|row| !row.person).map(stand));
        }
        self.rows.clear();
        self.rows.resize(run.frame.len(), u32::MAX);
        for place in 0..self.step.rows().len() {
            let row = self.step.rows()[place];
            let user = match self.live.get_mut(row.user as usize) {
                Some(Some(live)) => {
                    // In every lane, also where nobody asks for its place: a route may use an edge twice.
                    if live.lane != row.lane && live.route.is_some() {
                        live.lane = row.lane;
                        if let Some(net) = run.net()
                            && let Some(lane) = self.lanes.lane(row.lane, &self.recording, net)
                        {
                            live.go_on(net, lane);
                        }
                    }
                    live.user
                }
                _ => self.enter(&row, run)?,
            };
            // Who rides in a vehicle has the vehicle's place in SUMO, and is no road user of its own.
            if row.person && self.vehicles.contains(&stand(&row)) {
                continue;
            }
            let heading = (90.0 - row.angle).to_radians();
            if run.frame.push(user, State { x: row.x, y: row.y, z: row.z, heading, speed: row.speed }) {
                self.rows.push(place as u32);
            }
        }
        for user in self.step.gone() {
            self.gone.extend(self.live.get_mut(*user as usize).and_then(Option::take).map(|live| live.user));
        }
        self.gone.sort_unstable();
        self.gone.drain(..).for_each(|user| run.leave(user));
        Ok(())
    }

    fn enter(&mut self, row: &Row, run: &mut Run) -> Result<UserIndex> {
        let type_name = self.recording.type_name(row);
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
        let user = run.enter(self.recording.id(row.user), profile);
        let number = match &mut self.routes {
            Some(routes) if !row.person => Some(routes.enter()?),
            _ => None,
        };
        let index = row.user as usize;
        if self.live.len() <= index {
            self.live.resize_with(index + 1, || None);
        }
        self.live[index] = Some(Live { user, number, route: None, route_position: 0, lane: u32::MAX });
        Ok(user)
    }

    fn place(&mut self, run: &mut Run, row: u32) -> Result<()> {
        let Some(&place) = self.rows.get(row as usize) else { return Ok(()) };
        let (Some(recorded), Some(net)) = (self.step.rows().get(place as usize), run.net()) else { return Ok(()) };
        let Some(Some(live)) = self.live.get_mut(recorded.user as usize) else { return Ok(()) };
        let Some(lane) = self.lanes.lane(recorded.lane, &self.recording, net) else { return Ok(()) };
        if !self.is_on_net {
            if !is_near(recorded, &net.lanes[lane.0 as usize].shape) {
                let (id, lane) = (self.recording.id(recorded.user), self.recording.lane(recorded.lane));
                let message = format!(
                    "\"{id}\" is said to be on lane {lane} at ({}, {}), where the net does not have it: recorded on another \
                     net, or in degrees (--fcd-output.geo)?",
                    recorded.x, recorded.y
                );
                return Err(Error::content(&self.path, message));
            }
            self.is_on_net = true;
        }
        let route = match (&live.route, &mut self.routes, live.number) {
            (Some(route), ..) => route.clone(),
            (None, Some(routes), Some(number)) => routes.of(number)?,
            _ => Arc::new([]),
        };
        live.route = Some(route.clone());
        live.go_on(net, lane);
        let is_new = !run.knows_route(live.user, live.route_position);
        let placement = Placement {
            lane,
            position: recorded.position,
            route: is_new.then_some(route),
            route_position: live.route_position,
            lateral_speed: recorded.lateral_speed,
        };
        run.set_placement(row, &placement);
        Ok(())
    }
}

/// Whether somebody is about where a lane is.
fn is_near(row: &Row, lane: &[Point]) -> bool {
    let mut reach = Bounds::EMPTY;
    lane.iter().for_each(|point| reach.include(*point));
    let place = Point::new(row.x, row.y);
    reach.grown(ELSEWHERE).meet(&Bounds { low: place, high: place })
}

/// Position, angle and speed, to the last bit.
type Stand = [u64; 4];

fn stand(row: &Row) -> Stand {
    [row.x, row.y, row.angle, row.speed].map(f64::to_bits)
}

impl Live {
    /// Moves on along its route to this lane.
    fn go_on(&mut self, net: &Net, lane: LaneIndex) {
        let Some(route) = &self.route else { return };
        let edge = net.lanes[lane.0 as usize].edge;
        let find = |edge: EdgeIndex| route[self.route_position..].iter().position(|known| *known == edge);
        let further = if net.edges[edge.0 as usize].function == EdgeFunction::Normal {
            find(edge).unwrap_or(0)
        } else if let Some(link) = net.lanes[lane.0 as usize].links.first() {
            // Within a junction it is on the way from the edge before.
            let to = net.lanes[link.to.0 as usize].edge;
            find(to).map_or(0, |further| further.saturating_sub(1))
        } else {
            0
        };
        self.route_position += further;
    }
}
