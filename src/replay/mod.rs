//! Replay: SUMO's fcd-output as frames, through the same checks as a live run. No SUMO is needed.
//!
//! The recording is read twice: once for the routes that everybody drove, then step by step.

mod csv;
pub mod recording;
pub mod routes;
pub mod types;
mod xml;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rustc_hash::FxHashMap;

use crate::encounter::Placement;
use crate::frame::{State, UserIndex};
use crate::net::{EdgeFunction, EdgeIndex, Net};
use crate::options::{Options, PathModel};
use crate::profile::Profile;
use crate::run::Run;
use crate::units::Second;
use crate::{Error, Result};
use recording::{Recording, Row, Step};
use routes::Routes;
use types::Types;

/// A recording that is being replayed into a run.
pub struct Replay {
    recording: Recording,
    step: Step,
    following: Step,
    has_following: bool,
    types: Types,
    routes: Routes,
    options: Options,
    step_length: Second,
    steps: u64,
    live: FxHashMap<String, Live>,
    /// Which of the step's rows stands in each row of the frame.
    rows: Vec<u32>,
}

/// Somebody in the scene.
struct Live {
    user: UserIndex,
    seen: u64,
    route: Arc<[EdgeIndex]>,
    route_position: usize,
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
            recording,
            step,
            following,
            has_following,
            types,
            routes: if by_lanes { Routes::read(path, net)? } else { Routes::default() },
            options: options.clone(),
            step_length,
            steps: 0,
            live: FxHashMap::default(),
            rows: Vec::new(),
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
        for row in run.approach().to_vec() {
            self.place(run, row);
        }
        run.finish_step()?;
        Ok(Some(self.step.time))
    }

    /// The number of road users in the step.
    pub fn road_users(&self) -> usize {
        self.step.rows().len()
    }

    fn fill(&mut self, run: &mut Run) -> Result<()> {
        self.rows.clear();
        self.rows.resize(run.frame.len(), u32::MAX);
        for (place, row) in (0..).zip(self.step.rows()) {
            let user = match self.live.get_mut(&row.id) {
                Some(live) => {
                    live.seen = self.steps;
                    live.user
                }
                None => {
                    let name = if row.person { format!("person:{}", row.type_name) } else { row.type_name.clone() };
                    let profile = match run.roster.profile_named(&name) {
                        Some(known) => known,
                        None => {
                            let sumo = self.types.named(&row.type_name, row.person);
                            let profile = if row.person {
                                Profile::person(&sumo, &self.options, self.step_length)
                            } else {
                                Profile::vehicle(&sumo, &self.options)
                            };
                            run.roster.profile(Profile { name, ..profile })?
                        }
                    };
                    let user = run.enter(&row.id, profile);
                    let route = self.routes.of(&row.id);
                    self.live.insert(row.id.clone(), Live { user, seen: self.steps, route, route_position: 0 });
                    user
                }
            };
            let heading = (90.0 - row.angle).to_radians();
            if run.frame.push(user, State { x: row.x, y: row.y, z: row.z, heading, speed: row.speed }) {
                self.rows.push(place);
            }
        }
        let steps = self.steps;
        let gone = self.live.extract_if(|_, live| live.seen != steps).map(|(_, live)| live.user);
        let mut gone = gone.collect::<Vec<_>>();
        gone.sort_unstable();
        gone.into_iter().for_each(|user| run.leave(user));
        Ok(())
    }

    fn place(&mut self, run: &mut Run, row: u32) {
        let Some(recorded) = self.rows.get(row as usize).and_then(|place| self.step.rows().get(*place as usize)) else {
            return;
        };
        let placement = run.net().and_then(|net| self.live.get_mut(&recorded.id)?.placement(net, recorded));
        if let Some(placement) = placement {
            run.place(row, &placement);
        }
    }
}

impl Live {
    fn placement(&mut self, net: &Net, row: &Row) -> Option<Placement> {
        let lane = net.lane(&row.lane)?;
        let edge = net.lanes[lane.0 as usize].edge;
        let find = |edge: EdgeIndex| self.route[self.route_position..].iter().position(|known| *known == edge);
        if net.edges[edge.0 as usize].function == EdgeFunction::Normal {
            self.route_position += find(edge).unwrap_or(0);
        } else if let Some(link) = net.lanes[lane.0 as usize].links.first() {
            // Within a junction it is on the way from the edge before.
            let to = net.lanes[link.to.0 as usize].edge;
            self.route_position += find(to).map_or(0, |further| further.saturating_sub(1));
        }
        Some(Placement {
            lane,
            position: row.position,
            route: self.route.clone(),
            route_position: self.route_position,
            lateral_speed: row.lateral_speed,
        })
    }
}
