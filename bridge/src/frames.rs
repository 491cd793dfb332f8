//! Plain frames from Python: arrays of states, for trajectories that do not come from SUMO.
//!
//! A frame is checked as a whole before the run takes any of it, so a refused frame changes nothing.

use closecall::util::limits::{self, Limit};
use closecall::{Category, Options, Point, Profile, ProfileIndex, State, SumoType, UserIndex};
use closecall_run::Run;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use crate::error::exception;
use crate::rows::{Rows, Sort};

/// The road users in the scene.
pub struct Frames {
    options: Options,
    /// Each road user by its id.
    live: FxHashMap<String, LiveUser>,
    /// The types of the persons in the first step, whose length is not known before the second.
    early_persons: Vec<ProfileIndex>,
    /// The number of this frame; those that are refused count.
    number: u64,
}

/// A road user in the scene.
struct LiveUser {
    user: UserIndex,
    /// The number of the last frame that it was in.
    frame: u64,
}

/// The road user of a row.
enum Entry {
    Known(UserIndex),
    New(Box<Profile>),
    Obstacle([Point; 4]),
}

impl Frames {
    pub fn new(options: &Options) -> Self {
        Self { options: options.clone(), live: FxHashMap::default(), early_persons: Vec::new(), number: 0 }
    }

    /// Begins a step with the rows of a frame.
    pub fn pull(&mut self, run: &mut Run, time: f64, rows: &Rows) -> PyResult<()> {
        limits::TIME.check("time", time).map_err(PyValueError::new_err)?;
        if let Some(last) = run.time().filter(|last| time <= *last) {
            return Err(PyValueError::new_err(format!("time is {time}, after {last}")));
        }
        let entries = self.entries(run, time, rows)?;
        run.begin_step(time);
        if let Some(length) = run.step_length() {
            self.early_persons.drain(..).for_each(|persons| run.roster.set_response(persons, length));
        }
        for ((id, entry), state) in rows.ids.iter().zip(entries).zip(&rows.states) {
            let user = match entry {
                Entry::Known(user) => user,
                Entry::New(profile) => {
                    let is_person = profile.category == Category::Person;
                    let profile = run.roster.profile(*profile).map_err(exception)?;
                    if is_person && run.step_length().is_none() {
                        self.early_persons.push(profile);
                    }
                    self.enter(id, run.enter(id, profile))
                }
                Entry::Obstacle(outline) => {
                    self.enter(id, run.enter_shape(id, "obstacle", &outline).map_err(exception)?)
                }
            };
            let stands = run.roster.profile_of(user).category == Category::Obstacle;
            run.frame.push(user, if stands { State { speed: 0.0, ..*state } } else { *state });
        }
        self.live.retain(|_, LiveUser { user, frame }| {
            let is_there = *frame == self.number;
            if !is_there {
                run.leave(*user);
            }
            is_there
        });
        Ok(())
    }

    fn enter(&mut self, id: &str, user: UserIndex) -> UserIndex {
        self.live.insert(id.to_owned(), LiveUser { user, frame: self.number });
        user
    }

    /// The road user of each row; the scene is not changed yet.
    fn entries(&mut self, run: &Run, time: f64, rows: &Rows) -> PyResult<Vec<Entry>> {
        self.number += 1;
        let mut new = FxHashSet::default();
        let step_length = run.step_length().or_else(|| Some(time - run.time()?));
        let mut entries = Vec::with_capacity(rows.ids.len());
        for (row, id) in rows.ids.iter().enumerate() {
            let (known, is_new_here) = match self.live.get_mut(&**id) {
                Some(known) => (Some(known.user), std::mem::replace(&mut known.frame, self.number) != self.number),
                None => (None, new.insert(&**id)),
            };
            if !is_new_here {
                return Err(PyValueError::new_err(format!("\"{id}\" is there twice")));
            }
            rows.states[row].check().map_err(|why| PyValueError::new_err(format!("\"{id}\": {why}")))?;
            entries.push(match known {
                Some(user) => Entry::Known(user),
                None => self.new_entry(rows, row, step_length)?,
            });
        }
        Ok(entries)
    }

    /// The road user of a row that enters the scene.
    fn new_entry(&self, rows: &Rows, row: usize, step_length: Option<f64>) -> PyResult<Entry> {
        let (id, sort) = (&rows.ids[row], rows.sorts[row]);
        let usual = match sort {
            Sort::Vehicle => SumoType::car(""),
            Sort::Bicycle => SumoType::of_class("", "bicycle"),
            Sort::Person => SumoType::of_class("", "pedestrian"),
            // An obstacle has no usual size.
            Sort::Obstacle => SumoType { length: f64::NAN, width: f64::NAN, ..SumoType::car("") },
        };
        let wrong = |why: String| PyValueError::new_err(format!("\"{id}\": {why}"));
        let size = |name: &str, column: Option<&Vec<f64>>, usual: f64, limit: &Limit| {
            let size = column.map_or(usual, |column| column[row]);
            let message = |why| match column {
                Some(_) => wrong(why),
                None => PyValueError::new_err(format!("\"{id}\" is an obstacle, which needs \"length\" and \"width\"")),
            };
            limit.check(name, size).map_err(message)
        };
        let length = size("length", rows.length.as_ref(), usual.length, &limits::LENGTH)?;
        // A wall may be wider than any vehicle.
        let widest = if let Sort::Obstacle = sort { &limits::LENGTH } else { &limits::WIDTH };
        let width = size("width", rows.width.as_ref(), usual.width, widest)?;
        if let Sort::Obstacle = sort {
            let outline = outline(&rows.states[row], length, width);
            for (name, value) in
                outline.iter().flat_map(|corner| [("x of a corner", corner.x), ("y of a corner", corner.y)])
            {
                limits::POSITION.check(name, value).map_err(wrong)?;
            }
            return Ok(Entry::Obstacle(outline));
        }
        let value = |column: &Option<Vec<f64>>, usual: f64| column.as_ref().map_or(usual, |column| column[row]);
        let decel = value(&rows.decel, usual.emergency_decel);
        let mass = value(&rows.mass, usual.mass);
        let what = if let Sort::Person = sort { "person " } else { "" };
        let name = format!("{what}{length} m x {width} m, {decel} m/s², {mass} kg");
        // How a script's road users follow is not known.
        let tau = f64::INFINITY;
        let sumo = SumoType { name, length, width, mass, emergency_decel: decel, decel, tau, ..usual };
        let profile = if let Sort::Person = sort {
            Profile::person(&sumo, &self.options, step_length.unwrap_or_default())
        } else {
            Profile::vehicle(&sumo, &self.options)
        };
        profile.check().map_err(|error| wrong(error.to_string()))?;
        Ok(Entry::New(Box::new(profile)))
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
