//! Plain frames from Python: arrays of states, for trajectories that do not come from SUMO.

use closecall::{Options, Profile, ProfileIndex, Run, State, SumoType, UserIndex};
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
    steps: u64,
}

type StateColumn<'py> = PyArrayLike1<'py, f64, AllowTypeChange>;

impl Frames {
    pub fn new(options: &Options) -> Self {
        Self { options: options.clone(), live: FxHashMap::default(), steps: 0 }
    }

    /// Begins a step with the rows of `states`: a mapping of columns of equal length.
    pub fn pull(&mut self, run: &mut Run, time: f64, states: &Bound<PyAny>) -> PyResult<()> {
        let ids =
            states.get_item("id")?.try_iter()?.map(|id| Ok(id?.str()?.to_string())).collect::<PyResult<Vec<_>>>()?;
        let column = |name: &str| -> PyResult<StateColumn> {
            let Ok(column) = states.get_item(name) else {
                return Err(PyValueError::new_err(format!("there is no \"{name}\"")));
            };
            let column: StateColumn = column.extract()?;
            if column.as_array().len() == ids.len() {
                Ok(column)
            } else {
                let length = column.as_array().len();
                Err(PyValueError::new_err(format!("\"{name}\" has {length} values, \"id\" has {}", ids.len())))
            }
        };
        let optional = |name: &str| states.contains(name)?.then(|| column(name)).transpose();
        let [x, y, heading, speed] = [column("x")?, column("y")?, column("heading")?, column("speed")?];
        let [z, length, width, decel, mass] =
            [optional("z")?, optional("length")?, optional("width")?, optional("decel")?, optional("mass")?];
        if !time.is_finite() {
            return Err(PyValueError::new_err(format!("time is {time}")));
        }
        run.begin_step(time);
        self.steps += 1;
        let value = |column: &Option<StateColumn>, row: usize, default| {
            column.as_ref().map_or(default, |column| column.as_array()[row])
        };
        for (row, id) in ids.iter().enumerate() {
            let user = match self.live.get(id) {
                Some(&(_, step)) if step == self.steps => {
                    return Err(PyValueError::new_err(format!("\"{id}\" is there twice")));
                }
                Some(&(user, _)) => user,
                None => {
                    let car = SumoType::car("");
                    let decel = value(&decel, row, car.emergency_decel);
                    let sumo = SumoType {
                        length: value(&length, row, car.length),
                        width: value(&width, row, car.width),
                        mass: value(&mass, row, car.mass),
                        emergency_decel: decel,
                        decel,
                        ..car
                    };
                    let profile = self.profile(run, sumo)?;
                    run.enter(id, profile)
                }
            };
            self.live.insert(id.clone(), (user, self.steps));
            let state = State {
                x: x.as_array()[row],
                y: y.as_array()[row],
                z: value(&z, row, 0.0),
                heading: heading.as_array()[row],
                speed: speed.as_array()[row],
            };
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

    /// The profile that all road users with these dimensions share.
    fn profile(&self, run: &mut Run, sumo: SumoType) -> PyResult<ProfileIndex> {
        let SumoType { length, width, decel, mass, .. } = sumo;
        let name = format!("{length} m x {width} m, {decel} m/s², {mass} kg");
        run.roster.profile(Profile::vehicle(&SumoType { name, ..sumo }, &self.options)).map_err(exception)
    }
}
