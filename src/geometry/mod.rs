//! Rectangles, polygons, and where moving ones touch.

pub mod polygon;
