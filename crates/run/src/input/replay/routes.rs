//! Routes for a replay: an fcd-output does not contain them, but they follow from where the vehicles drove, from the route
//! files and from the net.
//!
//! They are collected before the replay begins and wait in temporary files until their vehicles enter the scene. Only the
//! routes of vehicles in the scene are in memory.

use std::io::{BufReader, BufWriter, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tempfile::SpooledTempFile;

use super::complete_route::complete;
use super::connections::Connections;
use super::demand::PlannedRoutes;
use super::drive::Moment;
use super::lanes::{Lanes, edges_of, is_against};
use super::lists::{ListWriter, Lists, Place, temporary, unusable};
use super::recorded_step::RecordedStep;
use super::recording::Recording;
use super::vehicles::{Vehicle, Vehicles};
use crate::net::projection::Projection;
use crate::{Error, Result};
use closecall::traffic::net::{EdgeIndex, Net};

/// The size of an entry of `places`, in bytes: where the route begins and its length.
const ENTRY: u64 = 16;

/// The edges that each vehicle drove, and those that it was to drive where they are known.
pub struct Routes {
    recording: PathBuf,
    /// All routes, one after the other: the edges, then the step in which each was reached.
    lists: Lists,
    /// For every vehicle, in the order of arrival, where its route is in `lists`.
    places: SpooledTempFile,
    /// The vehicle's number for each time that a vehicle enters the scene. A returning vehicle enters again.
    entering: BufReader<SpooledTempFile>,
    /// The number of places where nothing tells which edges were driven.
    pub gaps: u64,
}

/// A route.
#[derive(Clone, Debug)]
pub struct Route {
    /// Its edges; none if the vehicle was never seen on one.
    pub edges: Arc<[EdgeIndex]>,
    /// For each edge, the number of the step in which it was reached, in ascending order.
    pub reached: Box<[u32]>,
}

impl Routes {
    /// Reads the routes of a recording. If it is cut short, they end there. `stopped` is asked in each step whether to stop.
    ///
    /// # Errors
    /// Those of [`Recording`]; [`Error::File`] if a temporary file cannot be written; [`Error::Stopped`].
    pub fn read(
        path: &Path,
        net: &Net,
        planned: PlannedRoutes,
        projection: Option<&Projection>,
        stopped: &mut dyn FnMut() -> bool,
    ) -> Result<Self> {
        let mut recording = Recording::open_for_lanes(path)?;
        let mut step = RecordedStep::default();
        let mut lanes = Lanes::default();
        let mut vehicles = Vehicles::default();
        let mut writer = RouteWriter::new(net, planned);
        let mut moment: Option<Moment> = None;
        loop {
            match recording.next_step(&mut step) {
                Ok(true) => {}
                Ok(false) | Err(Error::CutShort { .. }) => break,
                Err(error) => return Err(error),
            }
            if stopped() {
                return Err(Error::Stopped);
            }
            if let Some(projection) = projection {
                step.project(projection).map_err(|message| Error::content(path, message))?;
            }
            let time = step.time;
            let now = moment.map_or(Moment { step: 0, time, before: time }, |last| Moment {
                step: last.step + 1,
                time,
                before: last.time,
            });
            moment = Some(now);
            for row in step.rows().iter().filter(|row| !row.person) {
                let drive = match vehicles.get_mut(row.user) {
                    Some(vehicle) => &mut vehicle.drive,
                    None => {
                        let vehicle = vehicles.enter(row.user, recording.id(row.user));
                        writer.enter(vehicle.number)?;
                        &mut vehicle.drive
                    }
                };
                let lane = lanes.lane(row.lane, |lane| recording.lane(lane), net);
                match lane.and_then(|lane| Some((lane, edges_of(net, lane)?))) {
                    None => drive.lose_sight(now.before),
                    Some((lane, (edge, ahead))) if is_against(row, net, lane) => {
                        drive.against(edge, ahead, &now);
                        // Its next row tells whether it has turned.
                        recording.forget_lane(row.user);
                    }
                    Some((_, (edge, ahead))) => drive.along(edge, ahead, &now),
                }
            }
            for user in step.gone() {
                vehicles.leave(*user, recording.id(*user), step.time);
            }
            vehicles.forget(step.time, |id, vehicle| writer.write(id, vehicle))?;
        }
        for (user, vehicle) in vehicles.take_present() {
            writer.write(recording.id(user), vehicle)?;
        }
        vehicles.forget(f64::INFINITY, |id, vehicle| writer.write(id, vehicle))?;
        writer.finish(path)
    }

    /// The number of the vehicle that enters the scene next; to be called once for each, in the recording's order.
    ///
    /// # Errors
    /// [`Error::Content`] if more vehicles enter than when the routes were read; [`Error::File`] if the temporary file cannot
    /// be read.
    pub fn enter(&mut self) -> Result<u64> {
        let mut number = [0; 8];
        match self.entering.read_exact(&mut number) {
            Ok(()) => Ok(u64::from_le_bytes(number)),
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => {
                let message = "it has grown since its routes were read: check it when it is complete";
                Err(Error::content(&self.recording, message))
            }
            Err(error) => Err(unusable(error)),
        }
    }

    /// The route of a vehicle by its number; empty if it was never on a normal edge.
    ///
    /// # Errors
    /// [`Error::File`] if the temporary file cannot be read.
    pub fn of(&mut self, number: u64) -> Result<Route> {
        let mut entry = [0; ENTRY as usize];
        self.places.seek(SeekFrom::Start(number * ENTRY)).map_err(unusable)?;
        self.places.read_exact(&mut entry).map_err(unusable)?;
        let both = u128::from_le_bytes(entry);
        let list = self.lists.read(Place { start: both as u64, length: (both >> 64) as u64 })?;
        let (edges, reached) = list.split_at(list.len() / 2);
        Ok(Route { edges: edges.iter().map(|edge| EdgeIndex(*edge)).collect(), reached: reached.into() })
    }
}

/// Completes and writes the routes.
struct RouteWriter<'a> {
    net: &'a Net,
    planned: PlannedRoutes,
    connections: Connections,
    lists: ListWriter,
    places: SpooledTempFile,
    entering: BufWriter<SpooledTempFile>,
    gaps: u64,
}

