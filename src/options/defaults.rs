//! The defaults of the options, with their units and sources.

use std::f64::consts::FRAC_PI_6;

use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Radian, Second};

/// Default of the driver's response time t1, in s (Guan et al. 2008, fig. 4).
pub(super) const RESPONSE_TIME: Second = 0.8;
/// Default of the brake coordination time t2 of hydraulic brakes, in s (the paper's lower bound).
pub(super) const HYDRAULIC_DELAY: Second = 0.25;
/// Default of the brake coordination time t2 of pneumatic brakes, in s (the paper's lower bound).
pub(super) const PNEUMATIC_DELAY: Second = 0.35;
/// Default of the build-up time t3, in s.
pub const BUILD_UP: Second = 0.1;
/// Default of the reserve ε of μ, in m (eq. 21).
pub const EPSILON: Metre = 0.5;
/// Default overlap up to which two road users touch but do not collide, in m: SUMO draws lanes up to this much too near
/// each other (docs/model.md has the figures).
pub(super) const CONTACT_TOLERANCE: Metre = 0.25;
/// Default bound of rear-end conflicts: 30°, in rad.
pub(super) const REAR_END_BELOW: Radian = FRAC_PI_6;
/// Default bound of frontal conflicts: 150°, in rad.
pub(super) const FRONTAL_ABOVE: Radian = 5.0 * FRAC_PI_6;
/// Default crash probability from which a conflict is serious: a driver more likely brakes too late than not.
pub(super) const SERIOUS_PROBABILITY: f64 = 0.5;
/// Default ΔV from which a conflict is serious, in m/s: 10 km/h (docs/validation.md has the figures).
pub(super) const SERIOUS_DELTA_V: MetrePerSecond = 10.0 / 3.6;
/// Default TTC below which a conflict is serious, in s (FHWA-HRT-08-051).
pub(super) const SERIOUS_TTC: Second = 1.5;
/// Default DRAC above which a conflict is serious, in m/s² (Archer 2005).
pub(super) const SERIOUS_DRAC: MetrePerSecondSquared = 3.4;
/// Default of t1 + t2 with hydraulic brakes, in s.
pub const RESPONSE: Second = RESPONSE_TIME + HYDRAULIC_DELAY;
