//! From traci, over its socket: a few messages a step, which ask only for what changes.

use std::ops::Range;

use closecall::util::units::Second;
use closecall::{Options, Placement, ProfileIndex, State, UserIndex};
use closecall_run::Run;
use pyo3::intern;
use pyo3::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use super::reading::Domain;
use super::simulation::{self, TypeProfiles};
use super::wire::{Answers, Of, Requests, Variable};

/// A traci module or connection and the road users in the scene.
pub struct Traci {
    source: Py<PyAny>,
    vehicles: TraciDomain,
    persons: TraciDomain,
    /// The rows of the vehicles in the frame.
    rows: Range<u32>,
    types: TypeProfiles,
    step_length: Second,
    /// Whether the lists of a step do not name all that departed or parked since the last one.
    looks_up_all: bool,
    /// The traffic lights of the run's net that the simulation has; none before the first step.
    known_lights: Option<Vec<(u32, String)>>,
}

/// The bit of traci's stop state for a vehicle parked off the road.
const PARKED: i32 = 2;

/// The vehicles or the persons in the scene.
struct TraciDomain {
    domain: Domain,
    of: Of,
    live: FxHashMap<Box<str>, LiveUser>,
}

/// A road user in the scene.
struct LiveUser {
    user: UserIndex,
    seen: bool,
    is_parked: bool,
    /// The id of the route that its path follows.
    route: Option<Box<str>>,
}

/// SUMO's lists of the last step.
struct Lists<'a> {
    departed: FxHashSet<&'a str>,
    parking: FxHashSet<&'a str>,
    /// Whether they do not name all that departed or parked since the last frame.
    jumped: bool,
    /// The time of the last frame.
    last: Option<Second>,
}

impl Traci {
    pub fn new(source: &Bound<PyAny>, options: &Options) -> PyResult<Self> {
        let domain = |domain, of| TraciDomain { domain, of, live: FxHashMap::default() };
        Ok(Self {
            vehicles: domain(Domain::Vehicle, Of::Vehicle),
            persons: domain(Domain::Person, Of::Person),
            rows: 0..0,
            types: TypeProfiles::new(source, options)?,
            step_length: source.getattr("simulation")?.call_method0("getDeltaT")?.extract()?,
            looks_up_all: false,
            known_lights: None,
            source: source.clone().unbind(),
        })
    }

    pub fn look_up_all(&mut self) {
        self.looks_up_all = true;
    }

    pub fn time(&self, py: Python) -> PyResult<Second> {
        let simulation = self.source.bind(py).getattr(intern!(py, "simulation"))?;
        let time = simulation.call_method0(intern!(py, "getTime"))?.extract()?;
        Ok(simulation::time_of_states(time, self.step_length))
    }

    pub fn pull(&mut self, py: Python, run: &mut Run, time: Second) -> PyResult<()> {
        let source = self.source.bind(py);
        let last = run.time();
        let jumped = self.looks_up_all || last.is_none_or(|last| time - last > 1.5 * self.step_length);
        run.begin_step(time);
        let lights = match &mut self.known_lights {
            Some(known) => known,
            unknown => {
                let ids = source.getattr("trafficlight")?.call_method0("getIDList")?;
                let known = simulation::lights(run, &ids)?.into_iter();
                unknown.insert(known.map(|(number, id)| (number, id.to_string())).collect())
            }
        };
        let mut requests = Requests::default();
        use Variable::{Collisions, Departed, DepartedPersons, ParkingEnding, ParkingStarting};
        for variable in [Collisions, ParkingStarting, ParkingEnding, Departed, DepartedPersons] {
            requests.ask(Of::Simulation, variable, "");
        }
        for of in [Of::Vehicle, Of::Person] {
            requests.ask(of, Variable::Ids, "");
        }
        for (_, id) in &*lights {
            requests.ask(Of::Light, Variable::LightState, id);
        }
        let message = requests.send(source)?;
        let mut answers = Answers::of(&message);
        run.set_collisions_of_sumo(answers.collisions()?);
        let [starting, ending] = [answers.texts()?, answers.texts()?];
        self.vehicles.park(&starting, true);
        self.vehicles.park(&ending, false);
        let parking = starting.into_iter().filter(|id| !ending.contains(id)).collect();
        let of_vehicles = Lists { departed: answers.texts()?.into_iter().collect(), parking, jumped, last };
        let departed = answers.texts()?.into_iter().collect();
        let of_persons = Lists { departed, parking: FxHashSet::default(), jumped, last };
        let [vehicles, persons] = [answers.texts()?, answers.texts()?];
        for (number, _) in lights {
            if let Some(shown) = answers.text()? {
                run.set_signal(*number, shown);
            }
        }
        let types = &mut self.types;
        let first = run.frame.len() as u32;
        self.vehicles.read(source, run, &vehicles, &of_vehicles, |run, name| types.vehicle(py, run, name))?;
        self.rows = first..run.frame.len() as u32;
        self.persons.read(source, run, &persons, &of_persons, |run, name| types.person(py, run, name))?;
        read_details(source, run)
    }

