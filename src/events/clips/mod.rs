//! Clips: where the road users around a severe conflict were, from some seconds before its worst moment until some after.
//!
//! Whether a conflict is severe is known only while it lasts. So all road users of the last seconds are kept ([`recent`]), and
//! from them, once an event is severe enough, those near its pair are copied ([`take`]) until its clip is whole.

mod clip;
mod recent;
mod recorder;
mod take;

pub use clip::{Clip, ClipCategory, ClipSignal, ClipUser};
pub use recorder::{Clips, MOST, Scene};
