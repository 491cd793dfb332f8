//! DRAC: the least constant deceleration with which contact is just avoided (the deceleration rate to avoid the crash of
//! Cooper and Ferguson 1976, along the paths of both).
//!
//! The ego brakes alone, and the foe keeps its speed. That avoids nothing where the foe comes to where the ego is now, as
//! an oncoming one does. There, and towards every frontal foe if it takes less, both brake alike: on one line the
//! stopping distances of both then just fit into the room between them,
//!
//! ```text
//! DRAC = (V² + Vᵢ²) / (2 room)
//! ```

use super::blocked_path::{PARALLEL, contact_distance, largest_need};
use super::drac_straight::{self, straight, to_stay_behind};
use super::ttc::{HORIZON, SteadyMotion, touch_while_braking};
use crate::detection::kind::Kind;
use crate::geometry::bisection::Bisection;
use crate::util::units::{MetrePerSecondSquared, Second};

/// No road user brakes harder, in m/s²: the upper end of the distribution of the maximum available deceleration rate of
/// cars (Cunto and Saccomanno 2008, Fu and Sayed 2021: 8.45 ± 1.4, from 4.23 to 12.68). A larger DRAC is cut to it.
pub(crate) const LIMIT: MetrePerSecondSquared = 12.68;

/// Halvings of [`LIMIT`] in the search for the deceleration of both: it is known to 1 mm/s².
const HALVINGS: u32 = 14;

/// DRAC in m/s² of an ego and its foe of a kind, which touch after `ttc`, in s, if both keep their speeds along their
/// poses. Infinite where no deceleration avoids contact.
pub fn drac(
    bisection: &mut Bisection,
    ego: &SteadyMotion,
    foe: &SteadyMotion,
    ttc: Second,
    kind: Kind,
) -> MetrePerSecondSquared {
    let alone = alone(bisection, ego, foe, ttc);
    if kind == Kind::Frontal || alone.is_infinite() { alone.min(together(ego, foe)) } else { alone }
}

/// The least constant deceleration with which the ego, at every time until the foe has left, stays behind the place where
/// the foe blocks its path. Infinite if the foe comes to where the ego is now.
fn alone(bisection: &mut Bisection, ego: &SteadyMotion, foe: &SteadyMotion, ttc: Second) -> MetrePerSecondSquared {
    let both = |time: Second| {
        let ((of_ego, by), (of_foe, foe_by)) = (ego.straight(time)?, foe.straight(time)?);
        Some(((of_ego, by / time), (of_foe, foe_by / time)))
    };
    if let Some((of_ego, of_foe)) = both(HORIZON) {
        return straight(of_ego, of_foe, 2.0 * HORIZON);
    }
    // A follower in line needs most after twice the time to the contact, when its speed has become the leader's.
    match both(2.0 * ttc).filter(|(of_ego, of_foe)| of_ego.0.axis.dot(&of_foe.0.axis) > 1.0 - PARALLEL) {
        Some((of_ego, of_foe)) if ttc > 0.0 => straight(of_ego, of_foe, 2.0 * ttc),
        _ => by_search(bisection, ego, foe, ttc),
    }
}

/// The least constant deceleration with which both have to brake. Infinite if [`LIMIT`] does not suffice.
fn together(ego: &SteadyMotion, foe: &SteadyMotion) -> MetrePerSecondSquared {
    let straight = ego.straight(2.0 * HORIZON).zip(foe.straight(2.0 * HORIZON));
    let velocities = straight.map(|pair| <[_; 2]>::from(pair).map(|(of, by)| (of, by / (2.0 * HORIZON))));
    let touch = |deceleration| match velocities {
        Some([ego, foe]) => drac_straight::touch_while_braking(ego, foe, deceleration, 2.0 * HORIZON),
        None => touch_while_braking(ego, foe, deceleration),
    };
    if touch(LIMIT) {
        return f64::INFINITY;
    }
    let (mut touches, mut avoids) = (0.0, LIMIT);
    for _ in 0..HALVINGS {
        let middle = (touches + avoids) / 2.0;
        if touch(middle) {
            touches = middle;
        } else {
            avoids = middle;
        }
    }
    avoids
}

