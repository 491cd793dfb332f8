//! One row of `conflicts.csv` as the page needs it, and which of them are the worst.

use std::cmp::Ordering;

/// The page holds as many conflicts at most: of more, the worst.
pub const MOST: usize = 300_000;

/// The number columns that go into the page, each with its decimals there.
pub const NUMBERS: [(&str, i32); 15] = [
    ("begin", 2),
    ("end", 2),
    ("time", 2),
    ("gap", 2),
    ("mu", 2),
    ("margin", 2),
    ("ttc", 2),
    ("drac", 2),
    ("pet", 2),
    ("delta_v", 2),
    ("ego_speed", 2),
    ("foe_speed", 2),
    ("angle", 3),
    ("x", 2),
    ("y", 2),
];
/// The place of `margin` among them.
const MARGIN: usize = 5;
/// The place of `ttc` among them.
const TTC: usize = 6;

/// What a drawing of the worst step needs of one of the two.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// x, y, heading, length, width.
    pub numbers: [f64; 5],
    /// The path, as it is in the log.
    pub path: Box<str>,
}

/// One conflict.
#[derive(Clone, Debug)]
pub struct Row {
    /// Which of the logs.
    pub run: u32,
    /// Its number in that log.
    pub id: u64,
    /// Place in `Kind::ALL`.
    pub kind: u8,
    /// Place in `Severity::ALL`.
    pub severity: u8,
    /// Whether they collided.
    pub collision: bool,
    /// The columns of [`NUMBERS`].
    pub numbers: [Option<f64>; NUMBERS.len()],
    /// Ego, foe.
    pub ids: [Box<str>; 2],
    /// Their types; empty where the log has none.
    pub types: [Box<str>; 2],
    /// The lane of the meeting place; empty where there is none.
    pub lane: Box<str>,
    /// Ego, foe; none where the log has none.
    pub snapshots: Option<Box<[Snapshot; 2]>>,
}

impl Row {
    /// The number in a column of [`NUMBERS`].
    pub fn number(&self, column: usize) -> Option<f64> {
        self.numbers.get(column).copied().flatten()
    }
}

/// Worst first: by severity, collision, TTC, margin; equal ones in the order of the logs.
pub fn by_badness(a: &Row, b: &Row) -> Ordering {
    let number = |row: &Row, which: usize| row.numbers[which].unwrap_or(f64::INFINITY);
    (b.severity, b.collision)
        .cmp(&(a.severity, a.collision))
        .then_with(|| number(a, TTC).total_cmp(&number(b, TTC)))
        .then_with(|| number(a, MARGIN).total_cmp(&number(b, MARGIN)))
        .then_with(|| (a.run, a.id).cmp(&(b.run, b.id)))
}

/// Rows, of more than [`MOST`] the worst: memory stays bounded however many there are.
#[derive(Debug, Default)]
pub struct Worst {
    rows: Vec<Row>,
    seen: u64,
}

impl Worst {
    /// Adds a row.
    pub fn push(&mut self, row: Row) {
        self.seen += 1;
        self.rows.push(row);
        if self.rows.len() >= 2 * MOST {
            self.prune();
        }
    }

    /// How many rows were added.
    pub fn seen(&self) -> u64 {
        self.seen
    }

    /// The rows that are kept, worst first.
    pub fn into_rows(mut self) -> Vec<Row> {
        self.prune();
        self.rows
    }

    fn prune(&mut self) {
        self.rows.sort_unstable_by(by_badness);
        self.rows.truncate(MOST);
    }
}
