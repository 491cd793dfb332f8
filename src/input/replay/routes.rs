//! Routes for a replay: an fcd-output does not contain them, but they follow from where the vehicles drove.
//!
//! They are collected before the replay begins and wait in temporary files until their vehicles enter the scene. Only the
//! routes of vehicles in the scene are in memory.

use std::collections::VecDeque;
use std::io::{BufReader, BufWriter, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rustc_hash::FxHashMap;
use tempfile::{SpooledTempFile, spooled_tempfile};

use super::lanes::Lanes;
use super::recording::Recording;
use super::rows::{RecordedRow, RecordedStep};
use crate::traffic::net::{EdgeIndex, Net};
use crate::util::units::Second;
use crate::{Error, Result};

/// A vehicle that comes back within this time, in s, continues its route: SUMO takes a stuck vehicle off the net and puts
/// it back further along.
const ABSENCE: Second = 600.0;
/// Up to this size, in bytes, a temporary file stays in memory.
const IN_MEMORY: usize = 1 << 14;
/// The size of an entry of `places`, in bytes: where the route begins and its number of edges.
const ENTRY: u64 = 16;

/// The edges that each vehicle drove, in order.
pub struct Routes {
    recording: PathBuf,
    /// The edges of all routes, one after the other.
    edges: SpooledTempFile,
    /// For every vehicle, in the order of arrival, where its route begins in `edges`, and its number of edges.
    places: SpooledTempFile,
    /// The vehicle's number for each time that a vehicle enters the scene. One that comes back enters again.
    entering: BufReader<SpooledTempFile>,
}

impl Routes {
    /// Reads the routes of a recording. In one that is cut short, they end there.
    ///
    /// # Errors
    /// Those of [`Recording`]; [`Error::File`] if a temporary file cannot be written.
    pub fn read(path: &Path, net: &Net) -> Result<Self> {
        let mut recording = Recording::open_for_lanes(path)?;
        let mut step = RecordedStep::default();
        let mut lanes = Lanes::default();
        let mut vehicles = Vehicles::default();
        let mut writer = RouteWriter::default();
        // By the recording's number of the road user.
        let mut driven: Vec<Vec<EdgeIndex>> = Vec::new();
        loop {
            match recording.next_step(&mut step) {
                Ok(true) => {}
                Ok(false) | Err(Error::CutShort { .. }) => break,
                Err(error) => return Err(error),
            }
            for row in step.rows().iter().filter(|row| !row.person) {
                let user = row.user as usize;
                if vehicles.of(row.user).is_none() {
                    let (number, route) = vehicles.enter(row, &recording);
                    writer.enter(number).map_err(unwritable)?;
                    if driven.len() <= user {
                        driven.resize_with(user + 1, Vec::new);
                    }
                    driven[user] = route;
                }
                let Some(edge) = lanes.edge(row.lane, &recording, net) else { continue };
                if driven[user].last() != Some(&edge) {
                    driven[user].push(edge);
                }
            }
            for user in step.gone() {
                let route = driven.get_mut(*user as usize).map(std::mem::take).unwrap_or_default();
                vehicles.leave(*user, recording.id(*user), step.time, route);
            }
            vehicles.forget(step.time, |number, route| writer.write(number, &route)).map_err(unwritable)?;
        }
        for (number, user) in vehicles.present() {
            writer.write(number, &driven[user]).map_err(unwritable)?;
        }
        vehicles.forget(Second::INFINITY, |number, route| writer.write(number, &route)).map_err(unwritable)?;
        writer.finish(path).map_err(unwritable)
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
            Err(error) => Err(unwritable(error)),
        }
    }

    /// The route of a vehicle by its number; empty if it was never on a normal edge.
    ///
    /// # Errors
    /// [`Error::File`] if the temporary file cannot be read.
    pub fn of(&mut self, number: u64) -> Result<Arc<[EdgeIndex]>> {
        self.read_back(number).map_err(unwritable)
    }

    fn read_back(&mut self, number: u64) -> std::io::Result<Arc<[EdgeIndex]>> {
        let mut entry = [0; ENTRY as usize];
        self.places.seek(SeekFrom::Start(number * ENTRY))?;
        self.places.read_exact(&mut entry)?;
        let [start, count] = halves(entry);
        let mut bytes = vec![0; 4 * count as usize];
        self.edges.seek(SeekFrom::Start(start))?;
        self.edges.read_exact(&mut bytes)?;
        Ok(bytes
            .chunks_exact(4)
            .map(|edge| EdgeIndex(u32::from_le_bytes([edge[0], edge[1], edge[2], edge[3]])))
            .collect())
    }
}

