//! From libsumo, in this process.
//!
//! States come from [`Getters`]; everything else is asked of the compiled module's own Python functions, bound once:
//! measured on SUMO 1.28, 0.10 to 0.19 µs a call, against 2 µs per vehicle for subscriptions.

use std::ops::RangeFrom;

use closecall::options::Options;
use closecall::run::Run;
use closecall::traffic::frame::State;
use closecall::traffic::placement::Placement;
use closecall::traffic::roster::{Roster, UserIndex};
use closecall::util::units::Second;
use pyo3::prelude::*;
use pyo3::types::PyString;
use rustc_hash::{FxHashMap, FxHashSet};

use super::getters::{Getters, Kept};
use super::reading;
use super::sumo::{self, Types};

/// libsumo's functions and who is in the scene.
pub struct Libsumo {
    time: Py<PyAny>,
    vehicles: Domain,
    persons: Domain,
    parking: [Py<PyAny>; 2],
    types: Types,
    step_length: Second,
    get: Placing,
}

/// Getters of a vehicle's place on the net and its route.
struct Placing {
    lane: Py<PyAny>,
    lane_position: Py<PyAny>,
    lateral_speed: Py<PyAny>,
    route_id: Py<PyAny>,
    route_index: Py<PyAny>,
    route: Py<PyAny>,
    parameter: Py<PyAny>,
    departure: Py<PyAny>,
}

/// What is asked of vehicles or of persons, and those of them that are in the scene.
struct Domain {
    departed: Py<PyAny>,
    arrived: Py<PyAny>,
    ids: Py<PyAny>,
    type_id: Py<PyAny>,
    getters: Getters,
    /// Whether they are found where they were, without their ids.
    keeps: bool,
    /// Those in the scene; their ids are the roster's.
    live: Vec<UserIndex>,
    /// Where SUMO has them, in the same order.
    kept: Vec<Kept>,
    /// Where in `live` everybody is, in the order of their ids, in which SUMO finds them soonest.
    by_id: Vec<u32>,
    parked: FxHashSet<UserIndex>,
    /// The ids of the routes of those who may get another one.
    routes: FxHashMap<UserIndex, Box<str>>,
}

/// Which state of a parked vehicle changed.
const PARKS: [bool; 2] = [true, false];

impl Libsumo {
    pub fn new(module: &Bound<PyAny>, options: &Options) -> PyResult<Self> {
        let compiled = module.getattr("_libsumo")?;
        let function = |name: &str| compiled.getattr(name).map(Bound::unbind);
        let domain = |name: &str, infix: &str, domain: reading::Domain| -> PyResult<Domain> {
            Ok(Domain {
                departed: function(&format!("simulation_getDeparted{infix}IDList"))?,
                arrived: function(&format!("simulation_getArrived{infix}IDList"))?,
                ids: function(&format!("{name}_getIDList"))?,
                type_id: function(&format!("{name}_getTypeID"))?,
                getters: Getters::new(&compiled, domain)?,
                keeps: false,
                live: Vec::new(),
                kept: Vec::new(),
                by_id: Vec::new(),
                parked: FxHashSet::default(),
                routes: FxHashMap::default(),
            })
        };
        Ok(Self {
            time: function("simulation_getTime")?,
            vehicles: domain("vehicle", "", reading::Domain::Vehicle)?,
            persons: domain("person", "Person", reading::Domain::Person)?,
            parking: [
                function("simulation_getParkingStartingVehiclesIDList")?,
                function("simulation_getParkingEndingVehiclesIDList")?,
            ],
            types: Types::new(module, options)?,
            step_length: module.getattr("simulation")?.call_method0("getDeltaT")?.extract()?,
            get: Placing {
                lane: function("vehicle_getLaneID")?,
                lane_position: function("vehicle_getLanePosition")?,
                lateral_speed: function("vehicle_getLateralSpeed")?,
                route_id: function("vehicle_getRouteID")?,
                route_index: function("vehicle_getRouteIndex")?,
                route: function("vehicle_getRoute")?,
                parameter: function("vehicle_getParameter")?,
                departure: function("vehicle_getDeparture")?,
            },
        })
    }

