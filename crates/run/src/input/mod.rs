//! Recordings to replay, of SUMO and of others, and the inputs of a simulation.

pub mod replay;
pub mod scenario_kind;
pub mod sumo_files;
pub mod sumo_outputs;
pub mod tracks;
