//! A SUMO net (`*.net.xml`, also gzipped).
//!
//! It holds only what paths, obstacles and the log need: lane shapes, links and junctions. `overlaps`, `corners` and `quality`
//! find where it is not drawn as it is driven.

pub mod corners;
pub mod degrees;
pub mod elements;
pub mod finder;
pub mod network;
pub mod overlaps;
pub mod quality;
pub mod relations;

pub use elements::{Direction, EdgeFunction, EdgeIndex, JunctionIndex, Lane, LaneIndex, Link, Passage, Signal};
pub use network::Net;
pub use overlaps::{Overlap, Overlaps};
