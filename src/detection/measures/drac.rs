//! DRAC: the least deceleration with which the ego avoids contact with a foe that keeps its speed.

use super::ttc::{Course, HORIZON};
use crate::geometry::Vector;
use crate::geometry::bisection::{Bisection, Contact};
use crate::geometry::rectangle::Rectangle;
use crate::geometry::separating_axes::normals;
use crate::geometry::sweep::TOLERANCE;
use crate::util::golden_section::golden_section;
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Second};

/// At so many moments the foe is looked at before the worst is narrowed down: before they would touch, and from then on.
const BEFORE: i32 = 6;
const AFTER: i32 = 14;

/// So often that is narrowed down, each time to 0.62 of what it was: 1 s to 1 ms.
const NARROWED: u32 = 14;

/// DRAC in m/s² towards a foe on the ego's own line, which leads or drives up and keeps its speed: what brings the
/// relative speed to 0 within the room between both, closing² / (2 room), where room = closing · TTC; none where both
/// touch now.
///
/// ```
/// use closecall::detection::measures::drac::drac_in_line;
/// assert_eq!(drac_in_line(10.0, 2.5), Some(2.0));
/// ```
pub fn drac_in_line(closing: MetrePerSecond, ttc: Second) -> Option<MetrePerSecondSquared> {
    (closing > 0.0 && ttc > 0.0).then(|| closing / (2.0 * ttc)).filter(|drac| drac.is_finite())
}

/// DRAC in m/s² towards any other foe: the least constant deceleration, until it stands, with which the ego stays behind
/// each place where the foe is in its way at that time, until the foe has left. Infinite where it comes to where the ego
/// is now, which no deceleration avoids.
///
/// Both keep to their poses, and touch after `ttc`, in s, if both keep their speeds.
pub fn drac(halves: &mut Bisection, ego: &Course, foe: &Course, ttc: Second) -> MetrePerSecondSquared {
    if let (Some((of_ego, by)), Some((of_foe, foe_by))) = (ego.straight(), foe.straight()) {
        return straight((&of_ego, by / HORIZON), (&of_foe, foe_by / HORIZON));
    }
    by_moments(halves, ego, foe, ttc)
}

/// The same where one of the two turns: from where the foe is at many moments, then at more of them about the worst.
fn by_moments(halves: &mut Bisection, ego: &Course, foe: &Course, ttc: Second) -> MetrePerSecondSquared {
    halves.clear();
    let mut needed = |time| to_stay_behind(ego.speed, time, way_to(halves, ego, &foe.at(time), ego.speed * time));
    // To come to a stand, or to the speed of who leads, takes twice as long as to touch it. All close together about
    // when they would touch: a foe that crosses may be there for a moment only.
    let moment = |number: i32| {
        let part = f64::from(number) / f64::from(if number < 0 { BEFORE } else { AFTER });
        if number < 0 { ttc * (1.0 - part * part) } else { ttc + (2.0 * HORIZON - ttc) * part.powi(3) }
    };
    let (mut at, mut most) = (0, 0.0);
    // When they would touch, rounding would say.
    for number in (1 - BEFORE..0).chain(1..=AFTER) {
        let now = needed(moment(number));
        if now == 0.0 && most > 0.0 && number > 0 {
            break;
        }
        if now > most {
            (at, most) = (number, now);
        }
    }
    if most.is_finite() { narrow(needed, moment(at - 1), moment(AFTER.min(at + 1)), most) } else { most }
}

