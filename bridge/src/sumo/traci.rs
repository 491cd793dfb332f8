//! From traci, over its socket: everything by subscription, because each single request costs a round trip.
//!
//! The names of its functions are interned: Python's attribute cache keeps every name that is looked up in every step.

use closecall::util::units::Second;
use closecall::{Options, Placement, ProfileIndex, State, UserIndex};
use closecall_run::Run;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyTuple};
use rustc_hash::FxHashMap;

use super::simulation::{self, TypeProfiles};

/// A traci connection and the road users in the scene.
pub struct Traci {
    source: Py<PyAny>,
    vehicles: TraciDomain,
    persons: TraciDomain,
    types: TypeProfiles,
    step_length: Second,
    variable: Variables,
    /// traci's traffic lights.
    lights: Py<PyAny>,
    /// Those that the run's net has too; none before the first step.
    known_lights: Option<Vec<(u32, Py<PyString>)>>,
}

/// traci's numbers of the variables that are subscribed to.
struct Variables {
    position: i32,
    angle: i32,
    speed: i32,
    lane: i32,
    lane_position: i32,
    lateral_speed: i32,
    route_id: i32,
    route_index: i32,
    stop_state: i32,
    vehicle: i32,
    light: i32,
}

/// The bit of traci's stop state for a vehicle parked off the road.
const PARKED: i32 = 2;

/// Vehicles or persons.
struct TraciDomain {
    domain: Py<PyAny>,
    variables: Vec<i32>,
    live: FxHashMap<String, SubscribedUser>,
    /// The ids of the road users in the rows of the frame, from `first_row` on.
    rows: Vec<String>,
    first_row: u32,
}

/// A road user in the scene.
struct SubscribedUser {
    user: UserIndex,
    seen: bool,
    route: Option<String>,
    latest: Option<Py<PyDict>>,
}

impl Traci {
    pub fn new(source: &Bound<PyAny>, options: &Options) -> PyResult<Self> {
        let constants = source.py().import("traci.constants")?;
        let number = |name: &str| constants.getattr(name)?.extract::<i32>();
        let variable = Variables {
            position: number("VAR_POSITION3D")?,
            angle: number("VAR_ANGLE")?,
            speed: number("VAR_SPEED")?,
            lane: number("VAR_LANE_ID")?,
            lane_position: number("VAR_LANEPOSITION")?,
            lateral_speed: number("VAR_SPEED_LAT")?,
            route_id: number("VAR_ROUTE_ID")?,
            route_index: number("VAR_ROUTE_INDEX")?,
            stop_state: number("VAR_STOPSTATE")?,
            vehicle: number("VAR_VEHICLE")?,
            light: number("TL_RED_YELLOW_GREEN_STATE")?,
        };
        let Variables { position, angle, speed, lane, lane_position, .. } = variable;
        let Variables { lateral_speed, route_id, route_index, stop_state, vehicle, .. } = variable;
        let script = source.py().import("closecall._traci")?;
        let domain = |name: &str, variables: Vec<i32>| -> PyResult<TraciDomain> {
            let domain = source.getattr(name)?;
            script.call_method1("unsubscribe_at_removal", (&domain,))?;
            Ok(TraciDomain {
                domain: domain.unbind(),
                variables,
                live: FxHashMap::default(),
                rows: Vec::new(),
                first_row: 0,
            })
        };
        let of_vehicles =
            vec![position, angle, speed, lane, lane_position, lateral_speed, route_id, route_index, stop_state];
        Ok(Self {
            vehicles: domain("vehicle", of_vehicles)?,
            persons: domain("person", vec![position, angle, speed, vehicle])?,
            types: TypeProfiles::new(source, options)?,
            step_length: source.getattr("simulation")?.call_method0("getDeltaT")?.extract()?,
            lights: source.getattr("trafficlight")?.unbind(),
            known_lights: None,
            source: source.clone().unbind(),
            variable,
        })
    }

    pub fn time(&self, py: Python) -> PyResult<Second> {
        let simulation = self.source.bind(py).getattr(intern!(py, "simulation"))?;
        let time = simulation.call_method0(intern!(py, "getTime"))?.extract()?;
        Ok(simulation::time_of_states(time, self.step_length))
    }

    pub fn pull(&mut self, py: Python, run: &mut Run, time: Second) -> PyResult<()> {
        run.begin_step(time);
        let simulation = self.source.bind(py).getattr(intern!(py, "simulation"))?;
        run.set_collisions_of_sumo(simulation::collisions(&simulation.call_method0(intern!(py, "getCollisions"))?)?);
        self.read_lights(py, run)?;
        let types = &mut self.types;
        self.vehicles.read(py, run, &self.variable, |run, name| types.vehicle(py, run, name))?;
        let types = &mut self.types;
        self.persons.read(py, run, &self.variable, |run, name| types.person(py, run, name))?;
        let persons = self.persons.domain.bind(py);
        simulation::edges_of_persons(run, |id| persons.call_method1(intern!(py, "getRoadID"), (id,)))
    }

    /// Reads what the traffic lights show.
    fn read_lights(&mut self, py: Python, run: &mut Run) -> PyResult<()> {
        let lights = self.lights.bind(py);
        let light = self.variable.light;
        let known = match &mut self.known_lights {
            Some(known) => known,
            unknown => {
                let known = simulation::lights(run, &lights.call_method0("getIDList")?)?;
                for (_, id) in &known {
                    lights.call_method1("subscribe", (id, vec![light]))?;
                }
                unknown.insert(known)
            }
        };
        if known.is_empty() {
            return Ok(());
        }
        let results = lights.call_method0(intern!(py, "getAllSubscriptionResults"))?;
        for (number, id) in known {
            if let Ok(shown) = results.get_item(&*id) {
                run.set_signal(*number, shown.get_item(light)?.extract::<&str>()?);
            }
        }
        Ok(())
    }

