//! Conflicts in sumo-gui. While a conflict lasts, a vehicle has the colour of its worst conflict's severity and a highlight
//! ring in the colour of the kind; afterwards its former colour is restored and the ring removed. The ring is around the
//! vehicle. An articulated vehicle is long and may bend: its ring is around the place of the conflict.

use std::collections::hash_map::Entry;

use closecall::{Alarm, Category, Kind, Point, Roster, Run, Severity, UserIndex};
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

/// The inner and the outer radius of the ring around a place, in m: those of the ring of a car.
const RADII: [f64; 2] = [4.5, 5.5];
/// The corners of each side of that ring, as many as SUMO gives its own.
const CORNERS: u32 = 34;
/// A layer of sumo-gui above those of all vehicles.
const ABOVE_VEHICLES: i32 = 1000;

/// The outline of a ring around a place: its outer side, and back along its inner one.
fn ring_around(place: Point) -> Vec<(f64, f64)> {
    let side = |radius: f64| {
        (0..=CORNERS).map(move |corner| {
            let angle = f64::from(corner) / f64::from(CORNERS) * std::f64::consts::TAU;
            (place.x + radius * angle.cos(), place.y + radius * angle.sin())
        })
    };
    let [inner, outer] = RADII;
    side(outer).chain(side(inner).rev()).collect()
}

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
        for (user, alarm) in worst {
            self.show(py, &run.roster, user, &alarm)?;
        }
        Ok(())
    }

    /// Restores all colours.
    pub fn clear(&mut self, py: Python) -> PyResult<()> {
        let all = self.painted.keys().copied().collect::<Vec<_>>();
        all.into_iter().try_for_each(|user| self.restore(py, user))
    }

    fn show(&mut self, py: Python, roster: &Roster, user: UserIndex, alarm: &Alarm) -> PyResult<()> {
        let Alarm { severity, kind, at, .. } = *alarm;
        let profile = roster.profile_of(user);
        let name = match profile.category {
            Category::Vehicle => "vehicle",
            Category::Person => "person",
            Category::Obstacle => return Ok(()),
        };
        let id = roster.id(user).to_string();
        let domain = self.source.bind(py).getattr(name)?;
        let known = self.painted.get(&user).map(|painted| (painted.severity, painted.kind));
        let is_new = known.is_none_or(|(_, known)| known != kind);
        if is_new && name == "vehicle" {
            self.remove_ring(py, &id)?;
        }
        if profile.carriages > 1 {
            self.move_ring(py, &id, kind, at, is_new)?;
        }
        if known == Some((severity, kind)) {
            return Ok(());
        }
        if is_new && name == "vehicle" && profile.carriages == 1 {
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

    /// Puts the ring of an articulated vehicle around the place of its conflict, which changes in each step.
    fn move_ring(&self, py: Python, id: &str, kind: Kind, at: Point, is_new: bool) -> PyResult<()> {
        let polygons = self.source.bind(py).getattr("polygon")?;
        let (ring, outline) = (format!("{id}_hl0"), ring_around(at));
        if is_new {
            polygons.call_method1("add", (ring, outline, ring_of(kind), true, "highlight", ABOVE_VEHICLES))?;
        } else {
            polygons.call_method1("setShape", (ring, outline))?;
        }
        Ok(())
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
fn worst_of_each(alarms: impl Iterator<Item = Alarm>) -> FxHashMap<UserIndex, Alarm> {
    let mut worst: FxHashMap<UserIndex, Alarm> = FxHashMap::default();
    for alarm in alarms {
        for user in [alarm.ego, alarm.foe] {
            let known = worst.entry(user).or_insert(alarm);
            if alarm.severity > known.severity || (alarm.severity == known.severity && alarm.kind < known.kind) {
                *known = alarm;
            }
        }
    }
    worst
}