    pub fn place(&mut self, py: Python, run: &mut Run, rows: &[u32]) -> PyResult<()> {
        let source = self.source.bind(py);
        let rows = rows.iter().copied().filter(|row| self.rows.contains(row)).collect::<Vec<_>>();
        let id = |run: &Run, row| run.roster.id(run.frame.user(row)).clone();
        let mut requests = Requests::default();
        for &row in &rows {
            requests.ask(Of::Vehicle, Variable::RouteId, &id(run, row));
        }
        let of_routes = requests.send(source)?;
        let mut answers = Answers::of(&of_routes);
        let mut moved = Vec::new();
        let mut requests = Requests::default();
        for row in rows {
            let id = id(run, row);
            let Some(route) = answers.text()? else { continue };
            let has_changed = self.vehicles.live.get(&*id).is_some_and(|live| live.route.as_deref() != Some(route));
            if !has_changed && run.keeps_path(row) {
                continue;
            }
            use Variable::{Lane, LanePosition, LateralSpeed, RouteIndex};
            for variable in [Lane, RouteIndex, LanePosition, LateralSpeed] {
                requests.ask(Of::Vehicle, variable, &id);
            }
            if has_changed {
                requests.ask(Of::Vehicle, Variable::Edges, &id);
            }
            moved.push((row, has_changed.then_some(route)));
        }
        let of_places = requests.send(source)?;
        let mut answers = Answers::of(&of_places);
        for (row, new_route) in moved {
            let id = id(run, row);
            let (lane, index) = (answers.text()?, answers.integer()?);
            let (position, lateral_speed) = (answers.number()?, answers.number()?);
            let edges = new_route.map(|_| answers.texts()).transpose()?;
            let (Some(net), Some(lane), Some(index)) = (run.net(), lane, index) else { continue };
            let (Some(position), Some(lateral_speed)) = (position, lateral_speed) else { continue };
            let Some(lane) = net.lane(lane) else { continue };
            let route_position = usize::try_from(index).unwrap_or(0);
            let route = match edges {
                Some(edges) => Some(simulation::route(net, edges)),
                None if run.knows_route(run.frame.user(row), route_position) => None,
                None => {
                    let mut request = Requests::default();
                    request.ask(Of::Vehicle, Variable::Edges, &id);
                    Some(simulation::route(net, Answers::of(&request.send(source)?).texts()?))
                }
            };
            if let (Some(new), Some(live)) = (new_route, self.vehicles.live.get_mut(&*id)) {
                live.route = Some(new.into());
            }
            run.set_placement(row, &Placement { lane, position, route, route_position, lateral_speed });
            if let Some(lanes) = run.changed_lanes(row) {
                let vehicles = source.getattr(intern!(py, "vehicle"))?;
                let states = vehicles.call_method1(intern!(py, "getLaneChangeState"), (&*id, lanes.signum()))?;
                run.set_lane_change_state(row, simulation::lane_change_state(&states)?);
            }
        }
        Ok(())
    }
}

impl TraciDomain {
    /// Notes that these vehicles park or no longer do.
    fn park(&mut self, ids: &[&str], parks: bool) {
        for id in ids {
            if let Some(live) = self.live.get_mut(*id) {
                live.is_parked = parks;
            }
        }
    }

