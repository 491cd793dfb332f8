//! Plain frames from Python: arrays of states, for trajectories that do not come from SUMO.

use closecall::internals::util::limits;
use closecall::{Category, Options, Point, Profile, ProfileIndex, Run, State, SumoType, UserIndex};
use numpy::{AllowTypeChange, PyArrayLike1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rustc_hash::FxHashMap;

use crate::error::exception;

/// Reads frames and remembers the road users in the scene.
pub struct Frames {
    options: Options,
    /// Each road user by its id, and the last step that it was in.
    live: FxHashMap<String, (UserIndex, u64)>,
    /// The types of the persons in the first step, whose length is not known before the second.
    early_persons: Vec<ProfileIndex>,
    steps: u64,
}

/// The columns of a frame.
const COLUMNS: [&str; 11] = ["id", "x", "y", "heading", "speed", "z", "length", "width", "decel", "mass", "category"];

/// What a road user is, as the column `category` says.
#[derive(Clone, Copy)]
enum Sort {
    Vehicle,
    Bicycle,
    Person,
    Obstacle,
}

const SORTS: [(&str, Sort); 4] =
    [("vehicle", Sort::Vehicle), ("bicycle", Sort::Bicycle), ("person", Sort::Person), ("obstacle", Sort::Obstacle)];

type StateColumn<'py> = PyArrayLike1<'py, f64, AllowTypeChange>;

/// The optional columns, none where the frame lacks them.
struct Optional<'py> {
    length: Option<StateColumn<'py>>,
    width: Option<StateColumn<'py>>,
    decel: Option<StateColumn<'py>>,
    mass: Option<StateColumn<'py>>,
}

fn value(column: Option<&StateColumn>, row: usize) -> Option<f64> {
    column.map(|column| column.as_array()[row])
}

impl Frames {
    pub fn new(options: &Options) -> Self {
        Self { options: options.clone(), live: FxHashMap::default(), early_persons: Vec::new(), steps: 0 }
    }

    /// Begins a step with the rows of `states`: a mapping of columns of equal length.
    pub fn pull(&mut self, run: &mut Run, time: f64, states: &Bound<PyAny>) -> PyResult<()> {
        check_names(states)?;
        let ids = texts(states, "id")?;
        let check = |name: &str, length: usize| {
            let message = || format!("\"{name}\" has {length} values, \"id\" has {}", ids.len());
            if length == ids.len() { Ok(()) } else { Err(PyValueError::new_err(message())) }
        };
        let column = |name: &str| -> PyResult<StateColumn> {
            let Ok(column) = states.get_item(name) else {
                return Err(PyValueError::new_err(format!("there is no \"{name}\"")));
            };
            let column: StateColumn = column.extract()?;
            check(name, column.as_array().len())?;
            Ok(column)
        };
        let optional = |name: &str| states.contains(name)?.then(|| column(name)).transpose();
        let [x, y, heading, speed] = [column("x")?, column("y")?, column("heading")?, column("speed")?];
        let z = optional("z")?;
        let others = Optional {
            length: optional("length")?,
            width: optional("width")?,
            decel: optional("decel")?,
            mass: optional("mass")?,
        };
        let sorts = if states.contains("category")? { sorts(states)? } else { vec![Sort::Vehicle; ids.len()] };
        check("category", sorts.len())?;
        limits::TIME.check("time", time).map_err(PyValueError::new_err)?;
        run.begin_step(time);
        self.steps += 1;
        if let Some(length) = run.step_length() {
            self.early_persons.drain(..).for_each(|persons| run.roster.set_response(persons, length));
        }
        for (row, id) in ids.iter().enumerate() {
            let mut state = State {
                x: x.as_array()[row],
                y: y.as_array()[row],
                z: value(z.as_ref(), row).unwrap_or_default(),
                heading: heading.as_array()[row],
                speed: speed.as_array()[row],
            };
            let user = match self.live.get(id) {
                Some(&(_, step)) if step == self.steps => {
                    return Err(PyValueError::new_err(format!("\"{id}\" is there twice")));
                }
                Some(&(user, _)) => user,
                None => self.enter(run, id, sorts[row], &state, &others, row)?,
            };
            self.live.insert(id.clone(), (user, self.steps));
            if run.roster.profile_of(user).category == Category::Obstacle {
                state.speed = 0.0;
            }
            run.frame.push(user, state);
        }
        let steps = self.steps;
        self.live.retain(|_, (user, seen)| {
            if *seen != steps {
                run.leave(*user);
            }
            *seen == steps
        });
        Ok(())
    }

