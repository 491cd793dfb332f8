//! From libsumo, in this process.
//!
//! Each getter is the compiled function itself, bound once, and is called with the same argument tuple in every step:
//! measured on SUMO 1.28, 0.10 to 0.19 µs a call, against 2 µs per vehicle for subscriptions.

use std::sync::Arc;

use closecall::encounter::Placement;
use closecall::frame::{State, UserIndex};
use closecall::net::EdgeIndex;
use closecall::options::Options;
use closecall::run::Run;
use closecall::units::Second;
use pyo3::prelude::*;
use pyo3::types::{PyString, PyTuple};
use rustc_hash::FxHashMap;

use super::sumo::{self, Types};

/// libsumo's functions and who is in the scene.
pub struct Libsumo {
    time: Py<PyAny>,
    vehicles: Domain,
    persons: Domain,
    parking: [Py<PyAny>; 2],
    types: Types,
    step_length: Second,
    last_time: Option<Second>,
    with_heights: bool,
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
}

/// Getters of vehicles or of persons, and those of them that are in the scene.
struct Domain {
    departed: Py<PyAny>,
    arrived: Py<PyAny>,
    ids: Py<PyAny>,
    position: Py<PyAny>,
    angle: Py<PyAny>,
    speed: Py<PyAny>,
    type_id: Py<PyAny>,
    inside: Option<Py<PyAny>>,
    live: Vec<Live>,
    places: FxHashMap<String, usize>,
    /// Who of `live` stands in the frame's rows from `first_row` on.
    rows: Vec<u32>,
    first_row: u32,
}

/// Somebody in the scene.
struct Live {
    id: Py<PyString>,
    arguments: Py<PyTuple>,
    user: UserIndex,
    parked: bool,
    route: Option<(Py<PyAny>, Arc<[EdgeIndex]>)>,
}

/// Which state of a parked vehicle changed.
const PARKS: [bool; 2] = [true, false];

impl Libsumo {
    pub fn new(module: &Bound<PyAny>, options: &Options, with_heights: bool) -> PyResult<Self> {
        let compiled = module.getattr("_libsumo")?;
        let function = |name: &str| compiled.getattr(name).map(Bound::unbind);
        let domain = |name: &str, infix: &str| -> PyResult<Domain> {
            let position = if with_heights { "getPosition3D" } else { "getPosition" };
            Ok(Domain {
                departed: function(&format!("simulation_getDeparted{infix}IDList"))?,
                arrived: function(&format!("simulation_getArrived{infix}IDList"))?,
                ids: function(&format!("{name}_getIDList"))?,
                position: function(&format!("{name}_{position}"))?,
                angle: function(&format!("{name}_getAngle"))?,
                speed: function(&format!("{name}_getSpeed"))?,
                type_id: function(&format!("{name}_getTypeID"))?,
                inside: if name == "person" { Some(function("person_getVehicle")?) } else { None },
                live: Vec::new(),
                places: FxHashMap::default(),
                rows: Vec::new(),
                first_row: 0,
            })
        };
        Ok(Self {
            time: function("simulation_getTime")?,
            vehicles: domain("vehicle", "")?,
            persons: domain("person", "Person")?,
            parking: [
                function("simulation_getParkingStartingVehiclesIDList")?,
                function("simulation_getParkingEndingVehiclesIDList")?,
            ],
            types: Types::new(module, options)?,
            step_length: module.getattr("simulation")?.call_method0("getDeltaT")?.extract()?,
            last_time: None,
            with_heights,
            get: Placing {
                lane: function("vehicle_getLaneID")?,
                lane_position: function("vehicle_getLanePosition")?,
                lateral_speed: function("vehicle_getLateralSpeed")?,
                route_id: function("vehicle_getRouteID")?,
                route_index: function("vehicle_getRouteIndex")?,
                route: function("vehicle_getRoute")?,
                parameter: function("vehicle_getParameter")?,
            },
        })
    }

    pub fn pull(&mut self, py: Python, run: &mut Run) -> PyResult<()> {
        let time: Second = self.time.bind(py).call0()?.extract()?;
        run.begin(sumo::time_of_states(time, self.step_length));
        // Lists of who departed are those of the last step: after a jump over several, everybody is looked up.
        let jumped = self.last_time.is_none_or(|last| time - last > 1.5 * self.step_length);
        self.last_time = Some(time);
        let before = self.vehicles.live.len();
        self.vehicles.update(py, run, jumped, |run, name| self.types.vehicle(py, run, name))?;
        for place in before.min(self.vehicles.live.len())..self.vehicles.live.len() {
            if run.has_fixed_routes() && self.may_reroute(py, &self.vehicles.live[place])? {
                run.routes_may_change();
            }
        }
        self.persons.update(py, run, jumped, |run, name| self.types.person(py, run, name))?;
        self.park(py, jumped)?;
        self.vehicles.read(py, run, self.with_heights)?;
        self.persons.read(py, run, self.with_heights)
    }

    /// Keeps account of who is parked off the road: SUMO says who begins and who ends.
    fn park(&mut self, py: Python, jumped: bool) -> PyResult<()> {
        for (list, parks) in self.parking.iter().zip(PARKS) {
            for id in list.bind(py).call0()?.try_iter()? {
                if let Some(&place) = self.vehicles.places.get(id?.extract::<&str>()?) {
                    self.vehicles.live[place].parked = parks;
                }
            }
        }
        if jumped {
            let vehicle = py.import("libsumo")?.getattr("vehicle")?;
            for live in &mut self.vehicles.live {
                live.parked = vehicle.call_method1("isStoppedParking", (&live.id,))?.extract()?;
            }
        }
        Ok(())
    }

