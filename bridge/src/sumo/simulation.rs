//! Requests that are the same for libsumo and traci: options, types, polygons, routes.

use std::collections::HashSet;
use std::path::PathBuf;
use std::sync::Arc;

use closecall::util::units::Second;
use closecall::{EdgeIndex, Net, Options, Point, Profile, ProfileIndex, SumoType};
use closecall_run::Run;
use pyo3::exceptions::PyRuntimeError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyString;
use rustc_hash::FxHashMap;

use crate::error::{exception, message};

/// The value of a SUMO option; empty if it is not set. SUMO has no options before a simulation is started.
pub fn option(source: &Bound<PyAny>, name: &str) -> PyResult<String> {
    let simulation = source.getattr("simulation")?;
    let unknown = |error: PyErr| {
        let message = message(source.py(), &error);
        PyRuntimeError::new_err(format!("SUMO does not report its option {name}; is a simulation started? ({message})"))
    };
    simulation.call_method1("getOption", (name,)).map_err(unknown)?.extract()
}

/// Whether SUMO moves road users by the mean of two speeds, not by the later one.
pub fn is_ballistic(source: &Bound<PyAny>) -> PyResult<bool> {
    Ok(option(source, "step-method.ballistic")? == "true")
}

/// The net that the simulation runs on.
pub fn net_of(source: &Bound<PyAny>) -> PyResult<Option<Arc<Net>>> {
    let file = option(source, "net-file")?;
    if file.is_empty() {
        return Ok(None);
    }
    closecall_run::net::read(&PathBuf::from(file)).map(|net| Some(Arc::new(net))).map_err(exception)
}

/// Adds the polygons of the wanted types as static obstacles.
pub fn add_obstacles(source: &Bound<PyAny>, run: &mut Run, types: &[String]) -> PyResult<()> {
    if types.is_empty() {
        return Ok(());
    }
    let polygons = source.getattr("polygon")?;
    for id in polygons.call_method0("getIDList")?.try_iter()? {
        let id = id?;
        let polygon_type: String = polygons.call_method1("getType", (&id,))?.extract()?;
        if types.contains(&polygon_type) {
            let shape: Vec<(f64, f64)> = polygons.call_method1("getShape", (&id,))?.extract()?;
            let outline = shape.into_iter().map(|(x, y)| Point::new(x, y)).collect::<Vec<_>>();
            run.enter_obstacle(id.extract::<&str>()?, &polygon_type, &outline).map_err(exception)?;
        }
    }
    Ok(())
}

/// The state of a lane change from what `getLaneChangeState` returns: without what scripts asked for, and with it.
pub fn lane_change_state(states: &Bound<PyAny>) -> PyResult<i32> {
    states.get_item(1)?.extract()
}

/// The bit of SUMO's stop state for a vehicle that has reached a stop.
const STOPPED: i32 = 1;

/// Whether a vehicle of this stop state has reached a stop, on the road or off it.
pub fn stops(stop_state: i32) -> bool {
    stop_state & STOPPED != 0
}

/// The profiles of SUMO's types; each type is asked for once.
pub struct TypeProfiles {
    domain: Py<PyAny>,
    options: Options,
    step_length: Second,
    vehicles: FxHashMap<String, ProfileIndex>,
    persons: FxHashMap<String, ProfileIndex>,
}

impl TypeProfiles {
    pub fn new(source: &Bound<PyAny>, options: &Options) -> PyResult<Self> {
        Ok(Self {
            domain: source.getattr("vehicletype")?.unbind(),
            options: options.clone(),
            step_length: source.getattr("simulation")?.call_method0("getDeltaT")?.extract()?,
            vehicles: FxHashMap::default(),
            persons: FxHashMap::default(),
        })
    }

    /// A vehicle type's profile.
    pub fn vehicle(&mut self, py: Python, run: &mut Run, name: &str) -> PyResult<ProfileIndex> {
        if let Some(&known) = self.vehicles.get(name) {
            return Ok(known);
        }
        let profile = Profile::vehicle(&self.ask(py, name)?, &self.options);
        let index = run.roster.profile(profile).map_err(exception)?;
        self.vehicles.insert(name.to_owned(), index);
        Ok(index)
    }

