//! Files that come from SUMO: recordings that are replayed, and the inputs of a simulation.

pub mod replay;
pub mod sumo_files;