    /// Whether a vehicle that has come into the scene carries a device that changes its route on the way.
    fn may_reroute(&self, py: Python, live: &Live) -> PyResult<bool> {
        let parameter = |name: &str| self.get.parameter.bind(py).call1((&live.id, name))?.extract::<String>();
        if parameter("has.taxi.device")? == "true" {
            return Ok(true);
        }
        // Every trip has a device that looks for its route; without a period it does so before it departs, then never.
        let has_router = parameter("has.rerouting.device")? == "true";
        Ok(has_router && parameter("device.rerouting.period")?.parse() != Ok(0.0))
    }

    pub fn place(&mut self, py: Python, run: &mut Run, rows: &[u32]) -> PyResult<()> {
        for &row in rows {
            let Some(place) = row.checked_sub(self.vehicles.first_row) else { continue };
            let Some(&live) = self.vehicles.rows.get(place as usize) else { continue };
            let live = &mut self.vehicles.live[live as usize];
            let ask = |getter: &Py<PyAny>| getter.bind(py).call1(live.arguments.bind(py));
            let Some(net) = run.net() else { return Ok(()) };
            let route_id = ask(&self.get.route_id)?;
            let known = live.route.as_ref().filter(|(id, _)| id.bind(py).eq(&route_id).unwrap_or(false));
            let route = match known {
                Some((_, route)) if run.keeps_path(row, route) => continue,
                Some((_, route)) => route.clone(),
                None => {
                    let route = sumo::route(net, &ask(&self.get.route)?)?;
                    live.route = Some((route_id.unbind(), route.clone()));
                    route
                }
            };
            let ask = |getter: &Py<PyAny>| getter.bind(py).call1(live.arguments.bind(py));
            let Some(net) = run.net() else { return Ok(()) };
            let Some(lane) = net.lane(ask(&self.get.lane)?.extract::<&str>()?) else { continue };
            let placement = Placement {
                lane,
                position: ask(&self.get.lane_position)?.extract()?,
                route,
                route_position: usize::try_from(ask(&self.get.route_index)?.extract::<i64>()?).unwrap_or(0),
                lateral_speed: ask(&self.get.lateral_speed)?.extract()?,
            };
            run.place(row, &placement);
        }
        Ok(())
    }
}

impl Domain {
    /// Who came into the scene and who left it since the last step.
    fn update(
        &mut self,
        py: Python,
        run: &mut Run,
        jumped: bool,
        mut profile: impl FnMut(&mut Run, &str) -> PyResult<closecall::frame::ProfileIndex>,
    ) -> PyResult<()> {
        if jumped {
            let now = self.ids.bind(py).call0()?;
            let gone = (0..self.live.len())
                .filter(|&place| !now.contains(&self.live[place].id).unwrap_or(false))
                .collect::<Vec<_>>();
            for place in gone.into_iter().rev() {
                self.remove(py, run, place);
            }
            for id in now.try_iter()? {
                self.add(py, run, id?.cast_into()?, &mut profile)?;
            }
            return Ok(());
        }
        for id in self.arrived.bind(py).call0()?.try_iter()? {
            if let Some(&place) = self.places.get(id?.extract::<&str>()?) {
                self.remove(py, run, place);
            }
        }
        for id in self.departed.bind(py).call0()?.try_iter()? {
            self.add(py, run, id?.cast_into()?, &mut profile)?;
        }
        Ok(())
    }

    fn add(
        &mut self,
        py: Python,
        run: &mut Run,
        id: Bound<PyString>,
        profile: &mut impl FnMut(&mut Run, &str) -> PyResult<closecall::frame::ProfileIndex>,
    ) -> PyResult<()> {
        let name: String = id.extract()?;
        if self.places.contains_key(&name) {
            return Ok(());
        }
        let arguments = PyTuple::new(py, [&id])?;
        let Ok(type_id) = self.type_id.bind(py).call1(&arguments) else {
            // It departed and arrived within the step.
            return Ok(());
        };
        let profile = profile(run, type_id.extract::<&str>()?)?;
        let user = run.enter(&name, profile);
        self.places.insert(name, self.live.len());
        let (id, arguments) = (id.unbind(), arguments.unbind());
        self.live.push(Live { id, arguments, user, parked: false, route: None });
        Ok(())
    }

    fn remove(&mut self, py: Python, run: &mut Run, place: usize) {
        let gone = self.live.swap_remove(place);
        run.leave(gone.user);
        self.places.remove(&gone.id.bind(py).to_string());
        if let Some(moved) = self.live.get(place) {
            self.places.insert(moved.id.bind(py).to_string(), place);
        }
    }

    /// Everybody's state into the run's frame.
    fn read(&mut self, py: Python, run: &mut Run, with_heights: bool) -> PyResult<()> {
        self.rows.clear();
        self.first_row = run.frame.len() as u32;
        let (position, angle, speed) = (self.position.bind(py), self.angle.bind(py), self.speed.bind(py));
        for (place, live) in (0..).zip(&self.live) {
            if live.parked {
                continue;
            }
            let arguments = live.arguments.bind(py);
            if let Some(inside) = &self.inside
                && !inside.bind(py).call1(arguments)?.extract::<&str>()?.is_empty()
            {
                continue;
            }
            let point = position.call1(arguments)?.cast_into::<PyTuple>()?;
            let z = if with_heights { point.get_item(2)?.extract()? } else { 0.0 };
            let state = State {
                x: point.get_item(0)?.extract()?,
                y: point.get_item(1)?.extract()?,
                z,
                heading: sumo::heading(angle.call1(arguments)?.extract()?),
                speed: speed.call1(arguments)?.extract()?,
            };
            if run.frame.push(live.user, state) {
                self.rows.push(place);
            }
        }
        Ok(())
    }
}
