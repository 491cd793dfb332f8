//! Matches the conflicts of two runs: those with the same seed, pair (in either order), kind and time.

use std::collections::BTreeMap;

use super::outcome::SeedConflict;
use closecall::detection::kind::Kind;
use closecall::events::CLOSES_AFTER;
use closecall::util::units::Second;

/// The conflicts of two outcomes, side by side.
#[derive(Debug, Default)]
pub(crate) struct Matching<'a> {
    /// In both, before and now, in the order of the current run.
    pub pairs: Vec<(&'a SeedConflict, &'a SeedConflict)>,
    /// Only now.
    pub new: Vec<&'a SeedConflict>,
    /// Only before.
    pub gone: Vec<&'a SeedConflict>,
}

/// What two conflicts must have in common besides the time.
type Key<'a> = (u32, &'a str, &'a str, Kind);

/// Matches the conflicts of `before` with those of `now`. If several overlap, the longest overlap wins.
///
/// Two that are less than [`CLOSES_AFTER`] apart count as overlapping: within one run they would be one conflict.
pub(crate) fn matched<'a>(before: &'a [SeedConflict], now: &'a [SeedConflict]) -> Matching<'a> {
    let mut candidates: BTreeMap<Key, (Vec<&SeedConflict>, Vec<&SeedConflict>)> = BTreeMap::new();
    for row in before {
        candidates.entry(key(row)).or_default().0.push(row);
    }
    for row in now {
        candidates.entry(key(row)).or_default().1.push(row);
    }
    let mut matching = Matching::default();
    for (mut old, mut new) in candidates.into_values() {
        while let Some((i, j)) = longest_overlap(&old, &new) {
            matching.pairs.push((old.remove(i), new.remove(j)));
        }
        matching.gone.append(&mut old);
        matching.new.append(&mut new);
    }
    let order = |a: &SeedConflict, b: &SeedConflict| (a.seed).cmp(&b.seed).then(a.begin.total_cmp(&b.begin));
    matching.pairs.sort_by(|a, b| order(a.1, b.1));
    matching.new.sort_by(|a, b| order(a, b));
    matching.gone.sort_by(|a, b| order(a, b));
    matching
}

fn key(row: &SeedConflict) -> Key<'_> {
    let ego = row.ego.as_str();
    let foe = row.foe.as_str();
    (row.seed, ego.min(foe), ego.max(foe), row.kind)
}

fn longest_overlap(old: &[&SeedConflict], new: &[&SeedConflict]) -> Option<(usize, usize)> {
    let mut longest: Option<(Second, usize, usize)> = None;
    for (i, before) in old.iter().enumerate() {
        for (j, now) in new.iter().enumerate() {
            let overlap = before.end.min(now.end) - before.begin.max(now.begin);
            if overlap > -CLOSES_AFTER && longest.is_none_or(|(length, ..)| overlap > length) {
                longest = Some((overlap, i, j));
            }
        }
    }
    longest.map(|(_, i, j)| (i, j))
}
