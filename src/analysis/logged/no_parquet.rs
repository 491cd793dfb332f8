//! Stands in for `parquet.rs` in a build without the feature `parquet`: such logs are refused with a message.

use std::path::Path;

use crate::output::schema::LoggedConflict;
use crate::{Error, Result};

/// No value of it exists.
#[derive(Debug)]
pub enum Packed {}

impl Packed {
    /// # Errors
    /// [`Error::Content`], always.
    pub fn record_of(path: &Path) -> Result<String> {
        Err(refused(path))
    }
}

/// No value of it exists.
#[derive(Debug)]
pub enum ParquetLog {}

impl ParquetLog {
    /// # Errors
    /// [`Error::Content`], always.
    pub fn open(path: &Path) -> Result<Self> {
        Err(refused(path))
    }

    pub fn read_snapshots(&mut self) {
        match *self {}
    }

    pub fn read_only(&mut self, _: &[&str]) {
        match *self {}
    }

    pub fn read_into(&mut self, _: &mut Option<LoggedConflict>) -> Result<bool> {
        match *self {}
    }

    pub fn whole(&mut self) -> Result<LoggedConflict> {
        match *self {}
    }

    pub fn is_changed(&self) -> bool {
        match *self {}
    }

    pub fn demand_margins_below_zero(&mut self) {
        match *self {}
    }

    pub fn columns(&self) -> Vec<String> {
        match *self {}
    }

    pub fn path(&self) -> &Path {
        match *self {}
    }

    pub fn read(&mut self) -> Result<Option<LoggedConflict>> {
        match *self {}
    }
}

fn refused(path: &Path) -> Error {
    Error::content(path, "this build reads no Parquet: it lacks the feature parquet")
}
