//! What was seen of one case: the worst of every property, and where.

use std::fmt;

use crate::study::reference::{Deviation, Number, deviation};

/// What a case is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Group {
    /// Stopping distance and μ.
    Braking,
    /// ContactInterval and distance of rectangles.
    Geometry,
    /// Time to collision, steps, events.
    Time,
    /// Lines on the ground and the poses along them.
    Paths,
}

/// How a property's error is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Relative to the value that it should have.
    Relative,
    /// Metres.
    Metre,
    /// Units in the last place of a coordinate.
    Ulps,
    /// Seconds.
    Second,
    /// How often it does not hold.
    Violations,
}

impl Unit {
    /// As it stands behind a number.
    pub fn name(self) -> &'static str {
        match self {
            Self::Relative => "relative",
            Self::Metre => "m",
            Self::Ulps => "ulps",
            Self::Second => "s",
            Self::Violations => "times",
        }
    }
}

/// Something that has to hold for every input, to within a bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Property {
    /// What has to hold.
    pub name: &'static str,
    /// What the bound is measured in.
    pub unit: Unit,
    /// The largest error that is allowed.
    pub bound: f64,
}

impl Property {
    /// Must hold for every input.
    pub const fn always(name: &'static str) -> Self {
        Self { name, unit: Unit::Violations, bound: 0.0 }
    }

    /// Must hold to within `bound`.
    pub const fn within(name: &'static str, bound: f64, unit: Unit) -> Self {
        Self { name, unit, bound }
    }
}

/// What was seen of one property in one case.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// What the case is about.
    pub group: Group,
    /// The case's name.
    pub case: &'static str,
    /// What had to hold.
    pub property: Property,
    /// How many inputs it was checked for.
    pub inputs: u64,
    /// The worst error, in the property's unit.
    pub worst: f64,
    /// The worst error in units in the last place, where that means something.
    pub ulps: Option<f64>,
    /// The inputs of the worst error.
    pub at: String,
}

impl Row {
    /// Whether the bound was kept.
    pub fn holds(&self) -> bool {
        self.worst <= self.property.bound
    }
}

/// Collects the rows of one case.
pub(super) struct Tally {
    case: &'static str,
    group: Group,
    rows: Vec<Row>,
}

impl Tally {
    pub(super) fn new(case: &'static str, group: Group) -> Self {
        Self { case, group, rows: Vec::new() }
    }

    pub(super) fn rows(self) -> Vec<Row> {
        self.rows
    }

    /// An invariant holds for these inputs, or does not.
    pub(super) fn holds(&mut self, property: Property, holds: bool, inputs: &dyn fmt::Debug) {
        let row = self.row(property);
        row.inputs += 1;
        if !holds {
            row.worst += 1.0;
            row.at = format!("{inputs:?}");
        }
    }

    /// A result differs this much from what it should be.
    pub(super) fn error(&mut self, property: Property, error: f64, inputs: &dyn fmt::Debug) {
        let row = self.row(property);
        row.inputs += 1;
        // A NaN is the worst of all.
        let error = if error.is_nan() { f64::INFINITY } else { error };
        if error > row.worst {
            row.worst = error;
            row.at = format!("{inputs:?}");
        }
    }

    /// A result beside what it should be.
    pub(super) fn compare(&mut self, property: Property, found: f64, expected: &Number, inputs: &dyn fmt::Debug) {
        let Deviation { absolute, relative, ulps } = deviation(found, expected);
        let error = if property.unit == Unit::Relative { relative } else { absolute };
        self.error(property, error, inputs);
        if property.unit == Unit::Relative {
            let row = self.row(property);
            row.ulps = Some(row.ulps.unwrap_or(0.0).max(ulps));
        }
    }

    fn row(&mut self, property: Property) -> &mut Row {
        let index = self.rows.iter().position(|row| row.property == property).unwrap_or_else(|| {
            self.rows.push(Row {
                group: self.group,
                case: self.case,
                property,
                inputs: 0,
                worst: 0.0,
                ulps: None,
                at: String::new(),
            });
            self.rows.len() - 1
        });
        &mut self.rows[index]
    }
}