fn halves(entry: [u8; ENTRY as usize]) -> [u64; 2] {
    let both = u128::from_le_bytes(entry);
    [both as u64, (both >> 64) as u64]
}

fn unwritable(error: std::io::Error) -> Error {
    Error::file(&std::env::temp_dir(), error)
}

struct RouteWriter {
    edges: BufWriter<SpooledTempFile>,
    places: SpooledTempFile,
    entering: BufWriter<SpooledTempFile>,
    length: u64,
}

impl Default for RouteWriter {
    fn default() -> Self {
        let [edges, entering] = [(); 2].map(|()| BufWriter::new(spooled_tempfile(IN_MEMORY)));
        Self { edges, places: spooled_tempfile(IN_MEMORY), entering, length: 0 }
    }
}

impl RouteWriter {
    fn enter(&mut self, number: u64) -> std::io::Result<()> {
        self.entering.write_all(&number.to_le_bytes())
    }

    fn write(&mut self, number: u64, route: &[EdgeIndex]) -> std::io::Result<()> {
        let entry = u128::from(self.length) | (route.len() as u128) << 64;
        self.places.seek(SeekFrom::Start(number * ENTRY))?;
        self.places.write_all(&entry.to_le_bytes())?;
        for edge in route {
            self.edges.write_all(&edge.0.to_le_bytes())?;
        }
        self.length += 4 * route.len() as u64;
        Ok(())
    }

    fn finish(self, recording: &Path) -> std::io::Result<Routes> {
        let written = |file: BufWriter<SpooledTempFile>| file.into_inner().map_err(std::io::IntoInnerError::into_error);
        let edges = written(self.edges)?;
        let mut entering = written(self.entering)?;
        entering.rewind()?;
        Ok(Routes { recording: recording.to_owned(), edges, places: self.places, entering: BufReader::new(entering) })
    }
}

/// The vehicles of a recording, numbered in the order of arrival.
#[derive(Debug, Default)]
struct Vehicles {
    count: u64,
    /// The vehicle's number, by the recording's number of the road user.
    present: Vec<Option<u64>>,
    /// Vehicles that left less than [`ABSENCE`] ago.
    absent: FxHashMap<Arc<str>, Absent>,
    by_time: VecDeque<(Second, Arc<str>)>,
}

#[derive(Debug)]
struct Absent {
    number: u64,
    since: Second,
    route: Vec<EdgeIndex>,
}

impl Vehicles {
    /// The number of a vehicle that is in the scene.
    #[inline]
    fn of(&self, user: u32) -> Option<u64> {
        self.present.get(user as usize).copied().flatten()
    }

    /// Numbers a vehicle that enters; one that comes back has a route already.
    fn enter(&mut self, row: &RecordedRow, recording: &Recording) -> (u64, Vec<EdgeIndex>) {
        let (number, route) = match self.absent.remove(recording.id(row.user)) {
            Some(before) => (before.number, before.route),
            None => {
                self.count += 1;
                (self.count - 1, Vec::new())
            }
        };
        let user = row.user as usize;
        if self.present.len() <= user {
            self.present.resize(user + 1, None);
        }
        self.present[user] = Some(number);
        (number, route)
    }

    /// A vehicle leaves; its route is kept in case it comes back.
    fn leave(&mut self, user: u32, id: &str, time: Second, route: Vec<EdgeIndex>) {
        let Some(number) = self.present.get_mut(user as usize).and_then(Option::take) else { return };
        let id: Arc<str> = id.into();
        self.absent.insert(id.clone(), Absent { number, since: time, route });
        self.by_time.push_back((time, id));
    }

    /// Forgets the vehicles that have been absent for too long.
    fn forget(
        &mut self,
        time: Second,
        mut forgotten: impl FnMut(u64, Vec<EdgeIndex>) -> std::io::Result<()>,
    ) -> std::io::Result<()> {
        while self.by_time.front().is_some_and(|(since, _)| *since < time - ABSENCE) {
            let Some((since, id)) = self.by_time.pop_front() else { break };
            // A vehicle that came back and left again has a later entry.
            if self.absent.get(&id).is_some_and(|absent| absent.since == since)
                && let Some(absent) = self.absent.remove(&id)
            {
                forgotten(absent.number, absent.route)?;
            }
        }
        Ok(())
    }

    /// The vehicles in the scene: the vehicle's number and the recording's.
    fn present(&self) -> impl Iterator<Item = (u64, usize)> {
        self.present.iter().zip(0..).filter_map(|(number, user)| number.map(|number| (number, user)))
    }
}
