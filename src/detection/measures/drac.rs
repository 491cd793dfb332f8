//! DRAC: the least deceleration with which the ego avoids contact with a foe that keeps its speed.

use super::drac_straight::{straight, to_stay_behind};
use super::ttc::{HORIZON, SteadyMotion};
use crate::geometry::bisection::Bisection;
use crate::geometry::rectangle::Rectangle;
use crate::geometry::separating_axes::Contact;
use crate::geometry::sweep::TOLERANCE;
use crate::util::golden_section::golden_section;
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Second};

/// Number of times at which the needed deceleration is sampled before the contact.
const BEFORE: i32 = 6;
/// Number of times at which it is sampled after the contact.
const AFTER: i32 = 14;

/// Steps of the golden-section search about the largest sample. Each leaves 0.62 of the interval: 1 s becomes 1 ms.
const SEARCH_STEPS: u32 = 14;

/// DRAC in m/s² towards a foe on the ego's own line that keeps its speed, be it a leader or an oncoming vehicle: the
/// deceleration that brings the relative speed to 0 within the room between both, closing² / (2 room), where
/// room = closing · TTC. None if both touch now.
pub fn drac_in_line(closing: MetrePerSecond, ttc: Second) -> Option<MetrePerSecondSquared> {
    (closing > 0.0 && ttc > 0.0).then(|| closing / (2.0 * ttc)).filter(|drac| drac.is_finite())
}

/// DRAC in m/s² towards any other foe: the least constant deceleration with which the ego, at every time until the foe
/// has left, stays behind the place where the foe blocks its path. Infinite if the foe comes to where the ego is now:
/// no deceleration avoids that.
///
/// Both follow their poses. If both keep their speeds, they touch after `ttc`, in s.
pub fn drac(bisection: &mut Bisection, ego: &SteadyMotion, foe: &SteadyMotion, ttc: Second) -> MetrePerSecondSquared {
    if let (Some((of_ego, by)), Some((of_foe, foe_by))) = (ego.straight(), foe.straight()) {
        return straight((&of_ego, by / HORIZON), (&of_foe, foe_by / HORIZON));
    }
    by_search(bisection, ego, foe, ttc)
}

/// [`drac`] if one of the two turns: sampled at several times, then searched about the largest sample.
fn by_search(bisection: &mut Bisection, ego: &SteadyMotion, foe: &SteadyMotion, ttc: Second) -> MetrePerSecondSquared {
    bisection.clear();
    let mut needed =
        |time| to_stay_behind(ego.speed, time, contact_distance(bisection, ego, &foe.at(time), ego.speed * time));
    // Braking to a stand, or to the leader's speed, takes twice as long as to the contact. The samples are dense about
    // the contact, because a foe that crosses may block the path only briefly.
    let time = |number: i32| {
        let part = f64::from(number) / f64::from(if number < 0 { BEFORE } else { AFTER });
        if number < 0 { ttc * (1.0 - part * part) } else { ttc + (2.0 * HORIZON - ttc) * part.powi(3) }
    };
    let mut at = 0;
    let mut most = 0.0;
    // The time of the contact itself is left out: there rounding would decide.
    for number in (1 - BEFORE..0).chain(1..=AFTER) {
        let now = needed(time(number));
        if now == 0.0 && most > 0.0 && number > 0 {
            break;
        }
        if now > most {
            (at, most) = (number, now);
        }
    }
    if most.is_finite() { search_maximum(needed, time(at - 1), time(AFTER.min(at + 1)), most) } else { most }
}

/// The largest value between two times, at least `most`: the needed deceleration has one maximum there, or drops to 0 when
/// the foe has left.
fn search_maximum(mut needed: impl FnMut(Second) -> f64, from: Second, to: Second, most: f64) -> f64 {
    let mut largest = most;
    golden_section(
        |time| {
            let now = needed(time);
            largest = largest.max(now);
            now
        },
        from,
        to,
        SEARCH_STEPS,
    );
    largest
}

