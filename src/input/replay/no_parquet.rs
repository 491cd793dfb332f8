//! Stands in for `parquet.rs` in a build without the feature `parquet`: such recordings are refused with a message.

use std::fs::File;
use std::path::Path;

use super::fields::Scope;
use super::names::Users;
use super::rows::RecordedStep;
use crate::{Error, Result};

/// No value of it exists.
pub(super) enum ParquetRecording {}

impl ParquetRecording {
    pub fn new(path: &Path, _: File, _: Scope) -> Result<Self> {
        Err(Error::content(path, "this build reads no Parquet: it lacks the feature parquet"))
    }

    pub fn next_step(&mut self, _: &mut RecordedStep, _: &mut Users) -> Result<bool> {
        match *self {}
    }
}