    /// A person type's profile.
    pub fn person(&mut self, py: Python, run: &mut Run, name: &str) -> PyResult<ProfileIndex> {
        if let Some(&known) = self.persons.get(name) {
            return Ok(known);
        }
        let profile = Profile::person(&self.ask(py, name)?, &self.options, self.step_length);
        let index = run.roster.profile(profile).map_err(exception)?;
        self.persons.insert(name.to_owned(), index);
        Ok(index)
    }

    fn ask(&self, py: Python, name: &str) -> PyResult<SumoType> {
        let domain = self.domain.bind(py);
        let number = |getter: &str| domain.call_method1(getter, (name,))?.extract::<f64>();
        let vehicle_class = domain.call_method1("getVehicleClass", (name,))?.extract::<String>()?;
        // An older SUMO does not tell a type's mass.
        let mass =
            if domain.hasattr("getMass")? { number("getMass")? } else { SumoType::of_class(name, &vehicle_class).mass };
        Ok(SumoType {
            name: name.to_owned(),
            vehicle_class,
            shape: domain.call_method1("getShapeClass", (name,))?.extract()?,
            length: number("getLength")?,
            width: number("getWidth")?,
            mass,
            emergency_decel: number("getEmergencyDecel")?,
            decel: number("getDecel")?,
            tau: number("getTau")?,
            min_gap: number("getMinGap")?,
            action_step: number("getActionStepLength")?,
        })
    }
}

/// The traffic lights of the run's net that the simulation has, whose ids these are.
pub fn lights(run: &Run, ids: &Bound<PyAny>) -> PyResult<Vec<(u32, Py<PyString>)>> {
    let py = ids.py();
    let ids = ids.extract::<Vec<String>>()?.into_iter().collect::<HashSet<_>>();
    let of_net = run.net().map_or(&[][..], |net| &net.lights);
    let known = (0..).zip(of_net).filter(|(_, id)| ids.contains(*id));
    Ok(known.map(|(light, id)| (light, PyString::new(py, id).unbind())).collect())
}

/// States the edges of the persons in conflict, which `edge` asks for by id.
pub fn edges_of_persons<'py>(run: &mut Run, edge: impl Fn(&str) -> PyResult<Bound<'py, PyAny>>) -> PyResult<()> {
    for person in run.persons_in_conflict() {
        let id: &str = run.roster.id(person);
        let edge = edge(id)?;
        run.set_edge(person, edge.extract::<&str>()?);
    }
    Ok(())
}

/// The pairs of ids of the collisions that SUMO reports.
pub fn collisions(reported: &Bound<PyAny>) -> PyResult<Vec<[String; 2]>> {
    let py = reported.py();
    let mut pairs = Vec::new();
    for collision in reported.try_iter()? {
        let collision = collision?;
        let collider = collision.getattr(intern!(py, "collider"))?.extract::<String>()?;
        let victim = collision.getattr(intern!(py, "victim"))?.extract::<String>()?;
        pairs.push([collider, victim]);
    }
    Ok(pairs)
}

/// A route as the net's edges. It ends at an edge that the net does not have.
pub fn route(net: &Net, edges: impl IntoIterator<Item = impl AsRef<str>>) -> Arc<[EdgeIndex]> {
    edges.into_iter().map_while(|edge| net.edge(edge.as_ref())).collect()
}

/// The time of the current states in SUMO's own outputs: `getTime` is one step ahead of them.
pub fn time_of_states(time: Second, step_length: Second) -> Second {
    // SUMO counts whole milliseconds.
    ((time - step_length) * 1e3).round() / 1e3
}

/// SUMO's angle, in degrees clockwise from north, as a heading in rad counter-clockwise from +x.
pub fn heading(angle: f64) -> f64 {
    (90.0 - angle).to_radians()
}
