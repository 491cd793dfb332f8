//! Files that come from SUMO: recordings to replay, and the inputs of a simulation.

pub mod replay;
pub mod sumo_files;