    pub fn set_exclusive(&mut self) {
        self.vehicles.keeps = true;
        self.persons.keeps = true;
    }

    pub fn time(&self, py: Python) -> PyResult<Second> {
        Ok(sumo::time_of_states(self.time.bind(py).call0()?.extract()?, self.step_length))
    }

    pub fn pull(&mut self, py: Python, run: &mut Run, time: Second) -> PyResult<()> {
        // Lists of who departed are those of the last step: after a jump over several, everybody is looked up.
        let last = run.time();
        let jumped = last.is_none_or(|last| time - last > 1.5 * self.step_length);
        run.begin(time);
        if let (true, Some(last)) = (jumped, last) {
            self.others_left(py, run, last)?;
        }
        let entered = self.vehicles.update(py, run, jumped, |run, name| self.types.vehicle(py, run, name))?;
        for user in &self.vehicles.live[entered] {
            let id = run.roster.id(*user);
            if run.has_fixed_routes() && self.may_reroute(py, id)? {
                run.set_fixed_routes(false);
            }
        }
        self.persons.update(py, run, jumped, |run, name| self.types.person(py, run, name))?;
        self.park(py, run, jumped)?;
        self.vehicles.read(py, run)?;
        self.persons.read(py, run)
    }

    /// Lets the vehicles leave whose id another has, which departed after this time.
    fn others_left(&mut self, py: Python, run: &mut Run, last: Second) -> PyResult<()> {
        for place in (0..self.vehicles.live.len()).rev() {
            let id: &str = run.roster.id(self.vehicles.live[place]);
            // Who is not in the simulation any more has no departure.
            let departure = self.get.departure.bind(py).call1((id,)).and_then(|time| time.extract::<Second>());
            if departure.is_ok_and(|departure| departure > last) {
                self.vehicles.remove(run, place);
            }
        }
        Ok(())
    }

    /// Keeps account of who is parked off the road: SUMO says who begins and who ends.
    fn park(&mut self, py: Python, run: &Run, jumped: bool) -> PyResult<()> {
        for (list, parks) in self.parking.iter().zip(PARKS) {
            for id in list.bind(py).call0()?.try_iter()? {
                if let Some(place) = self.vehicles.find(&run.roster, id?.extract::<&str>()?) {
                    self.vehicles.park(place, parks);
                }
            }
        }
        if jumped {
            let is_parked = py.import("libsumo")?.getattr("vehicle")?.getattr("isStoppedParking")?;
            for place in 0..self.vehicles.live.len() {
                let id: &str = run.roster.id(self.vehicles.live[place]);
                self.vehicles.park(place, is_parked.call1((id,))?.extract()?);
            }
        }
        Ok(())
    }

    /// Whether a vehicle that has come into the scene carries a device that changes its route on the way.
    fn may_reroute(&self, py: Python, id: &str) -> PyResult<bool> {
        let parameter = |name: &str| self.get.parameter.bind(py).call1((id, name))?.extract::<String>();
        for device in ["has.taxi.device", "has.stationfinder.device"] {
            if parameter(device)? == "true" {
                return Ok(true);
            }
        }
        // Every trip has a device that looks for its route; without a period it does so before it departs, then never.
        let has_router = parameter("has.rerouting.device")? == "true";
        Ok(has_router && parameter("device.rerouting.period")?.parse() != Ok(0.0))
    }

