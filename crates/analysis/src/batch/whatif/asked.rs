//! What is asked: whose error it is, which one, and from when on.

use clap::ValueEnum;
use strum::IntoStaticStr;

use closecall::util::units::{Probability, Second};
use closecall_run::run::roll_out::DriverError;
use closecall_run::util::decimal::Written;

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
#[derive(Clone, Debug)]
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
            "{} roll-outs of {} s each, error: {}, whose: {}, from: {}, draws: {}",
            self.roll_outs,
            Written(self.horizon),
            <&str>::from(self.error),
            <&str>::from(self.whose),
            <&str>::from(self.from),
            <&str>::from(self.draws)
        )
    }

    /// The driver of a conflict's roll-out; the same numbers give the same driver.
    pub(super) fn draw(&self, conflict: u64, number: u32) -> DrawnDriver {
        let mut random = fastrand::Rng::with_seed(u64::from(self.seed) << 32 | u64::from(number));
        let mut random = fastrand::Rng::with_seed(random.u64(..) ^ conflict);
        let [response, deceleration, side] = std::array::from_fn(|_| random.f64());
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

    #[test]
    fn the_same_numbers_draw_the_same_driver() {
        let asked = Asked {
            roll_outs: 0,
            horizon: 8.0,
            error: DriverError::Late,
            whose: Whose::Drawn,
            from: Onset::Open,
            draws: Draws::Same,
            seed: 1,
        };
        assert_eq!(asked.draw(7, 3), asked.draw(7, 3));
        let all = (0..1000).map(|number| asked.draw(7, number)).collect::<Vec<_>>();
        assert!(all.iter().filter(|drawn| drawn.is_foe).count().abs_diff(500) < 80);
        let mean = all.iter().map(|drawn| drawn.response).sum::<f64>() / 1000.0;
        assert!((mean - 0.5).abs() < 0.05, "{mean}");
        assert_ne!(asked.draw(7, 3), asked.draw(8, 3));
        assert_ne!(asked.draw(7, 3), Asked { seed: 2, ..asked }.draw(7, 3));
    }
}