/// [`alone`] if one of the two turns: sampled at several times, then searched about the largest sample.
fn by_search(bisection: &mut Bisection, ego: &SteadyMotion, foe: &SteadyMotion, ttc: Second) -> MetrePerSecondSquared {
    bisection.clear();
    let needed =
        |time| to_stay_behind(ego.speed, time, contact_distance(bisection, ego, &foe.at(time), ego.travel(time)));
    largest_need(needed, ttc)
}

#[cfg(test)]
mod tests {
    use crate::detection::measures::drac::*;
    use crate::detection::measures::ttc::time_to_collision;
    use crate::detection::path::{Pose, arc};
    use crate::geometry::Point;
    use crate::geometry::angle_between;
    use crate::geometry::exact::touches;
    use crate::geometry::rectangle::{Rectangle, direction};
    use crate::options::Options;
    use crate::util::units::{Metre, MetrePerSecond};
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
        SteadyMotion { poses, speed: *speed, deceleration: 0.0, length: 5.0, width: 2.0 }
    }

    /// DRAC towards a foe of a kind, and the TTC, if both would touch.
    fn found_of(kind: Kind, ego: &Drive, foe: &Drive) -> Option<(f64, f64)> {
        let (ego, foe) = (motion(ego), motion(foe));
        let ttc = time_to_collision(&ego, &foe).filter(|ttc| *ttc > 0.0)?;
        Some((drac(&mut Bisection::default(), &ego, &foe, ttc, kind), ttc))
    }

    fn found(ego: &Drive, foe: &Drive) -> Option<(f64, f64)> {
        found_of(Kind::Side, ego, foe)
    }

    /// Whether an ego that brakes like this and is `further` ahead touches, before `until`, a foe that brakes like that.
    fn touch(ego: &Drive, foe: &Drive, decelerations: [f64; 2], further: Metre, until: Second) -> bool {
        let pair = [motion(ego), motion(foe)];
        let distance = |motion: &SteadyMotion, deceleration: f64, time: Second| {
            let brakes = if deceleration > 0.0 { time.min(motion.speed / deceleration) } else { time };
            (motion.speed - deceleration * brakes / 2.0) * brakes
                + motion.speed * (time - brakes) * f64::from(deceleration == 0.0)
        };
        // Two of 5 m by 2 m touch only if their centres are this near.
        let are_near = |a: &Rectangle, b: &Rectangle| (a.centre - b.centre).norm() <= 5.4;
        (0..=20_000).map(|number| f64::from(number) * 1e-3).take_while(|time| *time <= until).any(|time| {
            let [ego, foe] = [0, 1].map(|one| {
                let distance = distance(&pair[one], decelerations[one], time) + if one == 0 { further } else { 0.0 };
                pair[one].at(if pair[one].speed > 0.0 { distance.max(0.0) / pair[one].speed } else { 0.0 })
            });
            are_near(&ego, &foe) && touches(&ego, &foe)
        })
    }

    #[test]
    fn a_follower_brakes_away_the_difference_of_the_speeds() {
        let (ego, leader) = (drive((0.0, 0.0), 0.0, 20.0, 0.0), drive((30.0, 0.0), 0.0, 10.0, 0.0));
        let (drac, _) = found_of(Kind::RearEnd, &ego, &leader).unwrap();
        assert!((drac - 2.0).abs() < 1e-6, "{drac}");
    }

    #[test]
    fn a_follower_that_turns_off_before_needs_less() {
        let leader = drive((30.0, 0.0), 0.0, 10.0, 0.0);
        let turns_after = |travelled: f64| {
            let at = |distance, x, y, heading| Pose { distance, front: Point::new(x, y), axis: direction(heading) };
            let around = std::f64::consts::FRAC_PI_2;
            let poses = vec![
                at(0.0, 0.0, 0.0, 0.0),
                at(travelled, travelled, 0.0, 0.0),
                at(travelled + 10.0, travelled + 6.4, 6.4, around),
                at(travelled + 210.0, travelled + 6.4, 206.4, around),
            ];
            found(&(poses, 20.0), &leader).map(|(drac, _)| drac)
        };
        // Both would touch after 2.5 s and 50 m, and be as fast after 5 s and 75 m.
        assert_eq!(turns_after(35.0), None);
        let [early, late] = [51.0, 80.0].map(|travelled| turns_after(travelled).unwrap());
        assert!(early > 0.1 && early < 1.8 && (late - 2.0).abs() < 0.05, "{early} and {late}");
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
    fn head_on_both_stopping_distances_fit_into_the_room() {
        for (speed, foe_speed, room) in [(20.0, 10.0, 60.0), (10.0, 20.0, 60.0), (14.0, 14.0, 30.0), (3.0, 0.0, 5.0)] {
            let ego = drive((0.0, 0.0), 0.0, speed, 0.0);
            let oncoming = drive((room, 0.0), std::f64::consts::PI, foe_speed, 0.0);
            let (drac, _) = found_of(Kind::Frontal, &ego, &oncoming).unwrap();
            let suffices = (speed * speed + foe_speed * foe_speed) / (2.0 * room);
            assert!((drac - suffices).abs() < 2e-3 * suffices + 2e-3, "{drac}, not {suffices}");
        }
    }

    #[test]
    fn nothing_avoids_contact_a_centimetre_ahead() {
        let (ego, oncoming) = (drive((0.0, 0.0), 0.0, 10.0, 0.0), drive((0.01, 0.0), std::f64::consts::PI, 10.0, 0.0));
        assert_eq!(found_of(Kind::Frontal, &ego, &oncoming).unwrap().0, f64::INFINITY);
        let leader = drive((5.01, 0.0), 0.0, 0.0, 0.0);
        assert!(found_of(Kind::RearEnd, &ego, &leader).unwrap().0 > LIMIT);
    }

    #[test]
    fn a_frontal_foe_that_leaves_the_path_can_be_waited_for() {
        // It crosses the ego's path 45 m ahead, after 3 s, at an angle of 163°.
        let (ego, crosses) =
            (drive((0.0, 0.0), 0.0, 14.0, 0.0), drive((67.9, -7.1), std::f64::consts::PI - 0.3, 8.0, 0.0));
        let (waiting, _) = found_of(Kind::Side, &ego, &crosses).unwrap();
        let (frontal, _) = found_of(Kind::Frontal, &ego, &crosses).unwrap();
        assert!(frontal <= waiting && waiting < 14.0 * 14.0 / (2.0 * 25.0), "{waiting} and {frontal}");
    }

    /// Accuracy of DRAC if one of the two turns, as a distance of the ego in m.
    const ACCURACY: Metre = 0.1;
    /// The same if neither does.
    const BRAKING_ACCURACY: Metre = 0.03;

    fn any_pair(chance: &mut Rng, curvature: f64) -> [Drive; 2] {
        let mut between = |low: f64, high: f64| low + (high - low) * chance.f64();
        let ego = drive((0.0, 0.0), 0.0, between(2.0, 30.0), between(-curvature, curvature));
        let (from, heading) = ((between(5.0, 80.0), between(-40.0, 40.0)), between(-3.2, 3.2));
        [ego, drive(from, heading, between(0.0, 30.0), between(-curvature, curvature))]
    }

    /// Among pairs of a kind that soon touch: for how many DRAC avoids contact, for how many 2 % less does not, and their
    /// number.
    fn enough_needed_and_all(kind: Kind, curvature: f64) -> [u32; 3] {
        let mut chance = Rng::with_seed(1);
        let [mut enough, mut needed, mut all] = [0; 3];
        while all < 100 {
            let [ego, foe] = any_pair(&mut chance, curvature);
            let is_of_kind = |ttc: &Second| {
                let angle = angle_between(&motion(&ego).at(*ttc).axis, &motion(&foe).at(*ttc).axis);
                Kind::at(angle, Options::default().kind_bounds()) == kind
            };
            let soon = time_to_collision(&motion(&ego), &motion(&foe)).filter(|ttc| *ttc < 5.0).filter(is_of_kind);
            let found = soon.and_then(|_| found_of(kind, &ego, &foe));
            let Some((drac, ttc)) = found.filter(|(drac, _)| (0.5..LIMIT).contains(drac)) else { continue };
            // With slightly too little braking it touches a leader after 2 TTC; when turning it may come by twice.
            let soon = if kind == Kind::Side { 1.2 } else { 2.5 };
            let until = if curvature == 0.0 { 2.0 * HORIZON } else { soon * ttc };
            let both_brake = drac < alone_of(&ego, &foe, ttc);
            let touch = |part: f64, further, until| {
                touch(&ego, &foe, [drac * part, if both_brake { drac * part } else { 0.0 }], further, until)
            };
            all += 1;
            let accuracy = if curvature == 0.0 { BRAKING_ACCURACY } else { ACCURACY };
            enough += u32::from(!touch(1.0, -accuracy, until));
            // Two that both brake may pass each other with less.
            needed += u32::from(both_brake || touch(0.98, accuracy, 2.0 * HORIZON));
        }
        [enough, needed, all]
    }

    fn alone_of(ego: &Drive, foe: &Drive, ttc: Second) -> f64 {
        alone(&mut Bisection::default(), &motion(ego), &motion(foe), ttc)
    }

    #[test]
    fn drac_avoids_contact_and_two_per_cent_less_does_not() {
        for kind in Kind::ALL {
            // Two that meet at an angle may just pass each other while both brake, so that a little less or more may do.
            let least = if kind == Kind::Frontal { 90 } else { 100 };
            let [enough, needed, all] = enough_needed_and_all(kind, 0.0);
            assert!(100 * enough.min(needed) >= least * all, "{kind:?}: {enough} and {needed} of {all}");
            // One that turns may leave the ego's path and come back; what it needs then does not count.
            let least = least.min(if kind == Kind::RearEnd { 95 } else { 98 });
            let [enough, needed, all] = enough_needed_and_all(kind, 0.05);
            assert!(100 * enough.min(needed) >= least * all, "{kind:?}, turning: {enough} and {needed} of {all}");
        }
    }

    #[test]
    fn both_braking_straight_on_is_what_small_parts_of_it_say() {
        let (mut chance, mut compared) = (Rng::with_seed(3), 0);
        for _ in 0..20_000 {
            let [ego, foe] = any_pair(&mut chance, 0.0);
            let (ego, foe) = (motion(&ego), motion(&foe));
            let needed = together(&ego, &foe);
            let least = if needed.is_finite() { 0.98 * needed - 0.01 } else { LIMIT };
            if least > 0.01 {
                assert!(touch_while_braking(&ego, &foe, least), "{needed}: {ego:?} {foe:?}");
                assert!(needed.is_infinite() || !touch_while_braking(&ego, &foe, 1.02 * needed + 0.01));
                compared += 1;
            }
        }
        assert!(compared > 1000, "{compared}");
    }

    #[test]
    fn the_search_finds_what_the_closed_form_says() {
        let mut chance = Rng::with_seed(2);
        let mut compared = 0;
        for [ego, foe] in (0..10_000).map(|_| any_pair(&mut chance, 0.0)) {
            // The search may miss a foe that blocks the path only briefly.
            let Some((_, ttc)) = found(&ego, &foe) else { continue };
            let closed = alone_of(&ego, &foe, ttc);
            if closed <= 0.5 {
                continue;
            }
            let searched = by_search(&mut Bisection::default(), &motion(&ego), &motion(&foe), ttc);
            assert!(closed == searched || (closed - searched).abs() < 0.01 * closed, "{closed} and {searched}");
            compared += 1;
        }
        assert!(compared > 100, "{compared}");
    }
}
