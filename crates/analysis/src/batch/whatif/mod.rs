//! `closecall whatif`: conflicts of a run, rolled out again and again with drivers that err.
//!
//! The run is simulated once more and SUMO saves its state some seconds before each conflict (`scenario.rs`). From there go, each
//! as a run of a sweep: a baseline without an error; the roll-outs, each with a seed and a drawn driver; for those that end in a
//! contact the same again with the other driver braking too; and two with clips (`runs.rs`). A roll-out is compared with the
//! baseline, which goes on from the same state, not with the run: SUMO's states are not exact everywhere. Where that matters, each
//! of these runs begins with the run instead, and nothing drifts.

mod answer;
mod arms;
mod asked;
mod page;
mod paths;
mod runs;
mod scenario;

pub use answer::Answer;
pub use asked::{Asked, Draws, Onset, Whose};
pub use page::sections;
pub use runs::WhatIf;
pub use scenario::Tools;
