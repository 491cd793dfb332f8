//! [`super::Level::Exact`]: byte for byte; differences are explained conflict by conflict.

use super::matching::matched;
use super::outcome::{Outcome, SeedConflict, SeedSummary};
use closecall_run::output::schema::{COLUMNS, Column};

/// The columns that tell how bad a conflict was, and where.
const TELLING: [&str; 16] = [
    "severity",
    "nearness",
    "consequence",
    "artefact",
    "collision",
    "begin",
    "end",
    "gap",
    "mu",
    "margin",
    "ttc",
    "drac",
    "pet",
    "ego_delta_v",
    "foe_delta_v",
    "lane",
];

/// The measures in the description of a conflict.
const MEASURES: [&str; 5] = ["gap", "margin", "ttc", "drac", "pet"];

/// What differs between expected and found results.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Differences {
    /// Conflicts that were not expected.
    pub new: Vec<String>,
    /// Conflicts that were expected.
    pub gone: Vec<String>,
    /// Conflicts with other values.
    pub changed: Vec<String>,
    /// Other differences: seeds, traffic, order.
    pub other: Vec<String>,
}

impl Differences {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        [&self.new, &self.gone, &self.changed, &self.other].iter().all(|differences| differences.is_empty())
    }

    /// The number of each, in words.
    pub fn counts(&self) -> String {
        let named = [(self.new.len(), "new"), (self.gone.len(), "gone"), (self.changed.len(), "changed")];
        let counts = named.map(|(count, name)| format!("{count} {name}")).join(", ");
        let only_other = self.new.is_empty() && self.gone.is_empty() && self.changed.is_empty();
        if only_other && !self.other.is_empty() { "the same conflicts, but other traffic".to_owned() } else { counts }
    }
}

/// Compares; empty exactly if `conflicts.csv` is the same byte for byte and steps and traffic are equal.
pub fn differences(expected: &Outcome, found: &Outcome) -> Differences {
    let mut differences = Differences::default();
    let old = expected.seeds();
    let new = found.seeds();
    if old != new {
        differences.other.push(format!("seeds {} → {}", list(&old), list(&new)));
    }
    for before in &expected.summary.seeds {
        let now = found.summary.seeds.iter().find(|now| now.seed == before.seed);
        differences.other.extend(now.and_then(|now| traffic(before, now)));
    }
    if expected.csv == found.csv {
        return differences;
    }
    let matching = matched(&expected.conflicts, &found.conflicts);
    differences.new = matching.new.iter().map(|row| described(row)).collect();
    differences.gone = matching.gone.iter().map(|row| described(row)).collect();
    differences.changed = matching.pairs.iter().filter_map(|(before, now)| changed(before, now)).collect();
    if differences.is_empty() {
        differences.other.push("the same conflicts in another order".to_owned());
    }
    differences
}

/// A conflict in one line: the pair, when, where, how bad.
pub(crate) fn described(row: &SeedConflict) -> String {
    let measures = MEASURES.into_iter().filter_map(Column::named).filter(|column| !row.text(column.name).is_empty());
    let told = measures.map(|column| with_unit(column, row.text(column.name)));
    let told = told.collect::<Vec<_>>().join(", ");
    let hit = if row.text("collision") == "true" { ", collision" } else { "" };
    let artefact = match row.text("artefact") {
        "" => String::new(),
        artefact => format!(", set aside: {artefact}"),
    };
    format!("{}: {}, {told}{hit}{artefact}", place(row), row.severity.name())
}

/// A value as it is written: a number without unit has none.
fn with_unit(column: &Column, value: &str) -> String {
    let unit = if column.unit() == "1" { String::new() } else { format!(" {}", column.unit()) };
    format!("{} {value}{unit}", column.name)
}

/// Seed, kind, pair, time and place.
fn place(row: &SeedConflict) -> String {
    let lane = if row.text("lane").is_empty() { String::new() } else { format!("on {} ", row.text("lane")) };
    format!(
        "seed {} {} {} with {}, {} s to {} s, {lane}at ({}, {})",
        row.seed,
        row.kind.name(),
        row.ego,
        row.foe,
        row.text("begin"),
        row.text("end"),
        row.text("x"),
        row.text("y")
    )
}

/// What differs, old and new: the columns that tell how bad it was and where, or, if they are equal, the others.
fn changed(before: &SeedConflict, now: &SeedConflict) -> Option<String> {
    let value = |row: &SeedConflict, column: &str| match row.text(column) {
        "" => "none".to_owned(),
        text => text.to_owned(),
    };
    let told = |columns: &[&str]| {
        // The number of a row changes with every conflict before it.
        let differing = columns.iter().filter(|column| **column != "id" && before.text(column) != now.text(column));
        let told = differing.map(|column| format!("{column} {} → {}", value(before, column), value(now, column)));
        told.collect::<Vec<_>>().join(", ")
    };
    let told = [told(&TELLING), told(&COLUMNS.map(|column| column.name))].into_iter().find(|told| !told.is_empty())?;
    Some(format!("{}: {told}", place(now)))
}

fn traffic(before: &SeedSummary, now: &SeedSummary) -> Option<String> {
    let old = before.exposure;
    let new = now.exposure;
    let numbers = [
        ("steps", before.steps as f64, now.steps as f64),
        ("vehicles", old.vehicles as f64, new.vehicles as f64),
        ("persons", old.persons as f64, new.persons as f64),
        ("vehicle-km", old.vehicle_kilometres, new.vehicle_kilometres),
        ("vehicle-h", old.vehicle_hours, new.vehicle_hours),
    ];
    let differing = numbers.iter().filter(|(_, old, new)| (old - new).abs() > 1e-9);
    let told = differing.map(|(what, old, new)| format!("{what} {old} → {new}")).collect::<Vec<_>>();
    (!told.is_empty()).then(|| format!("seed {}: {}", now.seed, told.join(", ")))
}

/// Seeds in words.
pub fn list(seeds: &[u32]) -> String {
    seeds.iter().map(u32::to_string).collect::<Vec<_>>().join(", ")
}
