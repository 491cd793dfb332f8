//! Stiff and extreme cases against exact and high-precision references: `closecall stress`.
//!
//! Every case has a name and draws random inputs. Every property that it checks has a bound and gets a row with the worst
//! error and the inputs that caused it.

mod braking;
mod cars;
mod case;
mod detector;
mod geometry;
mod late;
mod paths;
mod probability;
mod table;
mod tally;
mod time;

pub use cars::car;
pub use tally::{Group, PropertyResult};

use super::reference::chance::Chance;
use tally::Tally;

/// Draws `count` inputs in total, divided among all cases or those of one group, and returns the results.
///
/// Every case has a random stream of its own, so a result depends only on the seed and the case's number of inputs.
pub fn run(count: u64, seed: u64, only: Option<Group>) -> Vec<PropertyResult> {
    let all = braking::CASES
        .iter()
        .chain(late::CASES)
        .chain(probability::CASES)
        .chain(geometry::CASES)
        .chain(time::CASES)
        .chain(paths::CASES)
        .chain(detector::CASES);
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

/// The results as a table for a terminal.
pub fn table(rows: &[PropertyResult]) -> String {
    table::of(rows)
}
