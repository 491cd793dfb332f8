//! The driver of a type of road users: how its response time and the deceleration that it reaches are distributed.

use std::f64::consts::{SQRT_2, TAU};
use std::sync::Arc;

use crate::braking::LateBraking;
use crate::options::{DriverModel, DriverOptions};
use crate::util::units::{MetrePerSecondSquared, Probability, Second};

/// Nodes of the quadrature on a range.
const COUNT: usize = 16;
/// The upper half of the nodes in −1 to 1 and weights of the Gauss–Legendre quadrature with 16 nodes (Abramowitz and Stegun
/// 1964, table 25.4), ascending; the lower ones are their negatives.
const NODES: [(f64, f64); COUNT / 2] = [
    (0.095_012_509_837_637_44, 0.189_450_610_455_068_5),
    (0.281_603_550_779_258_9, 0.182_603_415_044_923_6),
    (0.458_016_777_657_227_4, 0.169_156_519_395_002_5),
    (0.617_876_244_402_643_8, 0.149_595_988_816_576_7),
    (0.755_404_408_355_003, 0.124_628_971_255_533_9),
    (0.865_631_202_387_831_7, 0.095_158_511_682_492_8),
    (0.944_575_023_073_232_6, 0.062_253_523_938_647_9),
    (0.989_400_934_991_649_9, 0.027_152_459_411_754_1),
];

/// Response times with a logarithm further from its mean, in standard deviations, are left out: 6e-7 of all.
const FAR_RESPONSE: f64 = 5.0;
/// Decelerations further from their mean, in standard deviations, are left out: 6e-7 of all.
const FAR_DECELERATION: f64 = 5.0;

/// A deceleration and its weight.
pub(crate) type Weighted = (MetrePerSecondSquared, f64);

/// The distributions of a driver's response time (lognormal) and of its largest deceleration (normal, truncated).
#[derive(Clone, Debug, PartialEq)]
pub struct Driver {
    /// Mean and standard deviation of the response time's logarithm.
    response: [f64; 2],
    /// The times before and after which it hardly ever responds.
    responses: [Second; 2],
    /// Mean and standard deviation of the largest deceleration before it is cut, and the least and the largest value.
    braking: [MetrePerSecondSquared; 4],
    /// Decelerations and their weights, whose sum is 1, ascending.
    decelerations: Arc<[Weighted]>,
    /// The time in which its deceleration builds up; none if that is a matter of the vehicle's brakes.
    build_up: Option<Second>,
}

impl Driver {
    /// The driver of a model. `general` changes its values, and `of_type` those of a type. What is not of the type is scaled by
    /// `brakes`, its braking deceleration relative to a passenger car's.
    pub fn new(model: DriverModel, general: &DriverOptions, of_type: &DriverOptions, brakes: f64) -> Self {
        let preset = model.values();
        let value =
            |of: fn(&DriverOptions) -> Option<f64>| of(of_type).or(of(general)).or(of(&preset)).unwrap_or_default();
        let braking = |of: fn(&DriverOptions) -> Option<f64>| {
            of(of_type).unwrap_or_else(|| brakes * of(general).or(of(&preset)).unwrap_or_default())
        };
        let (mean, deviation) = (value(|of| of.response_mean), value(|of| of.response_sd));
        // A lognormal distribution from its own mean and standard deviation.
        let spread = if deviation > 0.0 { (deviation / mean).powi(2).ln_1p() } else { 0.0 };
        let braking = [
            braking(|of| of.deceleration_mean),
            braking(|of| of.deceleration_sd),
            braking(|of| of.deceleration_min),
            braking(|of| of.deceleration_max),
        ];
        let build_up = of_type.build_up.or(general.build_up).or(preset.build_up);
        Self { build_up, ..Self::of([mean.ln() - spread / 2.0, spread.sqrt()], braking) }
    }

    /// Stops within a known time at a known deceleration: a person on foot.
    pub fn certain(response: Second, deceleration: MetrePerSecondSquared) -> Self {
        Self::of([response.ln(), 0.0], [deceleration, 0.0, deceleration, deceleration])
    }

    fn of(response: [f64; 2], [mean, deviation, least, most]: [MetrePerSecondSquared; 4]) -> Self {
        let [centre, spread] = response;
        let responses = [-FAR_RESPONSE, FAR_RESPONSE].map(|deviations| (centre + deviations * spread).exp());
        let far = FAR_DECELERATION * deviation;
        let [low, high] = [least.max(mean - far), most.min(mean + far)];
        if low >= high {
            // Always the same, or so far in a tail of the distribution that its end says all.
            let only = if least < most { mean.clamp(least, most) } else { mean };
            let decelerations = Arc::new([(only, 1.0)]);
            return Self { response, responses, braking: [only, 0.0, only, only], decelerations, build_up: None };
        }
        let braking = [mean, deviation, low, high];
        let values = weighted(mean, deviation, [low, high]);
        let sum = values.iter().map(|(_, weight)| weight).sum::<f64>();
        let decelerations = values.iter().map(|(value, weight)| (*value, weight / sum)).collect();
        Self { response, responses, braking, decelerations, build_up: None }
    }