impl<'a> RouteWriter<'a> {
    fn new(net: &'a Net, planned: PlannedRoutes) -> Self {
        Self {
            net,
            planned,
            connections: Connections::default(),
            lists: ListWriter::default(),
            places: temporary(),
            entering: BufWriter::new(temporary()),
            gaps: 0,
        }
    }

    fn enter(&mut self, number: u64) -> Result<()> {
        self.entering.write_all(&number.to_le_bytes()).map_err(unusable)
    }

    fn write(&mut self, id: &str, vehicle: Vehicle) -> Result<()> {
        let planned = self.planned.of(id)?;
        let completed = complete(&vehicle.drive.finish(), &planned, self.net, &mut self.connections);
        self.gaps += completed.gaps;
        let edges = completed.edges.iter().map(|(edge, _)| edge.0);
        let place = self.lists.write(edges.chain(completed.edges.iter().map(|(_, step)| *step)))?;
        let entry = u128::from(place.start) | u128::from(place.length) << 64;
        self.places.seek(SeekFrom::Start(vehicle.number * ENTRY)).map_err(unusable)?;
        self.places.write_all(&entry.to_le_bytes()).map_err(unusable)
    }

    fn finish(self, recording: &Path) -> Result<Routes> {
        let mut entering = self.entering.into_inner().map_err(|error| unusable(error.into_error()))?;
        entering.rewind().map_err(unusable)?;
        Ok(Routes {
            recording: recording.to_owned(),
            lists: self.lists.finish()?,
            places: self.places,
            entering: BufReader::new(entering),
            gaps: self.gaps,
        })
    }
}
