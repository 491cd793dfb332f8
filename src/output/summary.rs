//! What a run found, in numbers: the table at its end and the counts in `run.json`.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::detection::detector::LeftOut;
use crate::detection::kind::{Kind, Severity};
use crate::events::Conflict;
use crate::util::units::Second;

/// What a run found.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Summary {
    /// First step, in s.
    pub begin: Second,
    /// Last step, in s.
    pub end: Second,
    /// Steps that were checked.
    pub steps: u64,
    /// Conflicts by kind and severity.
    pub conflicts: Vec<Count>,
    /// Conflicts in which the two rectangles overlapped.
    pub collisions: u64,
    /// How much traffic it was.
    pub exposure: Exposure,
    /// What the scene did not need.
    pub left_out: Vec<LeftOut>,
    /// What may have been meant otherwise, a line each; not part of the result.
    #[serde(skip)]
    pub remarks: Vec<String>,
    /// Where the time went: what, and how many seconds; not part of the result.
    #[serde(skip)]
    pub spent: Vec<(&'static str, f64)>,
}

/// How many conflicts of one kind and severity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Count {
    /// The kind.
    pub kind: Kind,
    /// The severity.
    pub severity: Severity,
    /// How many.
    pub count: u64,
}

/// How much traffic a run had.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Exposure {
    /// Vehicles that were in the scene.
    pub vehicles: u64,
    /// Persons that were in the scene.
    pub persons: u64,
    /// Way of all vehicles, in km.
    pub vehicle_kilometres: f64,
    /// Time of all vehicles in the scene, in h.
    pub vehicle_hours: f64,
}

impl Summary {
    /// Counts a conflict.
    pub fn add(&mut self, conflict: &Conflict) {
        self.collisions += u64::from(conflict.collision);
        let known =
            self.conflicts.iter_mut().find(|known| known.kind == conflict.kind && known.severity == conflict.severity);
        match known {
            Some(known) => known.count += 1,
            None => {
                self.conflicts.push(Count { kind: conflict.kind, severity: conflict.severity, count: 1 });
                self.conflicts.sort_by_key(|count| (count.kind, count.severity));
            }
        }
    }

    /// How many conflicts of a kind, of a severity, or of both; all where neither is given.
    pub fn count(&self, kind: Option<Kind>, severity: Option<Severity>) -> u64 {
        let wanted = |count: &&Count| {
            kind.is_none_or(|kind| kind == count.kind) && severity.is_none_or(|severity| severity == count.severity)
        };
        self.conflicts.iter().filter(wanted).map(|count| count.count).sum()
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:<10}", "conflicts")?;
        for severity in Severity::ALL {
            write!(f, "{:>10}", severity.name())?;
        }
        writeln!(f, "{:>10}", "all")?;
        for kind in Kind::ALL.map(Some).into_iter().chain([None]) {
            write!(f, "{:<10}", kind.map_or("all", Kind::name))?;
            for severity in Severity::ALL {
                write!(f, "{:>10}", self.count(kind, Some(severity)))?;
            }
            writeln!(f, "{:>10}", self.count(kind, None))?;
        }
        let Exposure { vehicles, persons, vehicle_kilometres, .. } = self.exposure;
        writeln!(f, "collisions {}", self.collisions)?;
        writeln!(
            f,
            "{vehicles} vehicles, {persons} persons, {vehicle_kilometres:.1} vehicle-km, {} steps from {} to {} s",
            self.steps,
            rounded(self.begin),
            rounded(self.end)
        )?;
        for left_out in &self.left_out {
            writeln!(f, "{left_out}")?;
        }
        for remark in &self.remarks {
            writeln!(f, "{remark}")?;
        }
        let parts = self.spent.iter().map(|(what, seconds)| format!("{what} {seconds:.3} s"));
        if !self.spent.is_empty() {
            writeln!(f, "time: {}", parts.collect::<Vec<_>>().join(", "))?;
        }
        Ok(())
    }
}

/// A time without the digits that sums of steps leave behind.
fn rounded(time: Second) -> f64 {
    (time * 1e6).round() / 1e6
}