/// What the ego needs where neither turns: in closed form.
///
/// Across each of the four normals both touch between two lines over time of the ego's way. Where all intervals meet, the
/// ego would touch at the greatest of the lower lines; the worst is where that bends, at an end, or where what is needed
/// for one line alone is greatest.
fn straight((ego, velocity): (&Rectangle, Vector), (foe, foe_velocity): (&Rectangle, Vector)) -> MetrePerSecondSquared {
    /// Across a normal that the ego leaves by less than this, in m per m, it does not move.
    const SIDEWAYS: f64 = 1e-12;
    let speed = velocity.norm();
    if speed == 0.0 {
        return 0.0;
    }
    let ahead = velocity / speed;
    let between = foe.centre - ego.centre;
    let (mut from, mut to) = (0.0, 2.0 * HORIZON);
    // Only while `room + change · time` is not negative. Which of the three it is no processor could guess.
    let mut while_positive = |room: f64, change: f64| {
        let time = -room / change;
        from = f64::max(from, if change > 0.0 { time } else { f64::NEG_INFINITY });
        to = f64::min(to, if change < 0.0 { time } else { f64::INFINITY });
        to = if change == 0.0 && room < 0.0 { f64::NEG_INFINITY } else { to };
    };
    // The first of the lower ones is where the ego is.
    let (mut lower, mut upper, mut lines) = ([Line::default(); 5], [Line::default(); 4], 0);
    for (normal, reach) in normals(ego, foe) {
        let along = normal.dot(&ahead);
        let normal = normal * 1_f64.copysign(along);
        let (room, change, along) = (normal.dot(&between), normal.dot(&foe_velocity), along.abs());
        if along < SIDEWAYS {
            while_positive(reach - room, -change);
            while_positive(reach + room, change);
        } else {
            upper[lines] = Line { way: (room + reach) / along, speed: change / along };
            lines += 1;
            lower[lines] = Line { way: (room - reach) / along, speed: change / along };
        }
    }
    let (lower, upper) = (&lower[..=lines], &upper[..lines]);
    for up in upper {
        lower.iter().for_each(|low| while_positive(up.way - low.way, up.speed - low.speed));
    }
    if from > to {
        return 0.0;
    }
    let needed = |time: Second| {
        let way = lower.iter().map(|line| line.way + line.speed * time).fold(0.0, f64::max);
        to_stay_behind(speed, time, way)
    };
    // Those of these times that lie between both ends, where a line bends or takes over from another.
    let (mut between, mut count) = ([0.0; 15], 0);
    let mut add = |time: Second| {
        between[count] = time;
        count += usize::from(from < time && time < to);
    };
    for (number, line) in lower.iter().enumerate() {
        add(if speed > line.speed { 2.0 * line.way / (speed - line.speed) } else { from });
        for other in &lower[..number] {
            add((other.way - line.way) / (line.speed - other.speed));
        }
    }
    between[..count].iter().fold(needed(from).max(needed(to)), |most, time| most.max(needed(*time)))
}

/// A way that grows evenly over time.
#[derive(Clone, Copy, Default)]
struct Line {
    way: Metre,
    speed: MetrePerSecond,
}

/// The greatest value between two times, at least `most`, by golden-section search: what is needed grows until it is
/// greatest, or until the foe has gone.
fn narrow(mut needed: impl FnMut(Second) -> f64, from: Second, to: Second, most: f64) -> f64 {
    let mut most = most;
    golden_section(
        |time| {
            let value = needed(time);
            most = most.max(value);
            value
        },
        from,
        to,
        NARROWED,
    );
    most
}

/// The least constant deceleration with which a way is not passed before a time; 0 where it is not passed anyway.
fn to_stay_behind(speed: MetrePerSecond, time: Second, way: Metre) -> MetrePerSecondSquared {
    let unbraked = speed * time;
    // Both, so that no processor has to guess which.
    let (to_stand, to_wait) = (speed * speed / (2.0 * way), 2.0 * (unbraked - way) / (time * time));
    let needed = if unbraked >= 2.0 * way { to_stand } else { to_wait };
    if unbraked <= way { 0.0 } else { needed }
}