    /// The road user of a row enters the scene.
    fn enter(
        &mut self,
        run: &mut Run,
        id: &str,
        sort: Sort,
        state: &State,
        columns: &Optional,
        row: usize,
    ) -> PyResult<UserIndex> {
        let usual = match sort {
            Sort::Vehicle => SumoType::car(""),
            Sort::Bicycle => SumoType::of_class("", "bicycle"),
            Sort::Person => SumoType::of_class("", "pedestrian"),
            // An obstacle has no usual size.
            Sort::Obstacle => SumoType { length: f64::NAN, width: f64::NAN, ..SumoType::car("") },
        };
        let size = |name: &str, column: Option<&StateColumn>, usual: f64, limit: &limits::Limit| {
            let size = value(column, row).unwrap_or(usual);
            let message = |why| match column {
                Some(_) => format!("\"{id}\": {why}"),
                None => format!("\"{id}\" is an obstacle, which needs \"length\" and \"width\""),
            };
            limit.check(name, size).map_err(|why| PyValueError::new_err(message(why)))
        };
        let length = size("length", columns.length.as_ref(), usual.length, &limits::LENGTH)?;
        // A wall may be wider than any vehicle.
        let widest = if let Sort::Obstacle = sort { &limits::LENGTH } else { &limits::WIDTH };
        let width = size("width", columns.width.as_ref(), usual.width, widest)?;
        if let Sort::Obstacle = sort {
            return run.enter_shape(id, "obstacle", &outline(state, length, width)).map_err(exception);
        }
        let decel = value(columns.decel.as_ref(), row).unwrap_or(usual.emergency_decel);
        let mass = value(columns.mass.as_ref(), row).unwrap_or(usual.mass);
        let what = if let Sort::Person = sort { "person " } else { "" };
        let name = format!("{what}{length} m x {width} m, {decel} m/s², {mass} kg");
        // How a script's road users follow is not known.
        let tau = f64::INFINITY;
        let sumo = SumoType { name, length, width, mass, emergency_decel: decel, decel, tau, ..usual };
        let profile = if let Sort::Person = sort {
            let profile = Profile::person(&sumo, &self.options, run.step_length().unwrap_or_default());
            let profile = run.roster.profile(profile).map_err(exception)?;
            if run.step_length().is_none() {
                self.early_persons.push(profile);
            }
            profile
        } else {
            run.roster.profile(Profile::vehicle(&sumo, &self.options)).map_err(exception)?
        };
        Ok(run.enter(id, profile))
    }
}

/// The corners of a rectangle whose front's centre and heading are those of the state.
fn outline(state: &State, length: f64, width: f64) -> [Point; 4] {
    let (sine, cosine) = state.heading.sin_cos();
    let corner = |behind: f64, left: f64| {
        Point::new(state.x - behind * cosine - left * sine, state.y - behind * sine + left * cosine)
    };
    let half = width / 2.0;
    [corner(0.0, half), corner(length, half), corner(length, -half), corner(0.0, -half)]
}

/// The values of a column as texts.
fn texts(states: &Bound<PyAny>, name: &str) -> PyResult<Vec<String>> {
    let Ok(column) = states.get_item(name) else {
        return Err(PyValueError::new_err(format!("there is no \"{name}\"")));
    };
    column.try_iter()?.map(|text| Ok(text?.str()?.to_string())).collect()
}

fn sorts(states: &Bound<PyAny>) -> PyResult<Vec<Sort>> {
    let sort = |text: &String| {
        let known = SORTS.iter().find(|(name, _)| name == text).map(|(_, sort)| *sort);
        let message = || format!("category is \"{text}\": vehicle, bicycle, person or obstacle");
        known.ok_or_else(|| PyValueError::new_err(message()))
    };
    texts(states, "category")?.iter().map(sort).collect()
}

/// Refuses a column that is not known: its name is most likely misspelt.
fn check_names(states: &Bound<PyAny>) -> PyResult<()> {
    // A table of Polars has no keys, an array of NumPy's structures neither.
    let names = match (states.call_method0("keys"), states.getattr("columns")) {
        (Ok(names), _) | (_, Ok(names)) => names,
        _ => return Ok(()),
    };
    for name in names.try_iter()? {
        let name = name?.str()?.to_string();
        if !COLUMNS.contains(&name.as_str()) {
            let alike = |known: &&str| strsim::jaro_winkler(known, &name);
            let nearest = COLUMNS.iter().max_by(|a, b| alike(a).total_cmp(&alike(b)));
            let message = format!("there is no column \"{name}\"; did you mean \"{}\"?", nearest.unwrap_or(&"id"));
            return Err(PyValueError::new_err(message));
        }
    }
    Ok(())
}
