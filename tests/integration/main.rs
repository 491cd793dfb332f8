//! Tests that cross modules, in one program: it is linked once.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may")]

mod align;
mod artefacts;
mod articulated;
mod bisection;
mod clips;
mod command_line;
mod contact;
mod detector;
mod driven;
mod hostile;
mod lane_lengths;
mod lanes;
mod levels;
mod names;
mod net_corners;
mod net_faults;
mod net_finder;
mod net_links;
mod net_overlaps;
mod net_quality;
mod net_relations;
mod one_between;
mod path;
mod replay;
mod road;
mod route;
#[path = "../common/street.rs"]
mod street;
mod struck;
mod sublane;
mod time_to_collision;
mod why;
