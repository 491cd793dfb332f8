//! The conflicts of a repetition that are rolled out.

use std::path::Path;

use crate::Result;
use crate::batch::sweep::Task;
use crate::batch::whatif::{Asked, Tools, WhatIf};
use crate::logged::{ConflictReader, LoggedConflict, LoggedRun};
use closecall::util::units::Probability;

/// Added to the crash probability of a conflict, so that each may be chosen: others than the formula sees may end in a contact,
/// since all react.
const ANY: Probability = 0.02;

/// A run of the scenario, and the roll-outs of some of its conflicts.
#[derive(Debug)]
pub struct Repetition {
    /// The roll-outs.
    pub whatif: WhatIf,
    /// Simulated hours of the run.
    pub(super) hours: f64,
    /// Its conflicts that are traffic's.
    pub(super) conflicts: u64,
    /// The ids of those that were chosen, and the probability that they were.
    pub(super) chosen: Vec<(u64, Probability)>,
    /// The processor time of the run, in s.
    pub(super) cpu: f64,
}

impl Repetition {
    /// Chooses about `count` conflicts of a run, and prepares their roll-outs in the folder `out`.
    ///
    /// # Errors
    /// Those of reading the run's log and of [`WhatIf::prepare`].
    pub fn prepare(task: &Task, count: usize, asked: Asked, out: &Path, tools: &mut Tools) -> Result<Self> {
        let log = task.log();
        let run = LoggedRun::read(&log)?;
        let mut conflicts = Vec::new();
        for conflict in ConflictReader::open(&log)? {
            let conflict = conflict?;
            if conflict.artefact.is_empty() {
                conflicts.push(conflict);
            }
        }
        let mut random = fastrand::Rng::with_seed(u64::from(asked.seed) ^ run.seed.as_deref().map_or(0, hash));
        let weights = conflicts.iter().map(weight).collect::<Vec<_>>();
        let chosen = systematic(&weights, count, random.f64());
        let all = conflicts.len() as u64;
        let subjects = chosen.iter().map(|(place, _)| conflicts[*place].clone()).collect::<Vec<_>>();
        let chosen = chosen.iter().map(|(place, share)| (conflicts[*place].id, *share)).collect();
        let whatif = WhatIf::prepare(&log, subjects, asked, out, tools)?;
        Ok(Self { whatif, hours: run.hours(), conflicts: all, chosen, cpu: task.processor_time() })
    }
}

fn weight(conflict: &LoggedConflict) -> f64 {
    conflict.crash_probability.unwrap_or_default() + ANY
}

fn hash(seed: &str) -> u64 {
    seed.bytes().fold(1, |hash, byte| hash.wrapping_mul(31).wrapping_add(u64::from(byte)))
}

/// Chooses places with probabilities proportional to their weights, at most 1, `count` of them on average: systematic sampling
/// from a start in 0 to 1 (Madow 1949). Returns the places with their probabilities.
fn systematic(weights: &[f64], count: usize, start: f64) -> Vec<(usize, Probability)> {
    let shares = inclusion(weights, count);
    let mut passed = start;
    let mut chosen = Vec::new();
    for (place, share) in shares.into_iter().enumerate() {
        passed += share;
        if passed >= 1.0 {
            passed -= 1.0;
            chosen.push((place, share));
        }
    }
    chosen
}

/// Probabilities that sum to `count` and are proportional to the weights, but for those that reach 1.
fn inclusion(weights: &[f64], count: usize) -> Vec<Probability> {
    if count >= weights.len() {
        return vec![1.0; weights.len()];
    }
    let mut shares = vec![0.0; weights.len()];
    let mut left = count as f64;
    loop {
        let free = (0..weights.len()).filter(|place| shares[*place] < 1.0).collect::<Vec<_>>();
        let sum = free.iter().map(|place| weights[*place]).sum::<f64>();
        let mut has_full = false;
        for place in &free {
            shares[*place] = left * weights[*place] / sum;
            has_full |= shares[*place] >= 1.0;
        }
        if !has_full {
            return shares;
        }
        for share in &mut shares {
            *share = if *share >= 1.0 { 1.0 } else { 0.0 };
        }
        left = count as f64 - shares.iter().sum::<f64>();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_probabilities_are_proportional_and_at_most_one() {
        let shares = inclusion(&[10.0, 1.0, 1.0, 2.0], 2);
        assert_eq!(shares, [1.0, 0.25, 0.25, 0.5]);
        assert_eq!(inclusion(&[1.0, 2.0], 5), [1.0, 1.0]);
    }

    #[test]
    fn each_place_is_chosen_as_often_as_its_probability_says() {
        let weights = [3.0, 1.0, 0.5, 0.5, 1.0];
        let mut counts = [0; 5];
        for start in 0..1000 {
            let chosen = systematic(&weights, 2, f64::from(start) / 1000.0);
            assert_eq!(chosen.len(), 2);
            chosen.iter().for_each(|(place, _)| counts[*place] += 1);
        }
        for (count, share) in counts.into_iter().zip(inclusion(&weights, 2)) {
            assert!((f64::from(count) / 1000.0 - share).abs() < 0.002, "{count}, not {share}");
        }
    }
}
