//! The vehicles or the persons that libsumo simulates: which are in the scene, and their states.

use std::ops::RangeFrom;

use closecall::{ProfileIndex, Roster, State, UserIndex};
use closecall_run::Run;
use pyo3::prelude::*;
use pyo3::types::PyString;
use rustc_hash::{FxHashMap, FxHashSet};

use super::compiled::KeptAddress;
use super::getters::Getters;
use super::reading::Domain;

/// The getters of vehicles or of persons, and those of them that are in the scene.
pub(super) struct LibsumoDomain {
    departed: Py<PyAny>,
    arrived: Py<PyAny>,
    ids: Py<PyAny>,
    type_id: Py<PyAny>,
    pub getters: Getters,
    /// Whether their addresses are kept between steps.
    keeps_addresses: bool,
    /// The road users in the scene; the roster has their ids.
    pub live: Vec<UserIndex>,
    /// Their addresses in SUMO's memory, in the same order.
    kept: Vec<KeptAddress>,
    /// Their indices in `live` in the order of their ids, in which SUMO finds them fastest.
    by_id: Vec<u32>,
    parked: FxHashSet<UserIndex>,
    /// The ids of the routes of vehicles that may change their route.
    pub routes: FxHashMap<UserIndex, Box<str>>,
}

impl LibsumoDomain {
    pub fn new(module: &Bound<PyAny>, domain: Domain) -> PyResult<Self> {
        let function = |name: &str| module.getattr(name).map(Bound::unbind);
        let (name, infix) = match domain {
            Domain::Vehicle => ("vehicle", ""),
            Domain::Person => ("person", "Person"),
        };
        Ok(Self {
            departed: function(&format!("simulation_getDeparted{infix}IDList"))?,
            arrived: function(&format!("simulation_getArrived{infix}IDList"))?,
            ids: function(&format!("{name}_getIDList"))?,
            type_id: function(&format!("{name}_getTypeID"))?,
            getters: Getters::new(module, domain)?,
            keeps_addresses: false,
            live: Vec::new(),
            kept: Vec::new(),
            by_id: Vec::new(),
            parked: FxHashSet::default(),
            routes: FxHashMap::default(),
        })
    }

    /// Keeps the addresses of road users between steps: only SUMO removes road users, and every step is read.
    pub fn keep_addresses(&mut self) {
        self.keeps_addresses = true;
    }

    /// Adds the road users that entered and removes those that left since the last step; returns the places in `live` of
    /// those that entered.
    pub fn update(
        &mut self,
        py: Python,
        run: &mut Run,
        jumped: bool,
        mut profile: impl FnMut(&mut Run, &str) -> PyResult<ProfileIndex>,
    ) -> PyResult<RangeFrom<usize>> {
        if jumped {
            let now = self.ids.bind(py).call0()?;
            let gone = (0..self.live.len())
                .filter(|&place| !now.contains(&**run.roster.id(self.live[place])).unwrap_or(false))
                .collect::<Vec<_>>();
            for place in gone.into_iter().rev() {
                self.remove(run, place);
            }
            let entered = self.live.len()..;
            for id in now.try_iter()? {
                self.add(py, run, id?.cast_into()?, &mut profile)?;
            }
            return Ok(entered);
        }
        for id in self.arrived.bind(py).call0()?.try_iter()? {
            if let Some(place) = self.find(&run.roster, id?.extract::<&str>()?) {
                self.remove(run, place);
            }
        }
        let entered = self.live.len()..;
        for id in self.departed.bind(py).call0()?.try_iter()? {
            self.add(py, run, id?.cast_into()?, &mut profile)?;
        }
        Ok(entered)
    }

    fn add(
        &mut self,
        py: Python,
        run: &mut Run,
        id: Bound<PyString>,
        profile: &mut impl FnMut(&mut Run, &str) -> PyResult<ProfileIndex>,
    ) -> PyResult<()> {
        let name = id.extract::<&str>()?;
        let Err(rank) = self.rank(&run.roster, name) else { return Ok(()) };
        let Ok(type_id) = self.type_id.bind(py).call1((&id,)) else {
            // It departed and arrived within one step.
            return Ok(());
        };
        let profile = profile(run, type_id.extract::<&str>()?)?;
        self.getters.compare(py, name);
        let user = run.enter(name, profile);
        self.live.push(user);
        self.kept.push(KeptAddress::default());
        self.by_id.insert(rank, self.live.len() as u32 - 1);
        Ok(())
    }

    /// Removes the road user at a place in `live`.
    pub fn remove(&mut self, run: &mut Run, place: usize) {
        let last = self.live.len() - 1;
        let rank = |place: usize| self.rank(&run.roster, run.roster.id(self.live[place]));
        if let (Ok(own), Ok(of_last)) = (rank(place), rank(last)) {
            self.by_id[of_last] = place as u32;
            self.by_id.remove(own);
        }
        let user = self.live.swap_remove(place);
        self.kept.swap_remove(place);
        self.parked.remove(&user);
        self.routes.remove(&user);
        run.leave(user);
    }

    /// Notes that the vehicle at a place in `live` parks or no longer does.
    pub fn park(&mut self, place: usize, parks: bool) {
        let user = self.live[place];
        if parks {
            self.parked.insert(user)
        } else {
            self.parked.remove(&user)
        };
    }

    /// The place in `live` of the road user with this id.
    pub fn find(&self, roster: &Roster, id: &str) -> Option<usize> {
        self.rank(roster, id).ok().map(|rank| self.by_id[rank] as usize)
    }

    /// The place of an id in `by_id`; the error is where it would be.
    fn rank(&self, roster: &Roster, id: &str) -> Result<usize, usize> {
        self.by_id.binary_search_by(|&place| (**roster.id(self.live[place as usize])).cmp(id))
    }

    /// Reads all states into the run's frame. Road users that a script has removed from the simulation since the last step
    /// leave the scene: SUMO's list of arrivals does not contain them.
    pub fn read(&mut self, py: Python, run: &mut Run) -> PyResult<()> {
        self.read_all(py, run).or_else(|error| {
            let is_unknown = |user: UserIndex| self.type_id.bind(py).call1((&**run.roster.id(user),)).is_err();
            let gone = (0..self.live.len()).filter(|&place| is_unknown(self.live[place])).collect::<Vec<_>>();
            if gone.is_empty() {
                return Err(error);
            }
            gone.into_iter().rev().for_each(|place| self.remove(run, place));
            self.read_all(py, run)
        })
    }

    fn read_all(&mut self, py: Python, run: &mut Run) -> PyResult<()> {
        let Self { live, kept, by_id, parked, getters, keeps_addresses, .. } = self;
        let roster = &run.roster;
        let fill = |states: &mut [State]| {
            for place in by_id.iter().map(|place| *place as usize) {
                let user = live[place];
                let kept = &mut kept[place];
                if !parked.contains(&user)
                    && let Some(state) = getters.state(py, roster.id(user), keeps_addresses.then_some(kept))?
                {
                    states[place] = state;
                }
            }
            Ok(())
        };
        run.frame.extend(live.iter().copied(), fill)
    }
}
