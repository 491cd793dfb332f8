//! Position, angle and speed of a road user, from libsumo's C++ functions if they are verified, can be called and agree with
//! its Python getters, otherwise from the Python getters.

use std::path::PathBuf;

use closecall::State;
use closecall::traffic::frame::SUMO_INVALID;
use pyo3::prelude::*;
use pyo3::types::{PyString, PyTuple};

use super::compiled::{Compiled, KeptAddress};
use super::reading::{Domain, Reading};
use super::simulation;

/// What road users are read through: the fastest last.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Through {
    /// Python's getters.
    Python,
    /// The functions of libsumo's C++ interface.
    Libsumo,
    /// SUMO's functions behind them.
    Direct,
}

/// The getters of one domain.
pub struct Getters {
    position: Py<PyAny>,
    angle: Py<PyAny>,
    speed: Py<PyAny>,
    inside: Option<Py<PyAny>>,
    compiled: Option<Compiled>,
    version: String,
    /// Why Python's getters are used where compiled ones were to be expected, until the remark is printed.
    remark: Option<String>,
}

impl Getters {
    /// The getters of the compiled module inside libsumo.
    pub fn new(module: &Bound<PyAny>, domain: Domain) -> PyResult<Self> {
        let name = match domain {
            Domain::Vehicle => "vehicle",
            Domain::Person => "person",
        };
        let function = |getter: &str| module.getattr(format!("{name}_{getter}")).map(Bound::unbind);
        let file = module.getattr("__file__").and_then(|file| file.extract::<PathBuf>()).ok();
        let (_, version) = module.call_method0("simulation_getVersion")?.extract::<(i64, String)>()?;
        let compiled = file.and_then(|file| Compiled::of(&file, &version, domain));
        let remark = (Compiled::IS_BUILT && compiled.is_none()).then(|| {
            format!("{version}: closecall does not know its C++ functions and reads through Python, which takes longer")
        });
        Ok(Self {
            position: function("getPosition3D")?,
            angle: function("getAngle")?,
            speed: function("getSpeed")?,
            inside: if domain == Domain::Person { Some(function("getVehicle")?) } else { None },
            compiled,
            version,
            remark,
        })
    }

    pub fn through(&self) -> Through {
        match &self.compiled {
            Some(compiled) if compiled.is_direct() => Through::Direct,
            Some(_) => Through::Libsumo,
            None => Through::Python,
        }
    }

    /// Reads through Python's getters from now on.
    pub fn use_python(&mut self) {
        self.compiled = None;
    }

    /// Why Python's getters are used where others were to be expected; only the first time.
    pub fn take_remark(&mut self) -> Option<String> {
        self.remark.take()
    }

    /// Reads a road user that enters with both kinds of getters. After the first difference only Python's are used.
    pub fn compare(&mut self, py: Python, id: &str) {
        if let Some(compiled) = &self.compiled
            && let Ok(asked) = self.ask(py, id)
            && compiled.read(id, None).is_none_or(|read| !same(read, asked))
        {
            self.compiled = None;
            self.remark = Some(format!(
                "{}: its C++ functions and Python's differ for \"{id}\"; closecall reads through Python, which takes longer",
                self.version
            ));
        }
    }

    /// The state of a road user; none if it is inside a vehicle.
    pub fn state(&self, py: Python, id: &str, kept: Option<&mut KeptAddress>) -> PyResult<Option<State>> {
        let reading = match self.compiled.as_ref().and_then(|compiled| compiled.read(id, kept)) {
            Some(reading) => reading,
            // For an unknown id, Python's getters raise the error to report.
            None => self.ask(py, id)?,
        };
        Ok(match reading {
            Reading::Inside => None,
            Reading::At { x, y, z, angle, speed } => {
                Some(State { x, y, z, heading: simulation::heading(angle), speed })
            }
        })
    }

    /// Whether a vehicle certainly still has the route with this id.
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
            // A road user without a position, during a teleport for example, has no height either.
            z: point.get_item(2).map_or(Ok(SUMO_INVALID), |z| z.extract())?,
            angle: ask(&self.angle)?.extract()?,
            speed: ask(&self.speed)?.extract()?,
        })
    }
}

/// Whether two readings are bitwise equal.
fn same(one: Reading, other: Reading) -> bool {
    let numbers = |reading| match reading {
        Reading::Inside => None,
        Reading::At { x, y, z, angle, speed } => Some([x, y, z, angle, speed].map(f64::to_bits)),
    };
    numbers(one) == numbers(other)
}
