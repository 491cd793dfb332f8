//! A conflict of a log, played: as an animated picture, or in sumo-gui.

mod animation;
mod found;
mod picture;
mod roads;
mod view;

pub use found::{Playback, clips, may_have_clip};
pub use picture::{stills, svg};
pub use roads::{signal_bar, signal_colour};
