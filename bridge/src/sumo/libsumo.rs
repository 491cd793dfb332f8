//! From libsumo, in this process.
//!
//! States come from [`Getters`](super::getters::Getters). Everything else comes from the Python functions of libsumo's
//! compiled module, looked up once: with SUMO 1.28 a call takes 0.10 to 0.19 µs, and subscriptions take 2 µs per vehicle.

use closecall::util::units::Second;
use closecall::{Options, Placement};
use closecall_run::Run;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;
use pyo3::types::PyString;

use super::getters::Through;
use super::libsumo_domain::LibsumoDomain;
use super::reading::Domain;
use super::simulation::{self, TypeProfiles};

/// libsumo's functions and the road users in the scene.
pub struct Libsumo {
    time: Py<PyAny>,
    collisions: Py<PyAny>,
    vehicles: LibsumoDomain,
    persons: LibsumoDomain,
    stop_state: Py<PyAny>,
    edge_of_person: Py<PyAny>,
    /// Whether the lists of a step do not name all that entered or left since the last one.
    looks_up_all: bool,
    /// The getters of the vehicles that begin and end to park.
    parking: [Py<PyAny>; 2],
    types: TypeProfiles,
    step_length: Second,
    get: PlacementGetters,
    /// The ids of the traffic lights, and what they show.
    lights: [Py<PyAny>; 2],
    /// The traffic lights of the run's net that the simulation has; none before the first step.
    known_lights: Option<Vec<(u32, Py<PyString>)>>,
}

/// The getters of a vehicle's placement and route.
struct PlacementGetters {
    lane: Py<PyAny>,
    lane_position: Py<PyAny>,
    lateral_speed: Py<PyAny>,
    route_id: Py<PyAny>,
    route_index: Py<PyAny>,
    route: Py<PyAny>,
    parameter: Py<PyAny>,
    departure: Py<PyAny>,
    lane_change: Py<PyAny>,
}

/// Whether the vehicles of each list in [`Libsumo::parking`] park from now on.
const PARKS: [bool; 2] = [true, false];

impl Libsumo {
    pub fn new(module: &Bound<PyAny>, options: &Options) -> PyResult<Self> {
        let compiled = module.py().import("libsumo")?.getattr("_libsumo")?;
        let function = |name: &str| compiled.getattr(name).map(Bound::unbind);
        Ok(Self {
            time: function("simulation_getTime")?,
            collisions: function("simulation_getCollisions")?,
            vehicles: LibsumoDomain::new(&compiled, Domain::Vehicle)?,
            persons: LibsumoDomain::new(&compiled, Domain::Person)?,
            looks_up_all: false,
            parking: [
                function("simulation_getParkingStartingVehiclesIDList")?,
                function("simulation_getParkingEndingVehiclesIDList")?,
            ],
            stop_state: function("vehicle_getStopState")?,
            edge_of_person: function("person_getRoadID")?,
            types: TypeProfiles::new(module, options)?,
            step_length: module.getattr("simulation")?.call_method0("getDeltaT")?.extract()?,
            lights: [function("trafficlight_getIDList")?, function("trafficlight_getRedYellowGreenState")?],
            known_lights: None,
            get: PlacementGetters {
                lane: function("vehicle_getLaneID")?,
                lane_position: function("vehicle_getLanePosition")?,
                lateral_speed: function("vehicle_getLateralSpeed")?,
                route_id: function("vehicle_getRouteID")?,
                route_index: function("vehicle_getRouteIndex")?,
                route: function("vehicle_getRoute")?,
                parameter: function("vehicle_getParameter")?,
                departure: function("vehicle_getDeparture")?,
                lane_change: function("vehicle_getLaneChangeState")?,
            },
        })
    }

    pub fn look_up_all(&mut self) {
        self.looks_up_all = true;
    }

    pub fn set_exclusive(&mut self) {
        self.vehicles.keep_addresses();
        self.persons.keep_addresses();
    }

    /// What road users are read through: where either vehicles or persons need Python, both use it.
    pub fn through(&self) -> Through {
        self.vehicles.getters.through().min(self.persons.getters.through())
    }

    /// Why road users are read more slowly than is to be expected; only the first time.
    pub fn take_remark(&mut self) -> Option<String> {
        let of_persons = self.persons.getters.take_remark();
        self.vehicles.getters.take_remark().or(of_persons)
    }

    pub fn time(&self, py: Python) -> PyResult<Second> {
        Ok(simulation::time_of_states(self.time.bind(py).call0()?.extract()?, self.step_length))
    }

