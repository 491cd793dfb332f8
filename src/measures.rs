//! Surrogate safety measures of a pair in one step: DRAC, ΔV, severity. TTC is in [`crate::approach`], PET in
//! [`crate::conflict`].

use crate::encounter::Severity;
use crate::options::Options;
use crate::units::{Kilogram, Metre, MetrePerSecond, MetrePerSecondSquared, Radian, Second};

/// How bad a conflict is, from what is known of it in one step.
pub fn severity(
    ttc: Option<Second>,
    drac: Option<MetrePerSecondSquared>,
    ego_deceleration: MetrePerSecondSquared,
    collision: bool,
    options: &Options,
) -> Severity {
    if collision || drac.is_some_and(|drac| drac > ego_deceleration) {
        Severity::Critical
    } else if ttc.is_some_and(|ttc| ttc < options.serious_ttc) || drac.is_some_and(|drac| drac > options.serious_drac) {
        Severity::Serious
    } else {
        Severity::Caution
    }
}

/// DRAC in m/s² towards a foe on the ego's own line, which leads or drives up: what brings the relative speed to 0
/// within the room between the two, (V − σ Vi)² / (2 room); none where that room does not shrink.
pub fn drac_in_line(closing: MetrePerSecond, room: Metre) -> Option<MetrePerSecondSquared> {
    (closing > 0.0 && room > 0.0).then(|| closing * closing / (2.0 * room))
}

/// DRAC in m/s² towards a foe that crosses or merges at `way` m ahead of the ego and keeps its speed: the least
/// constant deceleration with which the ego comes there only when the foe has left (`foe_way` m of way later), or
/// stands before it; none where the ego comes later anyway.
pub fn drac_across(
    speed: MetrePerSecond,
    way: Metre,
    foe_speed: MetrePerSecond,
    foe_way: Metre,
) -> Option<MetrePerSecondSquared> {
    let to_stand = speed * speed / (2.0 * way);
    let time = foe_way / foe_speed;
    let to_wait = 2.0 * (speed - way / time) / time;
    // A foe that stands never leaves; an ego that would stand before the time is up only has to stand.
    let needed = if !time.is_finite() || to_wait * time > speed { to_stand } else { to_wait };
    (needed > 0.0 && needed.is_finite()).then_some(needed)
}

/// ΔV in m/s: how much the ego's velocity changes in a fully inelastic collision of both masses, at the speeds of now
/// and the angle α of the meeting place.
///
/// ```
/// use closecall::measures::delta_v;
/// assert_eq!(delta_v((20.0, 1500.0), (10.0, 1500.0), 0.0), 5.0);
/// assert_eq!(delta_v((20.0, 1500.0), (10.0, 1500.0), std::f64::consts::PI), 15.0);
/// ```
pub fn delta_v(ego: (MetrePerSecond, Kilogram), foe: (MetrePerSecond, Kilogram), angle: Radian) -> MetrePerSecond {
    let along = ego.0 - foe.0 * angle.cos();
    let across = foe.0 * angle.sin();
    along.hypot(across) / (1.0 + ego.1 / foe.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_follower_brakes_away_the_difference_of_the_speeds() {
        assert_eq!(drac_in_line(10.0, 25.0), Some(2.0));
        assert_eq!(drac_in_line(-1.0, 25.0), None);
    }

    #[test]
    fn who_waits_for_one_that_crosses_brakes_less_than_who_stops() {
        // 20 m/s, 40 m to go; the foe is out after 3 s: 40 = 20·3 − d·9/2.
        let waiting = drac_across(20.0, 40.0, 10.0, 30.0).unwrap();
        assert!((waiting - 40.0 / 9.0).abs() < 1e-12);
        assert_eq!(drac_across(20.0, 40.0, 0.0, 30.0), Some(5.0));
        assert_eq!(drac_across(20.0, 40.0, 10.0, 15.0), None);
    }

    #[test]
    fn a_wall_takes_all_of_the_speed() {
        assert_eq!(delta_v((13.0, 1500.0), (0.0, f64::MAX), std::f64::consts::PI), 13.0);
    }
}