/// The ego's way at which it would touch something that stands; infinite where it does not within `furthest`.
fn way_to(halves: &mut Bisection, ego: &Course, fixed: &Rectangle, furthest: Metre) -> Metre {
    let bounds = fixed.bounds().grown(2.0 * TOLERANCE);
    for (number, (from, to, step)) in ego.steps(furthest).enumerate() {
        let part = halves.numbered(number, || step);
        if !halves.bounds(part).meet(&bounds) {
            continue;
        }
        if let Some(enter) = halves.meet_rectangle((number, &step), fixed, Contact::Entry) {
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
    type Driven = (Vec<Pose>, MetrePerSecond);

    fn driven((x, y): (f64, f64), heading: f64, speed: f64, curvature: f64) -> Driven {
        let (front, axis) = (Point::new(x, y), direction(heading));
        let mut poses = vec![Pose { way: 0.0, front, axis }];
        arc::poses(front, axis, curvature, 5.0, &[speed * HORIZON], &mut poses);
        (poses, speed)
    }

    fn course((poses, speed): &Driven) -> Course<'_> {
        Course { poses, speed: *speed, length: 5.0, width: 2.0 }
    }

    /// DRAC and TTC, where both would touch.
    fn found(ego: &Driven, foe: &Driven) -> Option<(f64, f64)> {
        let (ego, foe) = (course(ego), course(foe));
        let ttc = time_to_collision(&ego, &foe).filter(|ttc| *ttc > 0.0)?;
        Some((drac(&mut Bisection::default(), &ego, &foe, ttc), ttc))
    }

    /// Whether an ego that brakes like this and is `further` ahead touches the foe until that time.
    fn touch(ego: &Driven, foe: &Driven, deceleration: f64, further: Metre, until: Second) -> bool {
        let (ego, foe) = (course(ego), course(foe));
        let stands = ego.speed / deceleration;
        (0..=20_000).map(|number| f64::from(number) * 1e-3).take_while(|time| *time <= until).any(|time| {
            let brakes = time.min(stands);
            let way = (ego.speed - deceleration * brakes / 2.0) * brakes + further;
            touches(&ego.at(way.max(0.0) / ego.speed), &foe.at(time))
        })
    }

    #[test]
    fn a_follower_brakes_away_the_difference_of_the_speeds() {
        let (ego, leader) = (driven((0.0, 0.0), 0.0, 20.0, 0.0), driven((30.0, 0.0), 0.0, 10.0, 0.0));
        let (drac, ttc) = found(&ego, &leader).unwrap();
        assert!((drac - 2.0).abs() < 1e-6, "{drac}");
        assert_eq!(drac_in_line(10.0, ttc), Some(2.0));
    }

    #[test]
    fn a_leader_who_is_not_quite_parallel_is_still_a_leader() {
        let (ego, leader) = (driven((0.0, 0.0), 0.0, 20.0, 0.0), driven((30.0, 0.0), 0.001, 10.0, 0.0));
        let (drac, _) = found(&ego, &leader).unwrap();
        assert!((drac - 2.0).abs() < 1e-3, "{drac}");
    }

    #[test]
    fn who_waits_for_one_that_crosses_brakes_less_than_who_stops() {
        let ego = driven((0.0, 0.0), 0.0, 20.0, 0.0);
        // From the right, 40 m ahead: its rear has left the ego's way after 2.6 s.
        let crossing = driven((41.0, -20.0), std::f64::consts::FRAC_PI_2, 10.0, 0.0);
        let (waiting, _) = found(&ego, &crossing).unwrap();
        assert!((waiting - 2.0 * (20.0 * 2.6 - 40.0) / (2.6 * 2.6)).abs() < 1e-3, "{waiting}");
        let slow = driven((41.0, -2.0), std::f64::consts::FRAC_PI_2, 1.0, 0.0);
        let (standing, _) = found(&ego, &slow).unwrap();
        assert!((standing - 5.0).abs() < 1e-3, "{standing}");
    }

    #[test]
    fn who_stands_needs_none() {
        let (ego, foe) = (driven((0.0, 0.0), 0.0, 0.0, 0.0), driven((-2.0, 20.0), -1.5, 5.0, 0.0));
        assert_eq!(found(&ego, &foe).unwrap().0, 0.0);
    }

    #[test]
    fn no_deceleration_avoids_who_comes_to_where_the_ego_is() {
        let (ego, oncoming) =
            (driven((0.0, 0.0), 0.0, 20.0, 0.0), driven((60.0, 0.0), std::f64::consts::PI, 10.0, 0.0));
        assert_eq!(found(&ego, &oncoming).unwrap().0, f64::INFINITY);
    }

    /// As exact it is, in m of the ego's way.
    const TO: Metre = 0.1;

    fn any_pair(chance: &mut Rng, curvature: f64) -> [Driven; 2] {
        let mut between = |low: f64, high: f64| low + (high - low) * chance.f64();
        let ego = driven((0.0, 0.0), 0.0, between(2.0, 30.0), between(-curvature, curvature));
        let (from, heading) = ((between(5.0, 80.0), between(-40.0, 40.0)), between(-3.2, 3.2));
        [ego, driven(from, heading, between(0.0, 30.0), between(-curvature, curvature))]
    }

    /// Of how many pairs that would touch soon, and need more than little, it avoids contact, and hardly less does not.
    fn right_and_all(curvature: f64) -> (u32, u32) {
        let mut chance = Rng::with_seed(1);
        let (mut right, mut all) = (0, 0);
        while all < 500 {
            let [ego, foe] = any_pair(&mut chance, curvature);
            let Some((drac, ttc)) = found(&ego, &foe).filter(|(drac, ttc)| *ttc < 5.0 && (0.5..50.0).contains(drac))
            else {
                continue;
            };
            // Who turns may come by twice.
            let until = if curvature == 0.0 { 2.0 * HORIZON } else { 1.2 * ttc };
            all += 1;
            right += u32::from(touch(&ego, &foe, drac, TO, 2.0 * HORIZON) && !touch(&ego, &foe, drac, -TO, until));
        }
        (right, all)
    }

    #[test]
    fn it_avoids_contact_and_hardly_less_does_not() {
        let (right, all) = right_and_all(0.0);
        assert_eq!(right, all);
        let (right, all) = right_and_all(0.05);
        assert!(100 * right >= 99 * all, "{right} of {all}");
    }

    #[test]
    fn moments_looked_at_say_what_the_closed_form_says() {
        let mut chance = Rng::with_seed(2);
        let mut compared = 0;
        for [ego, foe] in (0..10_000).map(|_| any_pair(&mut chance, 0.0)) {
            // Who is in the ego's way for a moment only, may be missed.
            let Some((closed, ttc)) = found(&ego, &foe).filter(|(closed, _)| *closed > 0.5) else { continue };
            let looked = by_moments(&mut Bisection::default(), &course(&ego), &course(&foe), ttc);
            assert!(closed == looked || (closed - looked).abs() < 0.01 * closed, "{closed} and {looked}");
            compared += 1;
        }
        assert!(compared > 100, "{compared}");
    }
}
