//! Conflicts in sumo-gui. While a conflict lasts, a vehicle has the colour of its worst conflict's severity and a highlight
//! ring in the colour of the kind; afterwards its former colour is restored and the ring removed.

use std::collections::hash_map::Entry;

use closecall::{Alarm, Category, Kind, Roster, Run, Severity, UserIndex};
use pyo3::prelude::*;
use rustc_hash::FxHashMap;

/// Red, green, blue, alpha.
type Colour = (u8, u8, u8, u8);

fn colour_of(severity: Severity) -> Colour {
    match severity {
        Severity::Caution => (255, 225, 0, 255),
        Severity::Serious => (255, 140, 0, 255),
        Severity::Critical => (235, 0, 0, 255),
    }
}

fn ring_of(kind: Kind) -> Colour {
    match kind {
        Kind::RearEnd => (60, 120, 255, 255),
        Kind::Frontal => (230, 0, 230, 255),
        Kind::Side => (0, 205, 205, 255),
    }
}

/// The distance between a vehicle and its ring, in m.
const RING_MARGIN: f64 = 2.0;

/// The road users that are painted, and their former colours.
pub struct Painter {
    source: Py<PyAny>,
    painted: FxHashMap<UserIndex, Painted>,
}

struct Painted {
    id: String,
    domain: &'static str,
    former: Py<PyAny>,
    severity: Severity,
    kind: Kind,
}

impl Painter {
    pub fn new(source: &Bound<PyAny>) -> Self {
        Self { source: source.clone().unbind(), painted: FxHashMap::default() }
    }

    /// Paints the road users in conflict and restores those that no longer are.
    pub fn paint(&mut self, py: Python, run: &Run) -> PyResult<()> {
        let worst = worst_of_each(run.alarms());
        let over = self.painted.keys().filter(|user| !worst.contains_key(user)).copied().collect::<Vec<_>>();
        for user in over {
            self.restore(py, user)?;
        }
        let mut worst = worst.into_iter().collect::<Vec<_>>();
        worst.sort_unstable_by_key(|(user, _)| *user);
        for (user, (severity, kind)) in worst {
            self.show(py, &run.roster, user, severity, kind)?;
        }
        Ok(())
    }

    /// Restores all colours.
    pub fn clear(&mut self, py: Python) -> PyResult<()> {
        let all = self.painted.keys().copied().collect::<Vec<_>>();
        all.into_iter().try_for_each(|user| self.restore(py, user))
    }

    fn show(&mut self, py: Python, roster: &Roster, user: UserIndex, severity: Severity, kind: Kind) -> PyResult<()> {
        let profile = roster.profile_of(user);
        let name = match profile.category {
            Category::Vehicle => "vehicle",
            Category::Person => "person",
            Category::Obstacle => return Ok(()),
        };
        let id = roster.id(user).to_string();
        let domain = self.source.bind(py).getattr(name)?;
        let known = self.painted.get(&user).map(|painted| (painted.severity, painted.kind));
        if known == Some((severity, kind)) {
            return Ok(());
        }
        if known.is_none_or(|(_, known)| known != kind) && name == "vehicle" {
            self.remove_ring(py, &id)?;
            let size = profile.length / 2.0 + RING_MARGIN;
            domain.call_method1("highlight", (&id, ring_of(kind), size))?;
        }
        match self.painted.entry(user) {
            Entry::Occupied(mut known) => {
                known.get_mut().severity = severity;
                known.get_mut().kind = kind;
            }
            Entry::Vacant(entry) => {
                let former = domain.call_method1("getColor", (&id,))?.unbind();
                entry.insert(Painted { id: id.clone(), domain: name, former, severity, kind });
            }
        }
        domain.call_method1("setColor", (&id, colour_of(severity)))?;
        Ok(())
    }

    fn restore(&mut self, py: Python, user: UserIndex) -> PyResult<()> {
        let Some(painted) = self.painted.remove(&user) else { return Ok(()) };
        let domain = self.source.bind(py).getattr(painted.domain)?;
        // A vehicle that has left no longer has a colour, but the polygon of its ring stays.
        let is_present = domain.call_method0("getIDList")?.contains(&painted.id)?;
        if is_present {
            domain.call_method1("setColor", (&painted.id, painted.former))?;
        }
        if painted.domain == "vehicle" { self.remove_ring(py, &painted.id) } else { Ok(()) }
    }

    /// Removes the polygon `<vehicle>_hl0`, as which SUMO draws a ring.
    fn remove_ring(&self, py: Python, id: &str) -> PyResult<()> {
        let polygons = self.source.bind(py).getattr("polygon")?;
        let ring = format!("{id}_hl0");
        if polygons.call_method0("getIDList")?.contains(&ring)? {
            polygons.call_method1("remove", (ring,))?;
        }
        Ok(())
    }
}

/// The worst of each road user's conflicts; of equally severe ones, that of the first kind.
fn worst_of_each(alarms: impl Iterator<Item = Alarm>) -> FxHashMap<UserIndex, (Severity, Kind)> {
    let mut worst: FxHashMap<UserIndex, (Severity, Kind)> = FxHashMap::default();
    for Alarm { ego, foe, severity, kind } in alarms {
        for user in [ego, foe] {
            let known = worst.entry(user).or_insert((severity, kind));
            if severity > known.0 || (severity == known.0 && kind < known.1) {
                *known = (severity, kind);
            }
        }
    }
    worst
}
