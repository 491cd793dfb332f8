//! What is asked: whose error it is, which one, and from when on; and the drivers that are drawn for it.

use clap::ValueEnum;
use strum::IntoStaticStr;

use closecall::util::units::{Probability, Second};
use closecall_run::run::roll_out::DriverError;
use closecall_run::util::decimal::Written;

/// What is added to response, deceleration and side from one roll-out to the next: 1/φ, 1/φ², 1/φ³ with φ⁴ = φ + 1.
const STRIDES: [Probability; 3] = [0.819_172_513_396_164_5, 0.671_043_606_703_789_3, 0.549_700_477_901_970_3];

/// Whose error it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum, IntoStaticStr)]
#[strum(serialize_all = "kebab-case")]
pub enum Whose {
    /// The ego's; the foe's where the ego is a person.
    #[default]
    Ego,
    /// The foe's; the ego's where the foe is a person.
    Foe,
    /// Either's, drawn for each roll-out.
    Drawn,
}

/// When the driver would have to respond.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum, IntoStaticStr)]
#[strum(serialize_all = "kebab-case")]
pub enum Onset {
    /// When the conflict opens.
    #[default]
    Open,
    /// When its crash probability is highest in the baseline.
    Worst,
}

/// What SUMO draws at random in a roll-out: dawdling, speeds of those that enter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum, IntoStaticStr)]
#[strum(serialize_all = "kebab-case")]
pub enum Draws {
    /// What it drew in the run: only the driver differs.
    #[default]
    Same,
    /// Others in each roll-out, so that the conflict itself may not come about.
    New,
}

/// What is asked about each conflict.
#[derive(Clone, Debug, Default)]
pub struct Asked {
    /// The number of roll-outs.
    pub roll_outs: u32,
    /// How long a roll-out goes on after the conflict opened, in s.
    pub horizon: Second,
    /// What the driver does wrong.
    pub error: DriverError,
    /// Whose error it is.
    pub whose: Whose,
    /// From when on.
    pub from: Onset,
    /// What SUMO draws.
    pub draws: Draws,
    /// Whether each roll-out is simulated from the run's beginning instead of from a state.
    pub is_exact: bool,
    /// The first seed: others give other roll-outs.
    pub seed: u32,
}

/// A driver, drawn for a roll-out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DrawnDriver {
    /// The share of drivers that respond sooner.
    pub response: Probability,
    /// The share of drivers whose vehicles brake more weakly.
    pub deceleration: Probability,
    /// Whether the error is the foe's.
    pub is_foe: bool,
}

impl Asked {
    /// In a line.
    pub fn in_words(&self) -> String {
        format!(
            "{} roll-outs of {} s each, error: {}, whose: {}, from: {}, draws: {}{}",
            self.roll_outs,
            Written(self.horizon),
            <&str>::from(self.error),
            <&str>::from(self.whose),
            <&str>::from(self.from),
            <&str>::from(self.draws),
            if self.is_exact { ", each simulated from the run's beginning" } else { "" }
        )
    }

    /// The driver of a conflict's roll-out in the run with this seed; the same numbers give the same driver.
    ///
    /// Roll-out n has the point frac(u + n α), with the u of its conflict drawn at random and α the [`STRIDES`]: the Kronecker
    /// sequence R3 of Roberts (2018, The unreasonable effectiveness of quasirandom sequences). Each point alone is uniform, and
    /// the first n are spread more evenly than n independent ones, for each n.
    pub(super) fn draw(&self, run_seed: u32, conflict: u64, number: u32) -> DrawnDriver {
        let mut random = fastrand::Rng::with_seed(u64::from(self.seed) << 32 | u64::from(run_seed));
        let mut random = fastrand::Rng::with_seed(random.u64(..) ^ conflict);
        let [response, deceleration, side] = STRIDES.map(|stride| (random.f64() + f64::from(number) * stride).fract());
        let is_foe = match self.whose {
            Whose::Ego => false,
            Whose::Foe => true,
            Whose::Drawn => side < 0.5,
        };
        DrawnDriver { response, deceleration, is_foe }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draw(run_seed: u32, conflict: u64, number: u32) -> DrawnDriver {
        Asked { whose: Whose::Drawn, seed: 1, ..Asked::default() }.draw(run_seed, conflict, number)
    }

    #[test]
    fn the_same_numbers_draw_the_same_driver() {
        assert_eq!(draw(1, 7, 3), draw(1, 7, 3));
        let other_seed = Asked { whose: Whose::Drawn, seed: 2, ..Asked::default() };
        let others = [draw(2, 7, 3), draw(1, 8, 3), draw(1, 7, 4), other_seed.draw(1, 7, 3)];
        assert!(others.iter().all(|other| *other != draw(1, 7, 3)));
    }

    #[test]
    fn each_roll_out_alone_draws_any_driver_alike() {
        for number in [0, 4, 99] {
            let drawn = (0..1000).map(|conflict| draw(1, conflict, number)).collect::<Vec<_>>();
            assert!(drawn.iter().filter(|drawn| drawn.is_foe).count().abs_diff(500) < 80);
            for value in [|drawn: &DrawnDriver| drawn.response, |drawn: &DrawnDriver| drawn.deceleration] {
                let mean = drawn.iter().map(value).sum::<f64>() / 1000.0;
                assert!((mean - 0.5).abs() < 0.05, "{mean}");
            }
        }
    }

    #[test]
    fn a_prefix_is_more_even_than_independent_draws() {
        // Late and weak drivers: a triangle with an area of 0.32.
        let is_hit = |drawn: &DrawnDriver| drawn.response - drawn.deceleration > 0.2;
        for (count, times) in [(10, 1.2), (30, 1.3), (100, 2.0), (1000, 2.5)] {
            let squares = (0..200).map(|conflict| {
                let hits = (0..count).filter(|number| is_hit(&draw(1, conflict, *number))).count();
                (hits as f64 / f64::from(count) - 0.32).powi(2)
            });
            let error = (squares.sum::<f64>() / 200.0).sqrt();
            let independent = (0.32 * 0.68 / f64::from(count)).sqrt();
            assert!(error * times < independent, "{count} draws: {error}, independent ones {independent}");
        }
    }
}
