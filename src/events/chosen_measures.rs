//! The measures of an event that a log has only if they are chosen: aggregates of its steps' values.

use crate::detection::measures::table::Over;
use crate::options::measures::{ChosenMeasure, ChosenValues};
use crate::util::units::Second;

/// Makes the function that has the rule of each measure of the rows of the table.
macro_rules! rule_measures {
    ($( $(#[doc = $meaning:literal])+ $variant:ident $name:ident: $unit:ty, $over:ident = $value:expr; )+) => {
        fn over(measure: ChosenMeasure) -> Over {
            match measure { $( ChosenMeasure::$variant => Over::$over, )+ }
        }
    };
}

crate::chosen_measures!(rule_measures!);

/// The chosen measures of an event so far.
#[derive(Clone, Debug)]
pub(super) struct ChosenMeasures {
    /// Of an integral or a mean, the integral.
    values: ChosenValues,
    /// How long the steps so far lasted together.
    lasted: Second,
    /// The smallest TTC so far.
    ttc: Second,
}

/// What a step adds.
pub(super) struct Step<'a> {
    pub values: &'a ChosenValues,
    pub ttc: Option<Second>,
    /// Since the step before, in s.
    pub lasted: Second,
}

impl ChosenMeasures {
    /// Those of a first step.
    pub fn of(step: &Step) -> Self {
        let mut chosen = Self { values: [None; ChosenMeasure::ALL.len()], lasted: 0.0, ttc: f64::INFINITY };
        chosen.take(step, true);
        chosen
    }

    /// Adds a step, which may be the one with the smallest margin so far.
    pub fn take(&mut self, step: &Step, is_worst: bool) {
        let [known_speed, speed] = [&self.values, step.values].map(|of| of[ChosenMeasure::ConflictingSpeed as usize]);
        let begins_to_brake = known_speed.is_none() && speed.is_some();
        let has_least_ttc = step.ttc.is_some_and(|ttc| ttc < self.ttc);
        self.ttc = step.ttc.map_or(self.ttc, |ttc| ttc.min(self.ttc));
        self.lasted += step.lasted;
        for (measure, (known, now)) in ChosenMeasure::ALL.into_iter().zip(self.values.iter_mut().zip(step.values)) {
            *known = match (over(measure), *known, *now) {
                (Over::Worst, _, now) if is_worst => now,
                (Over::LeastTtc, _, now) if has_least_ttc => now,
                (Over::Onset, _, now) if begins_to_brake => now,
                (Over::Integral | Over::Mean, known, Some(now)) => Some(known.unwrap_or(0.0) + now * step.lasted),
                (Over::Least, Some(known), Some(now)) => Some(known.min(now)),
                (Over::FirstBelowZero, Some(known), Some(now)) if known >= 0.0 => Some(known.min(now)),
                (Over::Most, Some(known), Some(now)) => Some(known.max(now)),
                (Over::Least | Over::Most | Over::FirstBelowZero, None, now) => now,
                (_, known, _) => known,
            };
        }
    }

    /// The measures of the event.
    pub fn values(&self) -> ChosenValues {
        let mut values = self.values;
        for (measure, value) in ChosenMeasure::ALL.into_iter().zip(&mut values) {
            if over(measure) == Over::Mean {
                *value = value.map(|sum| sum / self.lasted).filter(|mean| mean.is_finite());
            }
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::measures::ChosenMeasure::{
        ConflictingSpeed, Cpi, DeltaS, Dr, MaxD, RssDistance, RssViolation, Ta, Tadv, Tet,
    };

    /// A measure over steps of 0.1 s, the first of them the first of the run; each has a TTC and a margin.
    fn over_steps(measure: ChosenMeasure, steps: &[(Option<f64>, f64)]) -> Option<f64> {
        let mut chosen: Option<ChosenMeasures> = None;
        let mut ttcs = (1..).map(|number| f64::from((number * 5) % 7));
        let mut least = f64::INFINITY;
        for (number, (value, margin)) in steps.iter().enumerate() {
            let mut values = [None; ChosenMeasure::ALL.len()];
            values[measure as usize] = *value;
            let step = Step { values: &values, ttc: ttcs.next(), lasted: if number == 0 { 0.0 } else { 0.1 } };
            let is_worst = *margin < least;
            least = least.min(*margin);
            match &mut chosen {
                Some(chosen) => chosen.take(&step, is_worst),
                None => chosen = Some(ChosenMeasures::of(&step)),
            }
        }
        chosen?.values()[measure as usize]
    }

    #[test]
    fn each_measure_is_what_its_rule_makes_of_the_steps() {
        let steps = [(Some(2.0), -1.0), (None, -3.0), (Some(1.0), -4.0), (Some(4.0), -2.0)];
        let found = |measure| over_steps(measure, &steps);
        assert_eq!(found(Tadv), Some(1.0));
        assert_eq!(found(RssDistance), Some(1.0));
        // The TTCs are 5, 3, 1 and 6 s.
        assert_eq!(found(DeltaS), Some(1.0));
        let close = |measure, expected: f64| assert!((found(measure).unwrap() - expected).abs() < 1e-12);
        close(Tet, 0.5);
        close(Cpi, 0.5 / 0.3);
        assert_eq!(over_steps(Tadv, &[(None, -1.0)]), None);
    }

    #[test]
    fn the_time_to_accident_is_that_of_the_step_in_which_braking_begins() {
        let ta = |steps: &[(Option<f64>, Option<f64>)]| {
            let mut chosen: Option<ChosenMeasures> = None;
            for (ta, speed) in steps {
                let mut values = [None; ChosenMeasure::ALL.len()];
                (values[Ta as usize], values[ConflictingSpeed as usize]) = (*ta, *speed);
                let step = Step { values: &values, ttc: None, lasted: 0.1 };
                match &mut chosen {
                    Some(chosen) => chosen.take(&step, false),
                    None => chosen = Some(ChosenMeasures::of(&step)),
                }
            }
            [Ta, ConflictingSpeed].map(|measure| chosen.as_ref().unwrap().values()[measure as usize])
        };
        let braking = [(Some(2.0), Some(9.0)), (Some(1.0), Some(8.0))];
        assert_eq!(ta(&[&[(None, None)], &braking[..]].concat()), [Some(2.0), Some(9.0)]);
        // Not on a collision course when the braking began.
        assert_eq!(ta(&[&[(None, None), (None, Some(10.0))], &braking[..]].concat()), [None, Some(10.0)]);
    }

    #[test]
    fn the_first_braking_is_the_rate_if_there_is_one() {
        let rates = |accelerations: &[f64]| {
            let steps = accelerations.iter().map(|value| (Some(*value), 0.0)).collect::<Vec<_>>();
            [Dr, MaxD].map(|measure| over_steps(measure, &steps).unwrap())
        };
        assert_eq!(rates(&[1.0, -0.5, -4.0, 2.0]), [-0.5, -4.0]);
        assert_eq!(rates(&[1.0, 0.5, 2.0]), [0.5, 0.5]);
    }

    #[test]
    fn a_step_counts_as_long_as_it_lasted() {
        let long = [(Some(1.0), 0.0), (Some(0.0), 0.0), (Some(1.0), 0.0)];
        assert!((over_steps(RssViolation, &long).unwrap() - 0.1).abs() < 1e-12);
        // The first step of a run lasted nothing.
        assert_eq!(over_steps(Cpi, &[(Some(0.5), 0.0)]), None);
    }
}
