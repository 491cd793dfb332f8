//! The crash rate that repetitions estimate.

use serde::Serialize;

use super::choice::Repetition;
use crate::batch::whatif::Answer;
use crate::statistics::rate::rate;
use crate::study::number::number;
use crate::{Error, Result};
use closecall::util::units::Probability;

/// Of the weight of the chosen conflicts, at most this share may have no roll-outs.
const MOST_REFUSED: f64 = 0.2;

/// A crash rate: `rare.csv`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CrashRate {
    /// Crashes per simulated hour.
    pub per_hour: f64,
    /// The lower end of its 95 % interval, Student's over the repetitions.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// The share of conflicts in which a driver errs.
    pub share: Probability,
    /// The repetitions.
    pub repetitions: usize,
    /// Their simulated hours.
    pub hours: f64,
    /// Conflicts per simulated hour.
    pub conflicts_per_hour: f64,
    /// The conflicts that were rolled out.
    pub rolled_out: usize,
    /// Their roll-outs, and those with a contact.
    pub roll_outs: u64,
    /// Those with a contact.
    pub contacts: u64,
    /// The share of the chosen conflicts, by weight, that could not be rolled out; the rest stands for them.
    pub refused: f64,
    /// The number of equally weighted conflicts that would say as much: (Σ c)² / Σ c² over their contributions c.
    pub effective_size: f64,
    /// The processor time of all runs, in s.
    pub cpu: f64,
    /// The hours of plain simulation that the same processor time buys.
    pub plain_hours: f64,
    /// The variance that these would leave over the variance here: how many times cheaper this is.
    pub gain: f64,
}

impl CrashRate {
    /// What a reader wants to know first.
    pub fn in_words(&self) -> String {
        let Self { per_hour, low, high, share, conflicts_per_hour, contacts, roll_outs, plain_hours, gain, .. } = self;
        let [rate, low, high, conflicts, hours, gain] =
            [per_hour, low, high, conflicts_per_hour, plain_hours, gain].map(|value| number(*value));
        format!(
            "{rate} crashes per hour ({low} to {high}) if a driver responds late in a share of {share} of the conflicts, of \
             which there are {conflicts} per hour\ncontact in {contacts} of {roll_outs} roll-outs; {hours} h of plain \
             simulation take the same time and leave {gain} times the variance"
        )
    }
}

/// The crash rate, if a driver errs in this share of conflicts; `cpu` is the processor time of all roll-outs, in s.
///
/// # Errors
/// [`Error::Value`] where SUMO's states do not carry what is needed; those of reading the runs.
pub fn estimate(repetitions: &[Repetition], share: Probability, cpu: f64) -> Result<CrashRate> {
    let mut contributions = Vec::new();
    let (mut roll_outs, mut contacts, mut rolled_out) = (0, 0, 0);
    let [mut asked, mut refused] = [0.0; 2];
    let mut reasons = Vec::new();
    let mut sums = Vec::with_capacity(repetitions.len());
    for repetition in repetitions {
        let answers = repetition.whatif.answers(&[])?;
        let [mut sum, mut weight, mut lost] = [0.0; 3];
        for (answer, (_, inclusion)) in answers.iter().zip(&repetition.chosen) {
            weight += inclusion.recip();
            if answer.roll_outs == 0 {
                lost += inclusion.recip();
                reasons.push(reason(answer));
                continue;
            }
            let contribution = answer.contacts as f64 / answer.roll_outs as f64 / inclusion;
            contributions.push(contribution);
            sum += contribution;
            roll_outs += answer.roll_outs;
            contacts += answer.contacts;
            rolled_out += 1;
        }
        asked += weight;
        refused += lost;
        sums.push(if weight > lost { share * sum * weight / (weight - lost) } else { 0.0 });
    }
    let refused = if asked > 0.0 { refused / asked } else { 0.0 };
    if refused > MOST_REFUSED {
        let why = reasons.first().cloned().unwrap_or_default();
        let per_cent = 100.0 * refused;
        return Err(Error::Value(format!(
            "{per_cent:.0} % of the conflicts cannot be rolled out, so that no rate follows; the first: {why}"
        )));
    }
    let hours = repetitions.iter().map(|repetition| repetition.hours).collect::<Vec<_>>();
    let all_hours = hours.iter().sum::<f64>();
    let found = rate(&sums, &hours).ok_or_else(|| Error::Value("no repetition has traffic".to_owned()))?;
    let base = repetitions.iter().map(|repetition| repetition.cpu).sum::<f64>();
    let conflicts = repetitions.iter().map(|repetition| repetition.conflicts).sum::<u64>() as f64;
    let cpu = base + cpu;
    let plain_hours = all_hours * cpu / base.max(f64::MIN_POSITIVE);
    let variance = variance_of_mean(&sums, &hours);
    let sum = contributions.iter().sum::<f64>();
    let squares = contributions.iter().map(|one| one * one).sum::<f64>();
    Ok(CrashRate {
        per_hour: found.value,
        low: found.low,
        high: found.high,
        share,
        repetitions: repetitions.len(),
        hours: all_hours,
        conflicts_per_hour: conflicts / all_hours,
        rolled_out,
        roll_outs,
        contacts,
        refused,
        effective_size: if squares > 0.0 { sum * sum / squares } else { 0.0 },
        cpu,
        plain_hours,
        gain: found.value / plain_hours / variance,
    })
}

/// The variance of the mean rate over the repetitions.
fn variance_of_mean(sums: &[f64], hours: &[f64]) -> f64 {
    let rates = sums.iter().zip(hours).map(|(sum, hours)| sum / hours).collect::<Vec<_>>();
    let count = rates.len() as f64;
    let mean = rates.iter().sum::<f64>() / count;
    rates.iter().map(|rate| (rate - mean).powi(2)).sum::<f64>() / (count - 1.0) / count
}

fn reason(answer: &Answer) -> String {
    format!(
        "conflict {}: {}",
        answer.conflict,
        if answer.remark.is_empty() { "no roll-out ended" } else { &answer.remark }
    )
}