    pub fn place(&mut self, py: Python, run: &mut Run, rows: &[u32]) -> PyResult<()> {
        let domain = self.vehicles.domain.bind(py).clone();
        for &row in rows {
            let Some(place) = row.checked_sub(self.vehicles.first_row) else { continue };
            let Some(id) = self.vehicles.rows.get(place as usize) else { continue };
            let Some(live) = self.vehicles.live.get_mut(id) else { continue };
            let (Some(net), Some(latest)) = (run.net(), &live.latest) else { continue };
            let latest = latest.bind(py);
            let value = |variable: i32| latest.as_any().get_item(variable);
            let Some(lane) = net.lane(value(self.variable.lane)?.extract::<&str>()?) else { continue };
            let route_id: String = value(self.variable.route_id)?.extract()?;
            let position = usize::try_from(value(self.variable.route_index)?.extract::<i64>()?).unwrap_or(0);
            let has_changed = live.route.as_ref() != Some(&route_id);
            let route = if has_changed || !run.knows_route(live.user, position) {
                Some(simulation::route(net, &domain.call_method1(intern!(py, "getRoute"), (id,))?)?)
            } else {
                None
            };
            live.route = Some(route_id);
            let placement = Placement {
                lane,
                position: value(self.variable.lane_position)?.extract()?,
                route,
                route_position: position,
                lateral_speed: value(self.variable.lateral_speed)?.extract()?,
            };
            run.set_placement(row, &placement);
            if let Some(lanes) = run.changed_lanes(row) {
                let states = domain.call_method1(intern!(py, "getLaneChangeState"), (id, lanes.signum()))?;
                run.set_lane_change_state(row, simulation::lane_change_state(&states)?);
            }
        }
        Ok(())
    }
}

impl TraciDomain {
    fn read(
        &mut self,
        py: Python,
        run: &mut Run,
        variable: &Variables,
        mut profile: impl FnMut(&mut Run, &str) -> PyResult<ProfileIndex>,
    ) -> PyResult<()> {
        let domain = self.domain.bind(py);
        for live in self.live.values_mut() {
            live.seen = false;
        }
        self.rows.clear();
        self.first_row = run.frame.len() as u32;
        let ids = domain.call_method0(intern!(py, "getIDList"))?.cast_into::<PyTuple>()?;
        let subscribe =
            |id: &Bound<PyAny>| domain.call_method1(intern!(py, "subscribe"), (id, self.variables.clone())).map(drop);
        let mut enter =
            |live: &mut FxHashMap<String, SubscribedUser>, run: &mut Run, id: &Bound<PyAny>| -> PyResult<()> {
                let type_id = domain.call_method1(intern!(py, "getTypeID"), (id,))?;
                let profile = profile(run, type_id.extract::<&str>()?)?;
                let user = run.enter(id.extract::<&str>()?, profile);
                let gone = live.insert(id.extract()?, SubscribedUser { user, seen: false, route: None, latest: None });
                gone.into_iter().for_each(|gone| run.leave(gone.user));
                Ok(())
            };
        for id in ids.iter() {
            if !self.live.contains_key(id.extract::<&str>()?) {
                subscribe(&id)?;
                enter(&mut self.live, run, &id)?;
            }
        }
        let ask = || domain.call_method0(intern!(py, "getAllSubscriptionResults"));
        let mut results = ask()?;
        // If SUMO has ended the subscription of an id, its road user has left and another one has the id.
        let others = ids.iter().filter(|id| results.get_item(id).is_err()).collect::<Vec<_>>();
        if !others.is_empty() {
            others.iter().try_for_each(&subscribe)?;
            results = ask()?;
            let mut others = others.iter().filter(|id| results.get_item(id).is_ok());
            others.try_for_each(|id| enter(&mut self.live, run, id))?;
        }
        for id in ids.iter() {
            let id: Bound<PyString> = id.cast_into()?;
            let Some(live) = self.live.get_mut(id.extract::<&str>()?) else { continue };
            live.seen = true;
            let Ok(latest) = results.get_item(&id) else { continue };
            let latest = latest.cast_into::<PyDict>()?;
            let value = |variable: i32| latest.as_any().get_item(variable);
            let inside =
                self.variables.contains(&variable.vehicle) && !value(variable.vehicle)?.extract::<&str>()?.is_empty();
            let has_stops = self.variables.contains(&variable.stop_state);
            let stop_state: i32 = if has_stops { value(variable.stop_state)?.extract()? } else { 0 };
            if inside || stop_state & PARKED != 0 {
                continue;
            }
            let point = value(variable.position)?.cast_into::<PyTuple>()?;
            let state = State {
                x: point.get_item(0)?.extract()?,
                y: point.get_item(1)?.extract()?,
                z: point.get_item(2)?.extract()?,
                heading: simulation::heading(value(variable.angle)?.extract()?),
                speed: value(variable.speed)?.extract()?,
            };
            if run.frame.push(live.user, state) {
                self.rows.push(id.extract()?);
            }
            if simulation::stops(stop_state) {
                run.set_stopped(live.user);
            }
            live.latest = Some(latest.unbind());
        }
        self.live.retain(|_, live| {
            if !live.seen {
                run.leave(live.user);
            }
            live.seen
        });
        Ok(())
    }
}
