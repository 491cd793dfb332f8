//! What libsumo reports about one road user in one step.

/// Vehicles or persons.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Domain {
    Vehicle,
    Person,
}

/// The state of a road user.
#[derive(Clone, Copy)]
pub enum Reading {
    /// It is inside a vehicle, and so not a road user of its own.
    Inside,
    /// Position in m, SUMO's angle in degrees, speed in m/s.
    At { x: f64, y: f64, z: f64, angle: f64, speed: f64 },
}
