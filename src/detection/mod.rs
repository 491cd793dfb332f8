//! Frames in, encounters out: which pairs come too close in a step, and how close.
//!
//! The broad phase finds the pairs that may meet. The narrow phase finds their conflict points. The measures tell how
//! close a pair is.

pub mod broad_phase;
mod chosen_values;
pub mod course;
pub mod detector;
pub mod encounter;
pub mod kind;
pub mod measures;
pub mod narrow_phase;
pub mod path;
pub mod severity;
mod step_values;