    pub fn pull(&mut self, py: Python, run: &mut Run, time: Second) -> PyResult<()> {
        // The lists of departed road users cover the last step only; after a jump over several, all are looked up.
        let last = run.time();
        let jumped = self.looks_up_all || last.is_none_or(|last| time - last > 1.5 * self.step_length);
        run.begin_step(time);
        run.set_collisions_of_sumo(simulation::collisions(&self.collisions.bind(py).call0()?)?);
        self.read_lights(py, run)?;
        if let (true, Some(last)) = (jumped, last) {
            self.remove_replaced(py, run, last)?;
        }
        let entered = self.vehicles.update(py, run, jumped, |run, name| self.types.vehicle(py, run, name))?;
        for user in &self.vehicles.live[entered] {
            let id = run.roster.id(*user);
            if run.has_fixed_routes() && self.may_reroute(py, id)? {
                run.set_fixed_routes(false);
            }
        }
        self.persons.update(py, run, jumped, |run, name| self.types.person(py, run, name))?;
        if self.through() == Through::Python {
            self.vehicles.getters.use_python();
            self.persons.getters.use_python();
        }
        self.park(py, run, jumped)?;
        self.vehicles.read(py, run)?;
        self.persons.read(py, run)?;
        self.read_stops(py, run)?;
        simulation::edges_of_persons(run, |id| self.edge_of_person.bind(py).call1((id,)))
    }

    /// Asks which vehicles in conflict are at a scheduled stop; those that park off the road are not in the frame.
    fn read_stops(&self, py: Python, run: &mut Run) -> PyResult<()> {
        for user in run.standing() {
            let id: &str = run.roster.id(user);
            if simulation::stops(self.stop_state.bind(py).call1((id,))?.extract()?) {
                run.set_stopped(user);
            }
        }
        Ok(())
    }

    /// Reads what the traffic lights show.
    fn read_lights(&mut self, py: Python, run: &mut Run) -> PyResult<()> {
        let [ids, state] = &self.lights;
        let lights = match &mut self.known_lights {
            Some(known) => known,
            unknown => {
                let known = simulation::lights(run, &ids.bind(py).call0()?)?;
                unknown.insert(known)
            }
        };
        for (light, id) in lights {
            run.set_signal(*light, state.bind(py).call1((&*id,))?.extract::<&str>()?);
        }
        Ok(())
    }

    /// Removes the vehicles whose id belongs to another vehicle, which departed after this time.
    fn remove_replaced(&mut self, py: Python, run: &mut Run, last: Second) -> PyResult<()> {
        for place in (0..self.vehicles.live.len()).rev() {
            let id: &str = run.roster.id(self.vehicles.live[place]);
            // A vehicle that is no longer in the simulation has no departure.
            let departure = self.get.departure.bind(py).call1((id,)).and_then(|time| time.extract::<Second>());
            if departure.is_ok_and(|departure| departure > last) {
                self.vehicles.remove(run, place);
            }
        }
        Ok(())
    }

    /// Keeps track of the vehicles that park off the road: SUMO reports which begin and end to park.
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

    /// Whether a vehicle that has entered the scene carries a device that changes its route on the way.
    fn may_reroute(&self, py: Python, id: &str) -> PyResult<bool> {
        let parameter = |name: &str| self.get.parameter.bind(py).call1((id, name))?.extract::<String>();
        for device in ["has.taxi.device", "has.stationfinder.device"] {
            if parameter(device)? == "true" {
                return Ok(true);
            }
        }
        // Every trip has a device that finds its route. Without a period it does so only before departure.
        let has_router = parameter("has.rerouting.device")? == "true";
        Ok(has_router && parameter("device.rerouting.period")?.parse() != Ok(0.0))
    }

    pub fn place(&mut self, py: Python, run: &mut Run, rows: &[u32]) -> PyResult<()> {
        // A fixed route is asked for once; from then on the vehicle's path knows it.
        let stays = run.has_fixed_routes() && run.shortcuts().known_paths;
        for &row in rows {
            let Some(net) = run.net() else { return Ok(()) };
            let user = run.frame.user(row);
            let id: &str = run.roster.id(user);
            let ask = |getter: &Py<PyAny>| getter.bind(py).call1((id,));
            let LibsumoDomain { getters, routes, .. } = &mut self.vehicles;
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
                Some(simulation::route(net, ask(&self.get.route)?.extract::<Vec<PyBackedStr>>()?))
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
            if let Some(lanes) = run.changed_lanes(row) {
                let id: &str = run.roster.id(user);
                let states = self.get.lane_change.bind(py).call1((id, lanes.signum()))?;
                run.set_lane_change_state(row, simulation::lane_change_state(&states)?);
            }
        }
        Ok(())
    }
}
