//! SUMO's nets as files (`*.net.xml`, also gzipped), their projections, and selections of their parts.

mod attributes;
mod connect;
pub mod projection;
mod reader;
pub mod selection;

pub use reader::{parse, read};
