//! Crash probabilities: an upper bound for each pair that is measured, the value on request.
//!
//! A driver whose vehicle brakes as weakly as it may has the shortest wait, so the probability that it responds later than that
//! wait is an upper bound of the crash probability. It takes one closed form instead of sixteen. The value is worked out if
//! it could be the conflict's largest so far, decide its severity or a condition, or appear in an alarm or a series.

use std::cell::Cell;

use crate::braking::LateBraking;
use crate::detection::encounter::{ChancesIndex, Nearness};
use crate::detection::measures::crash_probability::{bounds, crash_probability};
use crate::detection::measures::table::LoggedMeasure;
use crate::detection::measures::ttb::Evasion;
use crate::traffic::driver_distributions::Driver;
use crate::traffic::roster::{ProfileIndex, Roster};
use crate::util::units::{Metre, MetrePerSecondSquared, Probability, Second};

/// The measures of the two chances of a pair.
pub(super) const CHANCES: [LoggedMeasure; 2] =
    [LoggedMeasure::CrashProbability, LoggedMeasure::CrashProbabilityBraking];

/// What a crash probability of a pair follows from.
#[derive(Clone, Copy, Debug)]
pub(super) enum Chance {
    /// It is known.
    Known(Probability),
    /// It follows from how this driver can evade.
    Of {
        /// The type of whichever has to brake.
        driver: ProfileIndex,
        braking: LateBraking,
        evasion: Evasion<Limits>,
        has_responded: bool,
    },
}

/// A range of [`Chances::limits`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    begin: u32,
    end: u32,
}

/// The chances of all pairs that one thread measures in a step.
#[derive(Default)]
pub(super) struct Chances {
    /// The thread's number.
    pub worker: u32,
    step: u32,
    /// How many probabilities were not worked out since the run began, and how many of them were later.
    left_out: u64,
    asked_for: Cell<u64>,
    /// Of each pair: if the foe goes on as now, and if it brakes fully.
    of_pairs: Vec<[Chance; 2]>,
    /// How far an ego may be at which times.
    limits: Vec<(Second, Metre)>,
}

impl Chances {
    /// Forgets those of the last step.
    pub fn clear(&mut self) {
        self.step = self.step.wrapping_add(1);
        self.of_pairs.clear();
        self.limits.clear();
    }

    /// Keeps an evasion until the end of the step.
    pub fn keep(&mut self, evasion: &Evasion<&[(Second, Metre)]>) -> Evasion<Limits> {
        evasion.map(|limits| {
            let begin = self.limits.len() as u32;
            self.limits.extend_from_slice(limits);
            Limits { begin, end: self.limits.len() as u32 }
        })
    }

    /// Adds a pair with `left_out` probabilities not worked out; returns where it is.
    pub fn add(&mut self, of_pair: [Chance; 2], left_out: usize) -> ChancesIndex {
        self.left_out += left_out as u64;
        let place = self.of_pairs.len() as u32;
        self.of_pairs.push(of_pair);
        ChancesIndex { worker: self.worker, place, step: self.step }
    }

    /// A lower and an upper bound of a probability.
    pub fn bounds(&self, chance: &Chance, roster: &Roster) -> [Probability; 2] {
        self.work_out(
            chance,
            roster,
            |known| [known; 2],
            |driver, has_responded, wait| bounds(driver, has_responded, wait),
        )
    }

    /// A probability.
    pub fn value(&self, chance: &Chance, roster: &Roster) -> Probability {
        self.work_out(
            chance,
            roster,
            |known| known,
            |driver, has_responded, wait| crash_probability(driver, has_responded, wait),
        )
    }

    /// A probability of a pair that was measured; none of one that was not worked out in an earlier step.
    pub fn of(&self, nearness: &Nearness, measure: LoggedMeasure, roster: &Roster) -> Option<Probability> {
        let (known, which) = match measure {
            LoggedMeasure::CrashProbabilityBraking => (nearness.values.crash_probability_braking(), 1),
            _ => (nearness.values.crash_probability(), 0),
        };
        known.or_else(|| {
            let ChancesIndex { place, step, .. } = nearness.chances;
            let chances = self.of_pairs.get(place as usize).filter(|_| step == self.step)?;
            self.asked_for.set(self.asked_for.get() + 1);
            Some(self.value(&chances[which], roster))
        })
    }

    /// How many probabilities were never worked out.
    pub fn left_out(&self) -> u64 {
        self.left_out.saturating_sub(self.asked_for.get())
    }

    /// What follows from a driver, whether it has responded, and its longest wait.
    fn work_out<T>(
        &self,
        chance: &Chance,
        roster: &Roster,
        known: impl FnOnce(Probability) -> T,
        formula: impl FnOnce(&Driver, bool, &dyn Fn(MetrePerSecondSquared) -> Second) -> T,
    ) -> T {
        match chance {
            Chance::Known(probability) => known(*probability),
            Chance::Of { driver, braking, evasion, has_responded } => {
                let driver = &roster.profile_at(*driver).driver;
                let evasion = evasion.map(|Limits { begin, end }| &self.limits[begin as usize..end as usize]);
                let wait = |deceleration: MetrePerSecondSquared| {
                    evasion.longest_wait(&driver.braking_with(deceleration, braking))
                };
                formula(driver, *has_responded, &wait)
            }
        }
    }
}