/// The distance at which the ego touches a standing rectangle; infinite if it does not within `furthest`.
fn contact_distance(bisection: &mut Bisection, ego: &SteadyMotion, fixed: &Rectangle, furthest: Metre) -> Metre {
    let bounds = fixed.bounds().grown(2.0 * TOLERANCE);
    for (number, (from, to, movement)) in ego.movements(furthest).enumerate() {
        let part = bisection.numbered(number, || movement);
        if !bisection.bounds(part).meet(&bounds) {
            continue;
        }
        if let Some(enter) = bisection.meet_rectangle((number, &movement), fixed, Contact::Entry) {
            return from + (to - from) * enter;
        }
    }
    f64::INFINITY
}

#[cfg(test)]
mod tests {
    use crate::detection::measures::drac::*;
    use crate::detection::measures::ttc::time_to_collision;
    use crate::detection::path::{Pose, arc};
    use crate::geometry::Point;
    use crate::geometry::exact::touches;
    use crate::geometry::rectangle::direction;
    use fastrand::Rng;

    /// A road user's poses and its speed.
    type Drive = (Vec<Pose>, MetrePerSecond);

    fn drive((x, y): (f64, f64), heading: f64, speed: f64, curvature: f64) -> Drive {
        let (front, axis) = (Point::new(x, y), direction(heading));
        let mut poses = vec![Pose { distance: 0.0, front, axis }];
        arc::poses(front, axis, curvature, 5.0, &[speed * HORIZON], &mut poses);
        (poses, speed)
    }