    /// Reads the states of those with these ids, which are all that there are.
    fn read(
        &mut self,
        source: &Bound<PyAny>,
        run: &mut Run,
        ids: &[&str],
        lists: &Lists,
        mut profile: impl FnMut(&mut Run, &str) -> PyResult<ProfileIndex>,
    ) -> PyResult<()> {
        let is_vehicle = self.domain == Domain::Vehicle;
        let asks_since = is_vehicle && lists.jumped;
        let known = |live: &FxHashMap<Box<str>, LiveUser>, id: &str| {
            let may_be_another = lists.jumped || lists.departed.contains(id);
            live.get(id).filter(|_| !may_be_another).map(|live| live.is_parked)
        };
        let mut requests = Requests::default();
        for id in ids {
            let known = known(&self.live, id);
            if known.is_none() {
                requests.ask(self.of, Variable::Type, id);
                if asks_since {
                    requests.ask(self.of, Variable::Departure, id);
                    requests.ask(self.of, Variable::StopState, id);
                }
            }
            if known != Some(true) {
                for variable in [Variable::Position3d, Variable::Angle, Variable::Speed] {
                    requests.ask(self.of, variable, id);
                }
                if !is_vehicle {
                    requests.ask(self.of, Variable::Vehicle, id);
                }
            }
        }
        let message = requests.send(source)?;
        let mut answers = Answers::of(&message);
        for live in self.live.values_mut() {
            live.seen = false;
        }
        for id in ids {
            let known = known(&self.live, id);
            let (mut type_id, mut departure, mut stop_state) = (None, None, None);
            if known.is_none() {
                type_id = answers.text()?;
                if asks_since {
                    (departure, stop_state) = (answers.number()?, answers.integer()?);
                }
            }
            let state = if known == Some(true) { None } else { self.state(&mut answers)? };
            if let Some(type_id) = type_id {
                let is_another = match departure {
                    Some(departure) => lists.last.is_some_and(|last| departure > last),
                    None => lists.departed.contains(id),
                };
                if is_another || !self.live.contains_key(*id) {
                    let profile = profile(run, type_id)?;
                    let is_parked = lists.parking.contains(id);
                    let live = LiveUser { user: run.enter(id, profile), seen: false, is_parked, route: None };
                    let gone = self.live.insert((*id).into(), live);
                    gone.into_iter().for_each(|gone| run.leave(gone.user));
                }
            }
            let Some(live) = self.live.get_mut(*id) else { continue };
            live.seen = true;
            live.is_parked = stop_state.map_or(live.is_parked, |state| state & PARKED != 0);
            if let Some(state) = state.filter(|_| !live.is_parked) {
                run.frame.push(live.user, state);
            }
        }
        self.live.retain(|_, live| {
            if !live.seen {
                run.leave(live.user);
            }
            live.seen
        });
        Ok(())
    }

    /// The next road user's state; none of a person in a vehicle.
    fn state(&self, answers: &mut Answers) -> PyResult<Option<State>> {
        let (point, angle, speed) = (answers.point()?, answers.number()?, answers.number()?);
        let is_inside = self.domain == Domain::Person && answers.text()?.is_some_and(|vehicle| !vehicle.is_empty());
        let (false, Some([x, y, z]), Some(angle), Some(speed)) = (is_inside, point, angle, speed) else {
            return Ok(None);
        };
        Ok(Some(State { x, y, z, heading: simulation::heading(angle), speed }))
    }
}

/// Reads which vehicles in conflict stand because of a stop, and on which edges the persons in conflict are.
fn read_details(source: &Bound<PyAny>, run: &mut Run) -> PyResult<()> {
    let (standing, persons) = (run.standing(), run.persons_in_conflict());
    let mut requests = Requests::default();
    for user in &standing {
        requests.ask(Of::Vehicle, Variable::StopState, run.roster.id(*user));
    }
    for person in &persons {
        requests.ask(Of::Person, Variable::Road, run.roster.id(*person));
    }
    let message = requests.send(source)?;
    let mut answers = Answers::of(&message);
    for user in standing {
        if answers.integer()?.is_some_and(simulation::stops) {
            run.set_stopped(user);
        }
    }
    for person in persons {
        if let Some(edge) = answers.text()? {
            run.set_edge(person, edge);
        }
    }
    Ok(())
}
