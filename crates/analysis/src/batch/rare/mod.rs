//! `closecall rare`: the crash rate of a scenario in which drivers now and then respond late, too rare to wait for.
//!
//! Splitting in two levels with a fixed effort. The first level is a conflict: each repetition is a run of the scenario with a
//! seed of its own, of whose conflicts some are chosen, with a probability proportional to their crash probability. The second
//! is a contact: from SUMO's state before a chosen conflict its driver errs in each roll-out (`closecall whatif`). With the share q of
//! conflicts in which a driver errs, hours H, and the probability π with which a conflict was chosen,
//!
//! ```text
//! rate = q / H · Σ share of contacts / π        (Horvitz and Thompson 1952)
//! ```
//!
//! Repetitions are independent, so that the interval of their mean is Student's. A level between the two would cost more than it
//! saves: starting a process takes most of a roll-out's time.

mod choice;
mod estimate;

pub use choice::Repetition;
pub use estimate::{CrashRate, estimate};
