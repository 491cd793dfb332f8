//! Where a road user is, how it is turned and how fast: asked of libsumo's C++ functions where they can be called and
//! say what its Python getters say, else of the Python getters.

use std::path::PathBuf;

use closecall::traffic::frame::{SUMO_INVALID, State};
use pyo3::prelude::*;
use pyo3::types::{PyString, PyTuple};

use super::reading::{Domain, Reading};
use super::sumo;

#[cfg(compiled_getters)]
pub use super::compiled::Kept;

#[cfg(compiled_getters)]
use super::compiled::Compiled;

/// The getters of one domain.
pub struct Getters {
    position: Py<PyAny>,
    angle: Py<PyAny>,
    speed: Py<PyAny>,
    inside: Option<Py<PyAny>>,
    compiled: Option<Compiled>,
}

/// Stands where compiled.cpp is not compiled: there is none.
#[cfg(not(compiled_getters))]
enum Compiled {}

/// And nothing to keep.
#[cfg(not(compiled_getters))]
#[derive(Default)]
pub struct Kept;

#[cfg(not(compiled_getters))]
impl Compiled {
    fn of(_: &std::path::Path, _: &str, _: Domain) -> Option<Self> {
        None
    }

    fn read(&self, _: &str, _: Option<&mut Kept>) -> Option<Reading> {
        match *self {}
    }

    fn has_route(&self, _: &str, _: &str) -> bool {
        match *self {}
    }
}

impl Getters {
    /// Those of the compiled module inside libsumo.
    pub fn new(module: &Bound<PyAny>, domain: Domain) -> PyResult<Self> {
        let name = match domain {
            Domain::Vehicle => "vehicle",
            Domain::Person => "person",
        };
        let function = |getter: &str| module.getattr(format!("{name}_{getter}")).map(Bound::unbind);
        let file = module.getattr("__file__").and_then(|file| file.extract::<PathBuf>()).ok();
        let (_, version) = module.call_method0("simulation_getVersion")?.extract::<(i64, String)>()?;
        Ok(Self {
            position: function("getPosition3D")?,
            angle: function("getAngle")?,
            speed: function("getSpeed")?,
            inside: if domain == Domain::Person { Some(function("getVehicle")?) } else { None },
            compiled: file.and_then(|file| Compiled::of(&file, &version, domain)),
        })
    }

    /// Compares both ways for a road user that enters: from the first difference on, Python's getters are asked.
    pub fn enters(&mut self, py: Python, id: &str) {
        if let Some(compiled) = &self.compiled
            && let Ok(said) = self.ask(py, id)
            && compiled.read(id, None).is_none_or(|read| !same(read, said))
        {
            self.compiled = None;
        }
    }

    /// The state of a road user; none for one inside a vehicle.
    pub fn state(&self, py: Python, id: &str, kept: Option<&mut Kept>) -> PyResult<Option<State>> {
        let reading = match self.compiled.as_ref().and_then(|compiled| compiled.read(id, kept)) {
            Some(reading) => reading,
            // Python says of an unknown id what is wrong with it.
            None => self.ask(py, id)?,
        };
        Ok(match reading {
            Reading::Inside => None,
            Reading::At { x, y, z, angle, speed } => Some(State { x, y, z, heading: sumo::heading(angle), speed }),
        })
    }

    /// Whether a vehicle certainly still has the route of this id.
    pub fn has_route(&self, id: &str, route: &str) -> bool {
        self.compiled.as_ref().is_some_and(|compiled| compiled.has_route(id, route))
    }

    /// Asks Python's getters.
    fn ask(&self, py: Python, id: &str) -> PyResult<Reading> {
        let id = PyString::new(py, id);
        let ask = |getter: &Py<PyAny>| getter.bind(py).call1((&id,));
        if let Some(inside) = &self.inside
            && !ask(inside)?.extract::<&str>()?.is_empty()
        {
            return Ok(Reading::Inside);
        }
        let point = ask(&self.position)?.cast_into::<PyTuple>()?;
        Ok(Reading::At {
            x: point.get_item(0)?.extract()?,
            y: point.get_item(1)?.extract()?,
            // libsumo says nothing of the height of who is nowhere, on a teleport say.
            z: point.get_item(2).map_or(Ok(SUMO_INVALID), |z| z.extract())?,
            angle: ask(&self.angle)?.extract()?,
            speed: ask(&self.speed)?.extract()?,
        })
    }
}

/// Whether two readings are the same to the last bit.
fn same(one: Reading, other: Reading) -> bool {
    let numbers = |reading| match reading {
        Reading::Inside => None,
        Reading::At { x, y, z, angle, speed } => Some([x, y, z, angle, speed].map(f64::to_bits)),
    };
    numbers(one) == numbers(other)
}
