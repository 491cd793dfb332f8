//! The road users of a scene, step by step, and the net on which they move.

pub mod driver_distributions;
pub mod frame;
pub mod lane_change;
pub mod net;
pub mod placement;
pub mod profile;
pub mod roster;
pub mod signals;
pub mod sumo_type;
