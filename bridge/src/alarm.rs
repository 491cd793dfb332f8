//! Python's `Alarm`, and the functions of a script that are called while a simulation runs.

use closecall::{PetSoFar, UserIndex};
use closecall_run::Run;
use closecall_run::output::schema::{Context, LoggedConflict};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

use crate::conflict::Conflict;

/// A conflict that is open or waits for its PET, as of the last step that met the log's condition. Its PET is the current one.
///
/// Args:
///     artefact: why it is none of traffic's, as in the log; None for the rest, and always unless `artefacts=True`.
///     time: that step, in s.
///     ttb: time to brake: how long full braking may wait if the foe goes on as now, in s; None if the two would not touch.
///     response_left: the same if the foe brakes fully now, in s; None if the ego stands.
///     probability: that the driver does not brake in time if the foe goes on as now.
///     pet: the PET, in s, once the second of both has entered the conflict area; None before.
///     pet_at_least: while it has not: how long ago the first left the area, in s; None before.
///     x: the conflict point, in m.
///     y: the conflict point, in m.
#[pyclass(frozen, get_all, module = "closecall")]
pub struct Alarm {
    ego: String,
    foe: String,
    kind: &'static str,
    severity: &'static str,
    artefact: Option<&'static str>,
    time: f64,
    margin: f64,
    ttb: Option<f64>,
    response_left: Option<f64>,
    probability: f64,
    pet: Option<f64>,
    pet_at_least: Option<f64>,
    x: f64,
    y: f64,
}

#[pymethods]
impl Alarm {
    fn __repr__(&self) -> String {
        let Self { ego, foe, kind, severity, time, margin, .. } = self;
        format!("Alarm(ego={ego:?}, foe={foe:?}, kind={kind}, severity={severity}, time={time}, margin={margin:.3})")
    }
}

impl Alarm {
    fn of(run: &Run, alarm: &closecall::Alarm) -> Self {
        let id = |user: UserIndex| run.roster.id(user).to_string();
        let near = alarm.nearness;
        let (pet, pet_at_least) = match run.pet_so_far(alarm) {
            Some(PetSoFar::Known(pet)) => (Some(pet), None),
            Some(PetSoFar::AtLeast(pet)) => (None, Some(pet)),
            None => (None, None),
        };
        Self {
            ego: id(alarm.ego),
            foe: id(alarm.foe),
            kind: alarm.kind.name(),
            severity: alarm.severity.name(),
            artefact: alarm.artefact.map(|artefact| artefact.name()),
            time: alarm.time,
            margin: alarm.margin,
            ttb: near.and_then(|near| near.values.ttb()),
            response_left: near.and_then(|near| near.values.response_left()),
            probability: near.and_then(|near| near.values.crash_probability()).unwrap_or(0.0),
            pet,
            pet_at_least,
            x: alarm.at.x,
            y: alarm.at.y,
        }
    }
}

/// The open conflicts, in the order of the ids.
pub fn active(run: &Run) -> Vec<Alarm> {
    sorted(run, run.alarms())
}

/// The conflicts that wait for their PET, in the order of the ids.
pub fn waiting(run: &Run) -> Vec<Alarm> {
    sorted(run, run.waiting())
}

fn sorted(run: &Run, alarms: impl Iterator<Item = closecall::Alarm>) -> Vec<Alarm> {
    let mut alarms = alarms.map(|alarm| Alarm::of(run, &alarm)).collect::<Vec<_>>();
    alarms.sort_by(|a, b| (&a.ego, &a.foe).cmp(&(&b.ego, &b.foe)));
    alarms
}

/// The functions that a script wants to be called, and what they have been told.
#[derive(Default)]
pub struct Listeners {
    on_conflict: Option<Py<PyAny>>,
    on_alarm: Option<Py<PyAny>>,
    /// How many closed conflicts stay in memory.
    keep: usize,
    /// The number of the last conflict that `on_conflict` got.
    told: u64,
    /// The pairs whose conflict was open after the last step.
    open: Vec<[UserIndex; 2]>,
}

impl Listeners {
    pub fn new(on_conflict: Option<Py<PyAny>>, on_alarm: Option<Py<PyAny>>, keep: usize) -> Self {
        Self { on_conflict, on_alarm, keep, ..Self::default() }
    }

    /// What a step brought, each with the function to call with it: the conflicts that opened, then those that closed.
    /// Conflicts that are not to be kept are dropped from the run.
    pub fn news(&mut self, py: Python, run: &mut Run) -> PyResult<Vec<(Py<PyAny>, Py<PyAny>)>> {
        let mut news = Vec::new();
        if let Some(on_alarm) = &self.on_alarm {
            let pair = |alarm: &closecall::Alarm| [alarm.ego.min(alarm.foe), alarm.ego.max(alarm.foe)];
            for alarm in run.alarms().filter(|alarm| !self.open.contains(&pair(alarm))) {
                news.push((on_alarm.clone_ref(py), Alarm::of(run, &alarm).into_py_any(py)?));
            }
            self.open = run.alarms().map(|alarm| pair(&alarm)).collect();
        }
        if let Some(on_conflict) = &self.on_conflict {
            let told = self.told;
            for (number, conflict) in (run.first_number()..).zip(run.closed()).skip_while(|(number, _)| *number <= told)
            {
                let context = Context { number, net: run.net(), roster: &run.roster };
                let conflict = Conflict(LoggedConflict::new(conflict, context));
                news.push((on_conflict.clone_ref(py), conflict.into_py_any(py)?));
                self.told = number;
            }
            run.forget_closed_conflicts(self.keep);
        }
        Ok(news)
    }
}
