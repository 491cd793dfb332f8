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
mod net_faults;
mod one_between;
mod path;
mod replay;
#[path = "../common/street.rs"]
mod street;
mod struck;
mod sublane;
mod time_to_collision;
mod way;
mod why;
