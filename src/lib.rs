//! # closecall
//!
//! Who comes closer than they can safely be? Road users come in as [`frame::Frame`]s, one per step; the
//! [`detector::Detector`] finds the pairs that would meet and measures each against the minimal collision distance μ
//! ([`braking`]): first cheaply, over circles ([`precollision`]), then accurately, along the [`path`]s of both
//! ([`accurate`]). What stays in conflict over several steps becomes one [`conflict::Conflict`], a row of the [`log`].

pub mod analysis;
pub mod batch;
pub mod braking;
pub mod cli;
pub mod detection;
mod error;
pub mod events;
pub mod geometry;
pub mod input;
pub mod options;
pub mod output;
pub mod run;
#[cfg(feature = "study")]
pub mod study;
pub mod traffic;
pub mod util;

pub use error::{Error, Result};
