//! The measures that follow from the courses of a pair: TTC, DRAC, TTB and the crash probability.

use crate::braking::LateBraking;
use crate::detection::measures::accident::BRAKES;
use crate::detection::measures::crash_probability::crash_probability;
use crate::detection::measures::table::LoggedMeasure::{CrashProbability, Drac, Ttb, Ttc};
use crate::detection::measures::table::LoggedValues;
use crate::detection::measures::ttb::Evasion;
use crate::traffic::driver_distributions::Driver;
use crate::util::units::{MetrePerSecondSquared, Second};

/// The values of a pair that collides now.
pub(super) fn of_collision() -> LoggedValues {
    LoggedValues::NONE.with(Ttc, Some(0.0)).with(Ttb, Some(0.0)).with(CrashProbability, Some(1.0))
}

/// The values of a pair that would touch, or not, at its present speeds. The DRAC is infinite where no deceleration avoids
/// contact.
pub(super) fn of_course(ttc: Option<Second>, drac: Option<MetrePerSecondSquared>) -> LoggedValues {
    LoggedValues::NONE.with(Ttc, ttc).with(Drac, drac)
}

/// The values with what follows from the evasion that is left, of the one of both that has to brake.
pub(super) fn with_evasion(
    values: LoggedValues,
    evasion: &Evasion,
    braking: &LateBraking,
    driver: &Driver,
) -> LoggedValues {
    let wait = evasion.longest_wait(braking);
    let ttb = Some(wait.max(0.0)).filter(|wait| wait.is_finite());
    let probability = ttb.map_or(0.0, |_| {
        let wait_with = |deceleration| evasion.longest_wait(&driver.braking_with(deceleration, braking));
        crash_probability(driver, braking.present >= BRAKES, wait_with)
    });
    values.with(Ttb, ttb).with(CrashProbability, Some(probability))
}