    /// The probability that it responds later than this.
    pub fn responds_later_than(&self, time: Second) -> f64 {
        if time <= 0.0 {
            return 1.0;
        }
        let [mean, deviation] = self.response;
        let above = time.ln() - mean;
        if deviation > 0.0 { libm::erfc(above / (deviation * SQRT_2)) / 2.0 } else { f64::from(above < 0.0) }
    }

    /// The time within which this share of such drivers has responded.
    pub fn response_within(&self, share: Probability) -> Second {
        let [soonest, latest] = self.responses;
        if self.is_punctual() {
            self.response[0].exp()
        } else {
            quantile([soonest, latest], |time| 1.0 - self.responds_later_than(time) < share)
        }
    }

    /// The deceleration that this share of their vehicles does not reach.
    pub fn deceleration_of(&self, share: Probability) -> MetrePerSecondSquared {
        let [least, most] = self.reach();
        if least < most {
            quantile([least, most], |deceleration| self.reaches([least, deceleration]) < share)
        } else {
            least
        }
    }

    /// The probability that its vehicle brakes too weakly, if `is_too_weak` is true up to some deceleration.
    pub(crate) fn brakes_too_weakly(&self, is_too_weak: impl Fn(MetrePerSecondSquared) -> bool) -> f64 {
        /// The deceleration is then right to a millionth of the range.
        const HALVINGS: u32 = 20;
        let [least, most] = self.reach();
        if !is_too_weak(least) {
            return 0.0;
        }
        if is_too_weak(most) {
            return 1.0;
        }
        self.reaches([least, halved([least, most], HALVINGS, is_too_weak)])
    }

    /// The time in which its deceleration builds up; none if that is a matter of the vehicle's brakes.
    pub fn build_up(&self) -> Option<Second> {
        self.build_up
    }

    /// How it brakes with a deceleration, in a vehicle that brakes like this.
    pub(crate) fn braking_with(&self, deceleration: MetrePerSecondSquared, of_vehicle: &LateBraking) -> LateBraking {
        LateBraking { deceleration, build_up: self.build_up.unwrap_or(of_vehicle.build_up), ..*of_vehicle }
    }

    /// Whether it always responds after the same time.
    pub(crate) fn is_punctual(&self) -> bool {
        self.response[1] <= 0.0
    }

    /// The times before and after which it hardly ever responds.
    pub fn responses(&self) -> [Second; 2] {
        self.responses
    }

    /// The least and the largest deceleration that its vehicle may reach.
    pub fn reach(&self) -> [MetrePerSecondSquared; 2] {
        [self.braking[2], self.braking[3]]
    }

    /// The decelerations that stand for the distribution, ascending, with their weights.
    pub fn decelerations(&self) -> &[Weighted] {
        &self.decelerations
    }

    /// Decelerations that stand for a part of the distribution, ascending; the sum of their weights is the part's share.
    pub(crate) fn decelerations_between(&self, part: [MetrePerSecondSquared; 2]) -> [Weighted; COUNT] {
        let [mean, deviation, ..] = self.braking;
        let scale = (deviation * TAU.sqrt() * self.within_reach()).recip();
        weighted(mean, deviation, part).map(|(value, weight)| (value, scale * weight))
    }

    /// The probability that its vehicle reaches a deceleration in a range.
    pub fn reaches(&self, [low, high]: [MetrePerSecondSquared; 2]) -> f64 {
        (self.below(high) - self.below(low)) / self.within_reach()
    }

    /// The share of the distribution that is not cut off.
    fn within_reach(&self) -> f64 {
        self.below(self.braking[3]) - self.below(self.braking[2])
    }

    /// The normal distribution of the deceleration before it is cut.
    fn below(&self, value: MetrePerSecondSquared) -> f64 {
        let [mean, deviation, ..] = self.braking;
        libm::erfc((mean - value) / (deviation * SQRT_2)) / 2.0
    }
}

/// The value in a range up to which `is_below` is true, to the last digit.
fn quantile(range: [f64; 2], is_below: impl Fn(f64) -> bool) -> f64 {
    halved(range, f64::MANTISSA_DIGITS, is_below)
}

/// The same after this number of halvings.
fn halved([mut low, mut high]: [f64; 2], halvings: u32, is_below: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..halvings {
        let middle = f64::midpoint(low, high);
        *(if is_below(middle) { &mut low } else { &mut high }) = middle;
    }
    f64::midpoint(low, high)
}

