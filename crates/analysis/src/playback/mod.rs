//! A conflict of a log, played: as an animated picture, or in sumo-gui.

mod animation;
mod drawn_net;
mod found;
mod overlay;
mod picture;
mod view;

pub use drawn_net::{signal_bar, signal_colour};
pub use found::{Playback, clips, may_have_clip};
pub use overlay::{DrawnPath, overlay};
pub use picture::{stills, svg};
