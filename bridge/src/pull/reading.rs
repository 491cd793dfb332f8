//! What libsumo reports of one road user in one step.

/// Vehicles or persons.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Domain {
    Vehicle,
    Person,
}

/// What libsumo says of a road user.
#[derive(Clone, Copy)]
pub enum Reading {
    /// It is inside a vehicle: no road user of its own.
    Inside,
    /// Position in m, angle in degrees as SUMO has it, speed in m/s.
    At { x: f64, y: f64, z: f64, angle: f64, speed: f64 },
}
