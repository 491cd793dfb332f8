//! TraCI's get commands, many to a message: each message costs a round trip, and traci itself reads a value in Python in
//! several times the time in which SUMO answers.

use std::str;

use pyo3::exceptions::PyRuntimeError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;

/// What a variable is of: the command that gets it.
#[derive(Clone, Copy)]
#[repr(u8)]
pub enum Of {
    Light = 0xa2,
    Vehicle = 0xa4,
    Simulation = 0xab,
    Person = 0xae,
}

/// The variables, by their numbers in the protocol.
#[derive(Clone, Copy)]
#[repr(u8)]
pub enum Variable {
    Ids = 0x00,
    LightState = 0x20,
    Collisions = 0x23,
    DepartedPersons = 0x25,
    LateralSpeed = 0x32,
    Position3d = 0x39,
    Departure = 0x3a,
    Speed = 0x40,
    Angle = 0x43,
    Type = 0x4f,
    /// A vehicle's lane or a person's edge.
    Road = 0x50,
    Lane = 0x51,
    RouteId = 0x53,
    Edges = 0x54,
    LanePosition = 0x56,
    RouteIndex = 0x69,
    ParkingStarting = 0x6d,
    ParkingEnding = 0x6f,
    Departed = 0x74,
    StopState = 0xb5,
    /// The vehicle that a person is in.
    Vehicle = 0xc3,
}

const INTEGER: u8 = 0x09;
const DOUBLE: u8 = 0x0b;
const STRING: u8 = 0x0c;
const STRINGS: u8 = 0x0e;
const COMPOUND: u8 = 0x0f;
const POSITION_3D: u8 = 0x03;
const IS_OK: u8 = 0;

/// Get commands that make a message.
#[derive(Default)]
pub struct Requests(Vec<u8>);

impl Requests {
    /// Asks for a variable of the object with this id; the simulation has none.
    pub fn ask(&mut self, of: Of, variable: Variable, id: &str) {
        let length = 7 + id.len();
        match u8::try_from(length) {
            Ok(length) => self.0.push(length),
            Err(_) => {
                self.0.push(0);
                self.0.extend((length as u32 + 4).to_be_bytes());
            }
        }
        self.0.extend([of as u8, variable as u8]);
        self.0.extend((id.len() as u32).to_be_bytes());
        self.0.extend(id.as_bytes());
    }

    /// Sends them over the connection of a traci module or connection, and waits for SUMO's message. It is empty if nothing
    /// is asked.
    pub fn send(&self, source: &Bound<PyAny>) -> PyResult<PyBackedBytes> {
        let py = source.py();
        if self.0.is_empty() {
            return Ok(PyBytes::new(py, &[]).into());
        }
        let exchange = py.import(intern!(py, "closecall._traci"))?.getattr(intern!(py, "exchange"))?;
        Ok(exchange.call1((source, PyBytes::new(py, &self.0)))?.cast_into::<PyBytes>()?.into())
    }
}

/// SUMO's answer to a message ends early or has values of another type.
#[derive(thiserror::Error, Debug)]
#[error("SUMO's answer over traci is not understood; is its version that of traci?")]
pub struct NotUnderstood;

impl From<NotUnderstood> for PyErr {
    fn from(error: NotUnderstood) -> Self {
        PyRuntimeError::new_err(error.to_string())
    }
}

type Read<T> = Result<T, NotUnderstood>;

/// SUMO's answers to a message, in the order of the requests. None is an answer for an id that SUMO does not know.
pub struct Answers<'a>(&'a [u8]);

impl<'a> Answers<'a> {
    pub fn of(message: &'a [u8]) -> Self {
        Self(message)
    }

    pub fn integer(&mut self) -> Read<Option<i32>> {
        self.value(INTEGER, |it| it.array().map(i32::from_be_bytes))
    }

    pub fn number(&mut self) -> Read<Option<f64>> {
        self.value(DOUBLE, Self::double)
    }

    pub fn point(&mut self) -> Read<Option<[f64; 3]>> {
        self.value(POSITION_3D, |it| Ok([it.double()?, it.double()?, it.double()?]))
    }

    pub fn text(&mut self) -> Read<Option<&'a str>> {
        self.value(STRING, Self::string)
    }

    pub fn texts(&mut self) -> Read<Vec<&'a str>> {
        Ok(self.value(STRINGS, |it| (0..it.count()?).map(|_| it.string()).collect())?.unwrap_or_default())
    }

    /// The pairs of ids of the collisions.
    pub fn collisions(&mut self) -> Read<Vec<[String; 2]>> {
        let pairs = self.value(COMPOUND, |it| {
            it.count()?;
            it.expect(INTEGER)?;
            (0..it.count()?).map(|_| it.collision()).collect()
        })?;
        Ok(pairs.unwrap_or_default())
    }

    fn collision(&mut self) -> Read<[String; 2]> {
        let mut typed = || self.expect(STRING).and_then(|()| self.string());
        let pair = [typed()?.to_owned(), typed()?.to_owned()];
        // The types of both, their speeds, the type of the collision, the lane, the position there.
        for kind in [STRING, STRING, DOUBLE, DOUBLE, STRING, STRING, DOUBLE] {
            self.expect(kind)?;
            if kind == STRING {
                self.string()?;
            } else {
                self.double()?;
            }
        }
        Ok(pair)
    }

    /// The value of an answer of this type.
    fn value<T>(&mut self, kind: u8, read: impl FnOnce(&mut Self) -> Read<T>) -> Read<Option<T>> {
        self.length()?;
        let [_command, status] = self.array()?;
        let _description = self.bytes()?;
        if status != IS_OK {
            return Ok(None);
        }
        self.length()?;
        let [_command, _variable] = self.array()?;
        let _id = self.bytes()?;
        self.expect(kind)?;
        read(self).map(Some)
    }

    fn expect(&mut self, kind: u8) -> Read<()> {
        if self.array()? == [kind] { Ok(()) } else { Err(NotUnderstood) }
    }

    /// A length of 255 and more follows a zero.
    fn length(&mut self) -> Read<()> {
        if self.array()? == [0] { self.count().map(drop) } else { Ok(()) }
    }

    fn count(&mut self) -> Read<usize> {
        Ok(u32::from_be_bytes(self.array()?) as usize)
    }

    fn double(&mut self) -> Read<f64> {
        self.array().map(f64::from_be_bytes)
    }

    fn string(&mut self) -> Read<&'a str> {
        str::from_utf8(self.bytes()?).map_err(|_| NotUnderstood)
    }

    fn bytes(&mut self) -> Read<&'a [u8]> {
        let count = self.count()?;
        let (bytes, rest) = self.0.split_at_checked(count).ok_or(NotUnderstood)?;
        self.0 = rest;
        Ok(bytes)
    }

    fn array<const N: usize>(&mut self) -> Read<[u8; N]> {
        let (bytes, rest) = self.0.split_first_chunk().ok_or(NotUnderstood)?;
        self.0 = rest;
        Ok(*bytes)
    }
}
