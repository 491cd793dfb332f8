//! Sums of weighted rare events, such as the risk index of a place, and their 95 % intervals.

use statrs::distribution::{ContinuousCDF, Gamma};

use super::rate::{IntervalMethod, Rate, TAIL, rate};

/// Events, each with a weight, such as conflicts with their crash probabilities.
#[derive(Clone, Debug, Default)]
pub struct WeightedEvents {
    /// The sum of the weights per run, for the runs that had any, in the order of the runs.
    per_run: Vec<(u32, f64)>,
    squares: f64,
    greatest: f64,
}

impl WeightedEvents {
    /// Adds an event of a run; runs come in their order.
    pub fn add(&mut self, run: usize, weight: f64) {
        match self.per_run.last_mut() {
            Some((last, sum)) if *last as usize == run => *sum += weight,
            _ => self.per_run.push((run as u32, weight)),
        }
        self.squares += weight * weight;
        self.greatest = self.greatest.max(weight);
    }

    /// Adds the events of later runs.
    pub fn append(&mut self, mut later: Self) {
        self.per_run.append(&mut later.per_run);
        self.squares += later.squares;
        self.greatest = self.greatest.max(later.greatest);
    }

    /// The sum of all weights.
    pub fn sum(&self) -> f64 {
        self.per_run.iter().map(|(_, sum)| sum).sum()
    }

    /// The sum over all runs with its interval; as [`Self::rate`] with the runs for traffic.
    pub fn interval(&self, runs: usize) -> Option<Rate> {
        self.rate(&vec![1.0 / runs as f64; runs])
    }

    /// The sum per traffic, of which this is one entry per run, with its interval: that of a rate over the runs; for a single
    /// run, or for runs that do not differ, the gamma interval of a sum of weighted Poisson counts (Fay and Feuer 1997,
    /// doi:10.1002/(SICI)1097-0258(19970415)16:7<791::AID-SIM500>3.0.CO;2-#), which is Poisson's where all weights are equal.
    pub fn rate(&self, traffic: &[f64]) -> Option<Rate> {
        let over_runs = rate(&self.per_run(traffic.len()), traffic)?;
        if over_runs.method == IntervalMethod::TOverRuns {
            return Some(over_runs);
        }
        Some(self.of_events()?.times(1.0 / traffic.iter().sum::<f64>()))
    }

    /// The sum of each run.
    pub(crate) fn per_run(&self, runs: usize) -> Vec<f64> {
        let mut sums = vec![0.0; runs];
        self.per_run.iter().for_each(|(run, sum)| sums[*run as usize] += sum);
        sums
    }

    /// The sum with the interval of independent events.
    fn of_events(&self) -> Option<Rate> {
        let value = self.sum();
        let chi_squared_half = |events: f64, tail: f64| Some(Gamma::new(events, 1.0).ok()?.inverse_cdf(tail));
        let low = if value > 0.0 {
            let scale = self.squares / value;
            scale * chi_squared_half(value / scale, TAIL)?
        } else {
            0.0
        };
        let (more, more_squares) = (value + self.greatest, self.squares + self.greatest.powi(2));
        let high = if more > 0.0 {
            let scale = more_squares / more;
            scale * chi_squared_half(more / scale, 1.0 - TAIL)?
        } else {
            0.0
        };
        Some(Rate { value, low, high, method: IntervalMethod::WeightedEvents })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::rate::poisson_interval;

    fn near(found: f64, wanted: f64) {
        assert!((found - wanted).abs() < 1e-9, "{found}, not {wanted}");
    }

    #[test]
    fn equal_weights_give_poissons_interval() {
        let mut events = WeightedEvents::default();
        (0..7).for_each(|_| events.add(0, 0.5));
        let found = events.interval(1).unwrap();
        let (low, high) = poisson_interval(7.0).unwrap();
        near(found.value, 3.5);
        near(found.low, 0.5 * low);
        near(found.high, 0.5 * high);
    }

    #[test]
    fn equal_runs_get_the_interval_of_their_events() {
        let mut events = WeightedEvents::default();
        (0..4).for_each(|run| events.add(run, 1.0));
        let found = events.interval(4).unwrap();
        let (low, high) = poisson_interval(4.0).unwrap();
        assert_eq!((found.value, found.method), (4.0, IntervalMethod::WeightedEvents));
        near(found.low, low);
        near(found.high, high);
        let none = WeightedEvents::default().interval(4).unwrap();
        assert_eq!((none.value, none.low, none.high), (0.0, 0.0, 0.0));
    }

    #[test]
    fn a_rate_is_the_ratio_estimator() {
        let mut events = WeightedEvents::default();
        [(0, 0.5), (1, 1.0), (2, 0.9)].into_iter().for_each(|(run, weight)| events.add(run, weight));
        let traffic = [1.0, 2.0, 1.5];
        assert_eq!(events.rate(&traffic), rate(&[0.5, 1.0, 0.9], &traffic));
        assert_eq!(events.rate(&[0.0; 3]), None);
    }

    #[test]
    fn weights_of_several_runs_get_the_interval_of_their_sums() {
        let mut events = WeightedEvents::default();
        [(0, 0.5), (0, 0.5), (2, 0.7)].into_iter().for_each(|(run, weight)| events.add(run, weight));
        let found = events.interval(3).unwrap();
        assert_eq!(found.method, IntervalMethod::TOverRuns);
        near(found.value, 1.7);
        assert!(found.low == 0.0 && found.high > 3.0, "{found:?}");
    }
}
