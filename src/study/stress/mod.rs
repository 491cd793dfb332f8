//! Stiff and extreme cases against exact and high-precision references: `closecall stress`.
//!
//! Every case has a name and draws as many inputs as it is asked for; every property that it checks has a bound and
//! gets a row with the worst that was seen and the inputs that led there.

mod braking;
mod case;
mod geometry;
mod paths;
mod scene;
mod table;
mod tally;
mod time;

pub use scene::car;
pub use tally::{Group, Property, Row, Unit};

use super::reference::chance::Chance;
use tally::Tally;

/// Draws `count` inputs in all, shared out to all cases (or those of one group), and says what was seen of each.
///
/// Every case has a stream of its own, so a row depends on the seed and its number of inputs alone.
pub fn run(count: u64, seed: u64, only: Option<Group>) -> Vec<Row> {
    let all = braking::CASES.iter().chain(geometry::CASES).chain(time::CASES).chain(paths::CASES);
    let chosen = all.filter(|case| only.is_none_or(|group| case.group == group)).collect::<Vec<_>>();
    let each = count.div_ceil(chosen.len().max(1) as u64);
    let mut rows = Vec::new();
    for (number, case) in chosen.into_iter().enumerate() {
        let mut chance = Chance::new(seed.wrapping_mul(1 << 20).wrapping_add(number as u64));
        let mut tally = Tally::new(case.name, case.group);
        for _ in 0..(each / case.cost).max(1) {
            (case.check)(&mut chance, &mut tally);
        }
        rows.extend(tally.rows());
    }
    rows
}

/// The rows as a table for a terminal.
pub fn table(rows: &[Row]) -> String {
    table::of(rows)
}
