//! The results of one case: the worst error of every property, and its inputs.

use std::fmt;

use crate::reference::{BigFloat, Deviation, deviation};

/// A group of cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Group {
    /// Stopping distance and μ.
    Braking,
    /// Time left and time to brake.
    Late,
    /// Crash and injury probabilities.
    Probability,
    /// Contact and distance of rectangles.
    Geometry,
    /// Time to collision, steps, events.
    Time,
    /// Lines and the poses along them.
    Paths,
    /// The whole detector, step by step.
    Detector,
}

/// The unit of a property's error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Relative to the expected value.
    Relative,
    /// As it is: a probability.
    Absolute,
    /// Metres.
    Metre,
    /// Units in the last place of a coordinate.
    Ulps,
    /// Seconds.
    Second,
    /// The number of inputs for which the property does not hold.
    Violations,
}

impl Unit {
    /// The text after a number.
    pub fn name(self) -> &'static str {
        match self {
            Self::Relative => "relative",
            Self::Absolute => "absolute",
            Self::Metre => "m",
            Self::Ulps => "ulps",
            Self::Second => "s",
            Self::Violations => "times",
        }
    }
}

/// A property that must hold for every input, to within a bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Property {
    /// Its name.
    pub name: &'static str,
    /// The unit of the bound and of errors.
    pub unit: Unit,
    /// The largest allowed error.
    pub bound: f64,
}

impl Property {
    /// A property that holds or does not hold.
    pub(crate) const fn always(name: &'static str) -> Self {
        Self { name, unit: Unit::Violations, bound: 0.0 }
    }

    /// A property that holds to within `bound`.
    pub const fn within(name: &'static str, bound: f64, unit: Unit) -> Self {
        Self { name, unit, bound }
    }
}

/// The result of one property in one case.
#[derive(Clone, Debug, PartialEq)]
pub struct PropertyResult {
    /// The case's group.
    pub group: Group,
    /// The case's name.
    pub case: &'static str,
    /// The property.
    pub property: Property,
    /// The number of inputs for which it was checked.
    pub inputs: u64,
    /// The worst error, in the property's unit.
    pub worst: f64,
    /// The worst error in units in the last place, for relative errors.
    pub ulps: Option<f64>,
    /// The inputs of the worst error.
    pub at: String,
}

impl PropertyResult {
    /// Whether no error exceeds the bound.
    pub fn holds(&self) -> bool {
        self.worst <= self.property.bound
    }
}

/// Collects the results of one case.
pub(super) struct Tally {
    case: &'static str,
    group: Group,
    rows: Vec<PropertyResult>,
}

impl Tally {
    pub(super) fn new(case: &'static str, group: Group) -> Self {
        Self { case, group, rows: Vec::new() }
    }

    pub(super) fn rows(self) -> Vec<PropertyResult> {
        self.rows
    }

    /// Records whether a property holds for these inputs.
    pub(super) fn holds(&mut self, property: Property, holds: bool, inputs: &dyn fmt::Debug) {
        let row = self.row(property);
        row.inputs += 1;
        if !holds {
            row.worst += 1.0;
            row.at = format!("{inputs:?}");
        }
    }

    /// Records the error of a result.
    pub(super) fn error(&mut self, property: Property, error: f64, inputs: &dyn fmt::Debug) {
        let row = self.row(property);
        row.inputs += 1;
        // A NaN is the worst error.
        let error = if error.is_nan() { f64::INFINITY } else { error };
        if error > row.worst {
            row.worst = error;
            row.at = format!("{inputs:?}");
        }
    }

    /// Records the deviation of a result from its expected value.
    pub(super) fn compare(&mut self, property: Property, found: f64, expected: &BigFloat, inputs: &dyn fmt::Debug) {
        let Deviation { absolute, relative, ulps } = deviation(found, expected);
        let error = match property.unit {
            Unit::Relative => relative,
            Unit::Ulps => ulps,
            _ => absolute,
        };
        self.error(property, error, inputs);
        if property.unit == Unit::Relative {
            let row = self.row(property);
            row.ulps = Some(row.ulps.unwrap_or(0.0).max(ulps));
        }
    }

    fn row(&mut self, property: Property) -> &mut PropertyResult {
        let index = self.rows.iter().position(|row| row.property == property).unwrap_or_else(|| {
            self.rows.push(PropertyResult {
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