    pub fn place(&mut self, py: Python, run: &mut Run, rows: &[u32]) -> PyResult<()> {
        // A route is asked for once: from then on the path that is laid along it knows it.
        let stays = run.has_fixed_routes() && run.shortcuts().known_paths;
        for &row in rows {
            let Some(net) = run.net() else { return Ok(()) };
            let user = run.frame.user(row);
            let id: &str = run.roster.id(user);
            let ask = |getter: &Py<PyAny>| getter.bind(py).call1((id,));
            let Domain { getters, routes, .. } = &mut self.vehicles;
            let has = |route: &str| -> PyResult<bool> {
                Ok(getters.has_route(id, route) || ask(&self.get.route_id)?.extract::<&str>()? == route)
            };
            let has_changed = !stays && !routes.get(&user).map_or(Ok(false), |known| has(known))?;
            if !has_changed && run.keeps_path(row) {
                continue;
            }
            let Some(lane) = net.lane(ask(&self.get.lane)?.extract::<&str>()?) else { continue };
            let position = usize::try_from(ask(&self.get.route_index)?.extract::<i64>()?).unwrap_or(0);
            let route = if has_changed || !run.knows_route(user, position) {
                Some(sumo::route(net, &ask(&self.get.route)?)?)
            } else {
                None
            };
            if has_changed {
                routes.insert(user, ask(&self.get.route_id)?.extract::<&str>()?.into());
            }
            let placement = Placement {
                lane,
                position: ask(&self.get.lane_position)?.extract()?,
                route,
                route_position: position,
                lateral_speed: ask(&self.get.lateral_speed)?.extract()?,
            };
            run.set_placement(row, &placement);
        }
        Ok(())
    }
}

impl Domain {
    /// Who came into the scene and who left it since the last step; returns where in `live` those are who came.
    fn update(
        &mut self,
        py: Python,
        run: &mut Run,
        jumped: bool,
        mut profile: impl FnMut(&mut Run, &str) -> PyResult<closecall::traffic::roster::ProfileIndex>,
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
        profile: &mut impl FnMut(&mut Run, &str) -> PyResult<closecall::traffic::roster::ProfileIndex>,
    ) -> PyResult<()> {
        let name = id.extract::<&str>()?;
        let Err(rank) = self.rank(&run.roster, name) else { return Ok(()) };
        let Ok(type_id) = self.type_id.bind(py).call1((&id,)) else {
            // It departed and arrived within the step.
            return Ok(());
        };
        let profile = profile(run, type_id.extract::<&str>()?)?;
        self.getters.enters(py, name);
        let user = run.enter(name, profile);
        self.live.push(user);
        self.kept.push(Kept::default());
        self.by_id.insert(rank, self.live.len() as u32 - 1);
        Ok(())
    }

    fn remove(&mut self, run: &mut Run, place: usize) {
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

    fn park(&mut self, place: usize, parks: bool) {
        let user = self.live[place];
        if parks {
            self.parked.insert(user)
        } else {
            self.parked.remove(&user)
        };
    }

    /// Where in `live` somebody is.
    fn find(&self, roster: &Roster, id: &str) -> Option<usize> {
        self.rank(roster, id).ok().map(|rank| self.by_id[rank] as usize)
    }

    /// Where an id is in the order of all; the error is where it would be.
    fn rank(&self, roster: &Roster, id: &str) -> Result<usize, usize> {
        self.by_id.binary_search_by(|&place| (**roster.id(self.live[place as usize])).cmp(id))
    }

    /// Everybody's state into the run's frame. Whom a script has taken out of the simulation since the last step, which
    /// SUMO's list of those who arrived does not say, leaves the scene.
    fn read(&mut self, py: Python, run: &mut Run) -> PyResult<()> {
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
        let Self { live, kept, by_id, parked, getters, keeps, .. } = self;
        let roster = &run.roster;
        let fill = |states: &mut [State]| {
            for place in by_id.iter().map(|place| *place as usize) {
                let (user, kept) = (live[place], &mut kept[place]);
                if !parked.contains(&user)
                    && let Some(state) = getters.state(py, roster.id(user), keeps.then_some(kept))?
                {
                    states[place] = state;
                }
            }
            Ok(())
        };
        run.frame.extend(live.iter().copied(), fill)
    }
}
