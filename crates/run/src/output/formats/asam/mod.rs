//! A conflict's clip in ASAM's formats: OpenSCENARIO XML, which simulators play, and OSI, which sensor models and tools for
//! ground truth read.

mod bodies;
mod openscenario;
mod osi;
mod protobuf;

pub use openscenario::{Scenario, scenario};
pub use osi::trace;