    fn motion((poses, speed): &Drive) -> SteadyMotion<'_> {
        SteadyMotion { poses, speed: *speed, length: 5.0, width: 2.0 }
    }

    /// DRAC and TTC, if both would touch.
    fn found(ego: &Drive, foe: &Drive) -> Option<(f64, f64)> {
        let (ego, foe) = (motion(ego), motion(foe));
        let ttc = time_to_collision(&ego, &foe).filter(|ttc| *ttc > 0.0)?;
        Some((drac(&mut Bisection::default(), &ego, &foe, ttc), ttc))
    }

    /// Whether an ego with this deceleration that is `further` ahead touches the foe before `until`.
    fn touch(ego: &Drive, foe: &Drive, deceleration: f64, further: Metre, until: Second) -> bool {
        let (ego, foe) = (motion(ego), motion(foe));
        let stands = ego.speed / deceleration;
        (0..=20_000).map(|number| f64::from(number) * 1e-3).take_while(|time| *time <= until).any(|time| {
            let brakes = time.min(stands);
            let distance = (ego.speed - deceleration * brakes / 2.0) * brakes + further;
            touches(&ego.at(distance.max(0.0) / ego.speed), &foe.at(time))
        })
    }

    #[test]
    fn in_line_half_the_closing_speed_over_ttc_suffices() {
        assert_eq!(drac_in_line(10.0, 2.5), Some(2.0));
    }

    #[test]
    fn a_follower_brakes_away_the_difference_of_the_speeds() {
        let (ego, leader) = (drive((0.0, 0.0), 0.0, 20.0, 0.0), drive((30.0, 0.0), 0.0, 10.0, 0.0));
        let (drac, ttc) = found(&ego, &leader).unwrap();
        assert!((drac - 2.0).abs() < 1e-6, "{drac}");
        assert_eq!(drac_in_line(10.0, ttc), Some(2.0));
    }

    #[test]
    fn a_leader_not_quite_parallel_is_still_a_leader() {
        let (ego, leader) = (drive((0.0, 0.0), 0.0, 20.0, 0.0), drive((30.0, 0.0), 0.001, 10.0, 0.0));
        let (drac, _) = found(&ego, &leader).unwrap();
        assert!((drac - 2.0).abs() < 1e-3, "{drac}");
    }

    #[test]
    fn waiting_for_a_crossing_foe_needs_less_than_stopping() {
        let ego = drive((0.0, 0.0), 0.0, 20.0, 0.0);
        // From the right, 40 m ahead: its rear has left the ego's path after 2.6 s.
        let crossing = drive((41.0, -20.0), std::f64::consts::FRAC_PI_2, 10.0, 0.0);
        let (waiting, _) = found(&ego, &crossing).unwrap();
        assert!((waiting - 2.0 * (20.0 * 2.6 - 40.0) / (2.6 * 2.6)).abs() < 1e-3, "{waiting}");
        let slow = drive((41.0, -2.0), std::f64::consts::FRAC_PI_2, 1.0, 0.0);
        let (standing, _) = found(&ego, &slow).unwrap();
        assert!((standing - 5.0).abs() < 1e-3, "{standing}");
    }

    #[test]
    fn a_standing_ego_needs_none() {
        let (ego, foe) = (drive((0.0, 0.0), 0.0, 0.0, 0.0), drive((-2.0, 20.0), -1.5, 5.0, 0.0));
        assert_eq!(found(&ego, &foe).unwrap().0, 0.0);
    }

    #[test]
    fn no_deceleration_avoids_a_foe_that_comes_to_the_ego() {
        let (ego, oncoming) = (drive((0.0, 0.0), 0.0, 20.0, 0.0), drive((60.0, 0.0), std::f64::consts::PI, 10.0, 0.0));
        assert_eq!(found(&ego, &oncoming).unwrap().0, f64::INFINITY);
    }

    /// Accuracy of DRAC, as a distance of the ego in m.
    const ACCURACY: Metre = 0.1;

    fn any_pair(chance: &mut Rng, curvature: f64) -> [Drive; 2] {
        let mut between = |low: f64, high: f64| low + (high - low) * chance.f64();
        let ego = drive((0.0, 0.0), 0.0, between(2.0, 30.0), between(-curvature, curvature));
        let (from, heading) = ((between(5.0, 80.0), between(-40.0, 40.0)), between(-3.2, 3.2));
        [ego, drive(from, heading, between(0.0, 30.0), between(-curvature, curvature))]
    }

    /// Among pairs that soon touch: for how many DRAC avoids contact and hardly less does not, and their number.
    fn right_and_all(curvature: f64) -> (u32, u32) {
        let mut chance = Rng::with_seed(1);
        let (mut right, mut all) = (0, 0);
        while all < 500 {
            let [ego, foe] = any_pair(&mut chance, curvature);
            let Some((drac, ttc)) = found(&ego, &foe).filter(|(drac, ttc)| *ttc < 5.0 && (0.5..50.0).contains(drac))
            else {
                continue;
            };
            // A road user that turns may come by twice.
            let until = if curvature == 0.0 { 2.0 * HORIZON } else { 1.2 * ttc };
            all += 1;
            right += u32::from(
                touch(&ego, &foe, drac, ACCURACY, 2.0 * HORIZON) && !touch(&ego, &foe, drac, -ACCURACY, until),
            );
        }
        (right, all)
    }

    #[test]
    fn drac_avoids_contact_and_hardly_less_does_not() {
        let (right, all) = right_and_all(0.0);
        assert_eq!(right, all);
        let (right, all) = right_and_all(0.05);
        assert!(100 * right >= 99 * all, "{right} of {all}");
    }

    #[test]
    fn the_search_finds_what_the_closed_form_says() {
        let mut chance = Rng::with_seed(2);
        let mut compared = 0;
        for [ego, foe] in (0..10_000).map(|_| any_pair(&mut chance, 0.0)) {
            // The search may miss a foe that blocks the path only briefly.
            let Some((closed, ttc)) = found(&ego, &foe).filter(|(closed, _)| *closed > 0.5) else { continue };
            let searched = by_search(&mut Bisection::default(), &motion(&ego), &motion(&foe), ttc);
            assert!(closed == searched || (closed - searched).abs() < 0.01 * closed, "{closed} and {searched}");
            compared += 1;
        }
        assert!(compared > 100, "{compared}");
    }
}
