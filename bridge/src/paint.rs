//! Conflicts in sumo-gui: what is painted, step by step. How it looks is decided in Python, by `closecall._paint`.

use closecall::{Alarm, Category, Severity, UserIndex};
use closecall_run::Run;
use closecall_run::palette::{Ground, colour};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// The colours of the severities, mildest first, as `closecall._paint` takes them.
pub fn colours(py: Python) -> PyResult<Bound<PyDict>> {
    let colours = PyDict::new(py);
    for severity in Severity::ALL {
        let [red, green, blue] = colour(severity, Ground::Dark);
        colours.set_item(severity.name(), (red, green, blue))?;
    }
    Ok(colours)
}

/// Paints the open conflicts of a run.
pub struct Painter {
    module: Py<PyModule>,
    painter: Py<PyAny>,
}

impl Painter {
    /// A painter in the sumo-gui of libsumo or a traci connection. `label` writes beside each conflict what it is; in a
    /// view of closecall's own there is a legend, and it begins at the traffic.
    pub fn new(source: &Bound<PyAny>, label: bool, own_view: bool) -> PyResult<Self> {
        let py = source.py();
        let module = py.import("closecall._paint")?;
        let painter = module.call_method1("Painter", (source, colours(py)?, label, own_view))?;
        Ok(Self { module: module.unbind(), painter: painter.unbind() })
    }

    /// Paints the road users in conflict and restores those that no longer are; returns how severe the worst is. It halts
    /// at those that become as severe as `pause_at`.
    pub fn paint(&mut self, py: Python, run: &Run, pause_at: Option<Severity>) -> PyResult<Option<Severity>> {
        let module = self.module.bind(py);
        let pairs = PyList::empty(py);
        let mut worst = None;
        for alarm in run.alarms() {
            worst = worst.max(Some(alarm.severity));
            pairs.append(pair(module, run, &alarm)?)?;
        }
        let painter = self.painter.bind(py);
        painter.call_method1("paint", (&pairs,))?;
        if let Some(least) = pause_at {
            painter.call_method1("halt", (pairs, least.name()))?;
        }
        Ok(worst)
    }

    /// Removes all that was painted.
    pub fn clear(&mut self, py: Python) -> PyResult<()> {
        self.painter.bind(py).call_method0("clear").map(drop)
    }
}

fn pair<'py>(module: &Bound<'py, PyModule>, run: &Run, alarm: &Alarm) -> PyResult<Bound<'py, PyAny>> {
    let Alarm { ego, foe, severity, kind, at, nearness, .. } = *alarm;
    let left = nearness.and_then(|near| near.values.response_left());
    let (ego, foe) = (user(module, run, ego)?, user(module, run, foe)?);
    module.call_method1("Pair", (ego, foe, severity.name(), kind.name(), (at.x, at.y), left))
}

fn user<'py>(module: &Bound<'py, PyModule>, run: &Run, user: UserIndex) -> PyResult<Bound<'py, PyAny>> {
    let profile = run.roster.profile_of(user);
    let domain = match profile.category {
        Category::Vehicle => Some("vehicle"),
        Category::Person => Some("person"),
        Category::Obstacle => None,
    };
    let path = if domain.is_some() { run.path(user) } else { Vec::new() };
    let path = path.iter().map(|point| (point.x, point.y)).collect::<Vec<_>>();
    let id = run.roster.id(user).as_str();
    module.call_method1("User", (id, domain, profile.length, profile.width, profile.carriages > 1, path))
}