/// Gauss–Legendre nodes on a range, ascending, weighted with exp(−((a − mean) / deviation)² / 2).
fn weighted(mean: f64, deviation: f64, [low, high]: [MetrePerSecondSquared; 2]) -> [Weighted; COUNT] {
    std::array::from_fn(|index| {
        let (node, weight) = match index.checked_sub(COUNT / 2) {
            Some(upper) => NODES[upper],
            None => (-NODES[COUNT / 2 - 1 - index].0, NODES[COUNT / 2 - 1 - index].1),
        };
        let half = (high - low) / 2.0;
        let value = low + half * (1.0 + node);
        (value, half * weight * (-((value - mean) / deviation).powi(2) / 2.0).exp())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_response_of_an_attentive_driver_is_early_to_half_of_them() {
        let driver = Driver::new(DriverModel::Attentive, &DriverOptions::default(), &DriverOptions::default(), 1.0);
        // Of a lognormal distribution, the median is mean²/√(mean² + SD²).
        let median = 0.92 * 0.92 / 0.92_f64.hypot(0.28);
        assert!((driver.responds_later_than(median) - 0.5).abs() < 1e-12);
        assert_eq!(driver.responds_later_than(-1.0), 1.0);
        assert_eq!(driver.responds_later_than(f64::INFINITY), 0.0);
    }

    #[test]
    fn quantiles_invert_the_distributions() {
        let none = DriverOptions::default();
        let driver = Driver::new(DriverModel::Distracted, &none, &none, 0.8);
        for share in [0.001, 0.1, 0.5, 0.9, 0.999] {
            assert!((1.0 - driver.responds_later_than(driver.response_within(share)) - share).abs() < 1e-9);
            assert!((driver.reaches([driver.reach()[0], driver.deceleration_of(share)]) - share).abs() < 1e-9);
        }
        let fixed = Driver::new(DriverModel::Automated, &none, &none, 1.0);
        assert_eq!((fixed.response_within(0.9), fixed.deceleration_of(0.1)), (0.35_f64.ln().exp(), 6.0));
    }

    #[test]
    fn a_fixed_response_is_late_or_not() {
        let driver = Driver::new(DriverModel::Competent, &DriverOptions::default(), &DriverOptions::default(), 1.0);
        assert_eq!([1.14, 1.16].map(|time| driver.responds_later_than(time)), [1.0, 0.0]);
        assert_eq!(driver.decelerations(), [(0.774 * 9.806_65, 1.0)]);
    }

    #[test]
    fn a_drivers_own_build_up_counts_before_the_vehicles() {
        let vehicle = LateBraking { speed: 20.0, present: 0.0, build_up: 0.1, deceleration: 9.0 };
        let none = DriverOptions::default();
        let set = DriverOptions { build_up: Some(0.3), ..none.clone() };
        let build_up = |model, general: &DriverOptions, of_type: &DriverOptions| {
            Driver::new(model, general, of_type, 1.0).braking_with(7.0, &vehicle).build_up
        };
        assert_eq!(build_up(DriverModel::Attentive, &none, &none), 0.1);
        assert_eq!(build_up(DriverModel::Automated, &none, &none), 0.0);
        assert!((build_up(DriverModel::Competent, &none, &none) - 0.6).abs() < 1e-3, "0.774 g at 12.65 m/s³");
        assert_eq!(build_up(DriverModel::Competent, &set, &none), 0.3);
        assert_eq!(build_up(DriverModel::Competent, &none, &set), 0.3);
    }

    /// The reference model of UN R157 brakes from 20 m/s to a stand within V (t1 + t2) + V t3/2 + V²/(2a) − a t3²/24.
    #[test]
    fn the_competent_driver_stops_like_the_reference_model() {
        let none = DriverOptions::default();
        let driver = Driver::new(DriverModel::Competent, &none, &none, 1.0);
        let vehicle = LateBraking { speed: 20.0, present: 0.0, build_up: 0.1, deceleration: 9.0 };
        let (braking, step) = (driver.braking_with(0.774 * 9.806_65, &vehicle), 1e-4);
        let (mut speed, mut deceleration, mut distance) = (20.0, 0.0, 0.0);
        while speed > 0.0 {
            deceleration = f64::min(deceleration + 12.65 * step, 0.774 * 9.806_65);
            distance += speed * step;
            speed -= deceleration * step;
        }
        let wait = braking.longest_wait_at(100.0, distance + 20.0 * 1.15);
        assert!((wait - 1.15).abs() < 1e-3, "{wait}");
    }

    #[test]
    fn weaker_brakes_scale_what_is_not_set_for_the_type() {
        let mean = |driver: &Driver| driver.decelerations().iter().map(|(value, weight)| value * weight).sum::<f64>();
        let none = DriverOptions::default();
        let truck = Driver::new(DriverModel::Attentive, &none, &none, 7.0 / 9.0);
        assert!((mean(&truck) - 8.45 * 7.0 / 9.0).abs() < 1e-2, "{}", mean(&truck));
        let set = DriverOptions { deceleration_mean: Some(5.0), deceleration_sd: Some(0.0), ..none.clone() };
        assert_eq!(mean(&Driver::new(DriverModel::Attentive, &none, &set, 7.0 / 9.0)), 5.0);
    }
}
