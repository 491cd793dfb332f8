//! Python's `Alarm`, and the functions of a script that are called while a simulation runs.

use closecall::internals::output::{Context, LoggedConflict};
use closecall::{Run, UserIndex};
use pyo3::prelude::*;

use crate::conflict::Conflict;

/// A conflict that is open now, as it was in the last step that met the log's condition.
///
/// Args:
///     time: that step, in s.
///     ttb: time to brake: how long full braking may wait if the foe goes on as now, in s; None if the two would not touch.
///     response_left: the same if the foe brakes fully now, in s; None if the ego stands.
///     probability: that the driver does not brake in time if the foe goes on as now.
///     x: the conflict point, in m.
///     y: the conflict point, in m.
#[pyclass(frozen, get_all, module = "closecall")]
pub struct Alarm {
    ego: String,
    foe: String,
    kind: &'static str,
    severity: &'static str,
    time: f64,
    margin: f64,
    ttb: Option<f64>,
    response_left: Option<f64>,
    probability: f64,
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
        Self {
            ego: id(alarm.ego),
            foe: id(alarm.foe),
            kind: alarm.kind.name(),
            severity: alarm.severity.name(),
            time: alarm.time,
            margin: alarm.margin,
            ttb: near.and_then(|near| near.ttb),
            response_left: near.and_then(|near| near.response_left),
            probability: near.map_or(0.0, |near| near.crash_probability),
            x: alarm.at.x,
            y: alarm.at.y,
        }
    }
}

/// The open conflicts, in the order of the ids.
pub fn active(run: &Run) -> Vec<Alarm> {
    let mut alarms = run.alarms().map(|alarm| Alarm::of(run, &alarm)).collect::<Vec<_>>();
    alarms.sort_by(|a, b| (&a.ego, &a.foe).cmp(&(&b.ego, &b.foe)));
    alarms
}

/// The functions that a script wants to be called, and what they have been told.
#[derive(Default)]
pub struct Listeners {
    on_conflict: Option<Py<PyAny>>,
    on_alarm: Option<Py<PyAny>>,
    /// The number of conflicts that `on_conflict` got.
    told: usize,
    /// The pairs whose conflict was open after the last step.
    open: Vec<[UserIndex; 2]>,
}

impl Listeners {
    pub fn new(on_conflict: Option<Py<PyAny>>, on_alarm: Option<Py<PyAny>>) -> Self {
        Self { on_conflict, on_alarm, ..Self::default() }
    }

    /// Tells the script what a step brought: the conflicts that opened, then those that closed.
    pub fn tell(&mut self, py: Python, run: &Run) -> PyResult<()> {
        if let Some(on_alarm) = &self.on_alarm {
            let pair = |alarm: &closecall::Alarm| [alarm.ego.min(alarm.foe), alarm.ego.max(alarm.foe)];
            let new = run.alarms().filter(|alarm| !self.open.contains(&pair(alarm))).collect::<Vec<_>>();
            self.open = run.alarms().map(|alarm| pair(&alarm)).collect();
            for alarm in &new {
                on_alarm.call1(py, (Alarm::of(run, alarm),))?;
            }
        }
        if let Some(on_conflict) = &self.on_conflict {
            let from = std::mem::replace(&mut self.told, run.closed().len());
            for (number, conflict) in (1..).zip(run.closed()).skip(from) {
                let context = Context { number, net: run.net(), roster: &run.roster };
                on_conflict.call1(py, (Conflict(LoggedConflict::new(conflict, context)),))?;
            }
        }
        Ok(())
    }
}
