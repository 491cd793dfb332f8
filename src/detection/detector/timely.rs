//! The measures that follow from the courses of a pair: TTC, DRAC, TTB, and what the crash probability follows from.

use super::chances::{Chance, Chances};
use crate::braking::LateBraking;
use crate::detection::measures::accident::BRAKES;
use crate::detection::measures::table::LoggedMeasure::{Drac, Ttb, Ttc};
use crate::detection::measures::table::LoggedValues;
use crate::detection::measures::ttb::Evasion;
use crate::traffic::roster::{ProfileIndex, Roster};
use crate::util::units::{Metre, MetrePerSecondSquared, Second};

/// The values of a pair, and its chance of a crash if the foe goes on as now.
#[derive(Clone, Copy)]
pub(super) struct Timely {
    pub values: LoggedValues,
    pub chance: Chance,
}

impl Timely {
    /// Of a pair that would never touch.
    pub const APART: Self = Self { values: LoggedValues::NONE, chance: Chance::Known(0.0) };

    /// Of a pair that collides now.
    pub fn of_collision() -> Self {
        let values = LoggedValues::NONE.with(Ttc, Some(0.0)).with(Ttb, Some(0.0));
        Self { values, chance: Chance::Known(1.0) }
    }

    /// Of a pair that would touch, or not, at its present speeds. The DRAC is infinite where no deceleration avoids contact.
    pub fn of_course(ttc: Option<Second>, drac: Option<MetrePerSecondSquared>) -> Self {
        Self { values: LoggedValues::NONE.with(Ttc, ttc).with(Drac, drac), ..Self::APART }
    }

    /// With what follows from the evasion that is left, of the one of both that has to brake.
    pub fn with(
        self,
        evasion: &Evasion<&[(Second, Metre)]>,
        braking: LateBraking,
        driver: ProfileIndex,
        chances: &mut Chances,
    ) -> Self {
        let wait = evasion.longest_wait(&braking);
        if wait == f64::INFINITY {
            return self;
        }
        let (evasion, has_responded) = (chances.keep(evasion), braking.present >= BRAKES);
        let chance = Chance::Of { driver, braking, evasion, has_responded };
        Self { values: self.values.with(Ttb, Some(wait.max(0.0))), chance }
    }

    /// The worst of each value.
    pub fn worse(mut self, other: &Self, chances: &Chances, roster: &Roster) -> Self {
        self.values.take_all(&other.values);
        let [one, other] = [&self.chance, &other.chance].map(|chance| chances.value(chance, roster));
        Self { chance: Chance::Known(one.max(other)), ..self }
    }
}
