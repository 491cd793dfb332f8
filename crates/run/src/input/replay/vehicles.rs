//! The vehicles of a recording, numbered in the order of arrival, with what each has driven so far.

use std::collections::VecDeque;
use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::drive::Drive;
use crate::Result;
use closecall::util::units::Second;

/// A vehicle that comes back within this time, in s, continues its route: SUMO takes a stuck vehicle off the net and puts
/// it back further along.
const ABSENCE: Second = 600.0;

/// The vehicles in the scene, and those that left it less than [`ABSENCE`] ago.
#[derive(Debug, Default)]
pub(super) struct Vehicles {
    count: u64,
    /// By the recording's number of the road user.
    present: Vec<Option<Vehicle>>,
    absent: FxHashMap<Arc<str>, Absent>,
    by_time: VecDeque<(Second, Arc<str>)>,
}

/// A vehicle.
#[derive(Debug)]
pub(super) struct Vehicle {
    pub number: u64,
    pub drive: Drive,
}

#[derive(Debug)]
struct Absent {
    since: Second,
    vehicle: Vehicle,
}

impl Vehicles {
    /// A vehicle that is in the scene.
    #[inline]
    pub fn get_mut(&mut self, user: u32) -> Option<&mut Vehicle> {
        self.present.get_mut(user as usize)?.as_mut()
    }

    /// Numbers a vehicle that enters; a returning vehicle keeps its drive.
    pub fn enter(&mut self, user: u32, id: &str) -> &mut Vehicle {
        let vehicle = match self.absent.remove(id) {
            Some(Absent { since, mut vehicle }) => {
                vehicle.drive.lose_sight(since);
                vehicle
            }
            None => {
                self.count += 1;
                Vehicle { number: self.count - 1, drive: Drive::default() }
            }
        };
        let place = user as usize;
        if self.present.len() <= place {
            self.present.resize_with(place + 1, || None);
        }
        self.present[place].insert(vehicle)
    }

    /// A vehicle leaves; what it has driven is kept in case it comes back.
    pub fn leave(&mut self, user: u32, id: &str, time: Second) {
        let Some(vehicle) = self.present.get_mut(user as usize).and_then(Option::take) else { return };
        let id: Arc<str> = id.into();
        self.absent.insert(id.clone(), Absent { since: time, vehicle });
        self.by_time.push_back((time, id));
    }

    /// Forgets the vehicles that have been absent for too long.
    ///
    /// # Errors
    /// Those of `forgotten`.
    pub(crate) fn forget(
        &mut self,
        time: Second,
        mut forgotten: impl FnMut(&str, Vehicle) -> Result<()>,
    ) -> Result<()> {
        while self.by_time.front().is_some_and(|(since, _)| *since < time - ABSENCE) {
            let Some((since, id)) = self.by_time.pop_front() else { break };
            // A vehicle that came back and left again has a later entry.
            if self.absent.get(&id).is_some_and(|absent| absent.since == since)
                && let Some(absent) = self.absent.remove(&id)
            {
                forgotten(&id, absent.vehicle)?;
            }
        }
        Ok(())
    }

    /// Takes the vehicles in the scene, each with the recording's number.
    pub(crate) fn take_present(&mut self) -> impl Iterator<Item = (u32, Vehicle)> {
        let present = std::mem::take(&mut self.present);
        (0..).zip(present).filter_map(|(user, vehicle)| Some((user, vehicle?)))
    }
}
