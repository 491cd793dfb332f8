//! The drivers that crash probabilities assume.

use serde::{Deserialize, Serialize};

use crate::util::limits::{DECELERATION, DURATION, Limit};
use crate::util::units::{MetrePerSecondSquared, Second};

/// A driver: the response time and the largest deceleration of its vehicle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, strum::IntoStaticStr)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
#[non_exhaustive]
pub enum DriverModel {
    /// Attentive driver: response time 0.92 s (Triggs and Harris 1982), SD 0.28 s; deceleration 8.45 ± 1.42 m/s² within 4.23 to
    /// 12.68 (Cunto and Saccomanno 2008).
    #[default]
    Attentive,
    /// Surprised driver: response time 1.5 s (Green 2000), with the same relative SD; decelerations of the attentive driver.
    Distracted,
    /// Driver of a crash: in naturalistic crashes drivers responded 0.487 s later than in near-crashes and braked 0.018 g more
    /// weakly (Wood and Zhang 2020); else the attentive driver, with the same relative SD.
    CrashInvolved,
    /// The competent and careful driver of UN R157, annex 3: 0.4 s to evaluate the risk and 0.75 s until it brakes; 0.774 g, which
    /// 12.65 m/s³ build up in 0.6 s.
    Competent,
    /// The automated lane keeping system of UN R157, 5.2.5.2: 0.35 s, then 6 m/s² at once.
    Automated,
}

/// How fast the competent driver's deceleration rises, in m/s³.
const COMPETENT_JERK: f64 = 12.65;
/// Standard gravity.
const G: MetrePerSecondSquared = 9.806_65;

/// Values of a driver that the TOML file sets, in the table `[driver]` or `[type.NAME.driver]`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriverOptions {
    /// Mean of the response time in s, lognormal.
    pub response_mean: Option<Second>,
    /// Its standard deviation in s; 0 for a fixed time.
    pub response_sd: Option<Second>,
    /// Mean of the largest deceleration in m/s², normal before it is truncated.
    pub deceleration_mean: Option<MetrePerSecondSquared>,
    /// Its standard deviation in m/s²; 0 for a fixed deceleration.
    pub deceleration_sd: Option<MetrePerSecondSquared>,
    /// The least deceleration in m/s².
    pub deceleration_min: Option<MetrePerSecondSquared>,
    /// The largest deceleration in m/s².
    pub deceleration_max: Option<MetrePerSecondSquared>,
    /// The time in which the deceleration builds up, in s; that of the vehicle's brakes if it is not set.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub build_up: Option<Second>,
}

impl DriverModel {
    /// Its name, as in options.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// Its values, all of them.
    pub fn values(self) -> DriverOptions {
        let fixed = |response, deceleration, build_up| DriverOptions {
            response_mean: Some(response),
            response_sd: Some(0.0),
            deceleration_mean: Some(deceleration),
            deceleration_sd: Some(0.0),
            deceleration_min: Some(deceleration),
            deceleration_max: Some(deceleration),
            build_up: Some(build_up),
        };
        let attentive = DriverOptions {
            response_mean: Some(0.92),
            response_sd: Some(0.28),
            deceleration_mean: Some(8.45),
            deceleration_sd: Some(1.42),
            deceleration_min: Some(4.23),
            deceleration_max: Some(12.68),
            build_up: None,
        };
        match self {
            Self::Attentive => attentive,
            Self::Distracted => {
                DriverOptions { response_mean: Some(1.5), response_sd: Some(1.5 * 0.28 / 0.92), ..attentive }
            }
            Self::CrashInvolved => {
                let later = 0.92 + 0.487;
                DriverOptions {
                    response_mean: Some(later),
                    response_sd: Some(later * 0.28 / 0.92),
                    deceleration_mean: Some(8.45 - 0.018 * G),
                    ..attentive
                }
            }
            Self::Competent => fixed(0.4 + 0.75, 0.774 * G, 0.774 * G / COMPETENT_JERK),
            Self::Automated => fixed(0.35, 6.0, 0.0),
        }
    }
}

impl DriverOptions {
    /// Checks the values that are set.
    ///
    /// # Errors
    /// A text that names the value and what it must be.
    pub fn check(&self) -> Result<(), String> {
        let response = Limit { is_open: true, ..DURATION };
        let deviation = Limit { least: 0.0, ..DECELERATION };
        for (name, value, limit) in [
            ("response_mean", self.response_mean, &response),
            ("response_sd", self.response_sd, &DURATION),
            ("deceleration_mean", self.deceleration_mean, &DECELERATION),
            ("deceleration_sd", self.deceleration_sd, &deviation),
            ("deceleration_min", self.deceleration_min, &DECELERATION),
            ("deceleration_max", self.deceleration_max, &DECELERATION),
            ("build_up", self.build_up, &DURATION),
        ] {
            value.map_or(Ok(0.0), |value| limit.check(name, value))?;
        }
        match (self.deceleration_min, self.deceleration_max) {
            (Some(least), Some(most)) if least > most => {
                Err(format!("deceleration_min ({least}) must not be above deceleration_max ({most})"))
            }
            _ => Ok(()),
        }
    }
}
