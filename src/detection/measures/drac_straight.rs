//! DRAC of a pair in which neither road user turns.

use crate::geometry::Vector;
use crate::geometry::rectangle::Rectangle;
use crate::geometry::separating_axes::{normals, slide};
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Second};

/// DRAC in m/s² if neither turns before this time, in closed form; what comes later does not count.
///
/// Along each of the four normals, the ego's distances at which both overlap lie between two linear functions of time.
/// Where all four intervals meet, the ego would touch at the largest of the lower functions. The needed deceleration is
/// largest where that maximum bends, at an end of the time span, or where it is largest for one function alone.
pub(super) fn straight(
    (ego, velocity): (Rectangle, Vector),
    (foe, foe_velocity): (Rectangle, Vector),
    until: Second,
) -> MetrePerSecondSquared {
    /// The ego does not move along a normal if its component along it is smaller than this.
    const SIDEWAYS: f64 = 1e-12;
    let speed = velocity.norm();
    if speed == 0.0 {
        return 0.0;
    }
    let ahead = velocity / speed;
    let between = foe.centre - ego.centre;
    let mut from = 0.0;
    let mut to = until;
    // Limits the time span to where `room + change · time` is not negative. No branch: the sign of `change` is
    // unpredictable.
    let mut while_positive = |room: f64, change: f64| {
        let time = -room / change;
        from = f64::max(from, if change > 0.0 { time } else { f64::NEG_INFINITY });
        to = f64::min(to, if change < 0.0 { time } else { f64::INFINITY });
        to = if change == 0.0 && room < 0.0 { f64::NEG_INFINITY } else { to };
    };
    // The first lower function is 0: where the ego is now.
    let mut lower = [UniformDistance::default(); 5];
    let mut upper = [UniformDistance::default(); 4];
    let mut lines = 0;
    for (normal, reach) in normals(&ego, &foe) {
        let along = normal.dot(&ahead);
        let normal = normal * 1_f64.copysign(along);
        let (room, change, along) = (normal.dot(&between), normal.dot(&foe_velocity), along.abs());
        if along < SIDEWAYS {
            while_positive(reach - room, -change);
            while_positive(reach + room, change);
        } else {
            upper[lines] = UniformDistance { distance: (room + reach) / along, speed: change / along };
            lines += 1;
            lower[lines] = UniformDistance { distance: (room - reach) / along, speed: change / along };
        }
    }
    let lower = &lower[..=lines];
    let upper = &upper[..lines];
    for up in upper {
        lower.iter().for_each(|low| while_positive(up.distance - low.distance, up.speed - low.speed));
    }
    if from > to {
        return 0.0;
    }
    let needed = |time: Second| {
        let distance = lower.iter().map(|line| line.distance + line.speed * time).fold(0.0, f64::max);
        to_stay_behind(speed, time, distance)
    };
    // The times within the span at which a function alone is worst or takes over from another.
    let mut between = [0.0; 15];
    let mut count = 0;
    let mut add = |time: Second| {
        between[count] = time;
        count += usize::from(from < time && time < to);
    };
    for (number, line) in lower.iter().enumerate() {
        add(if speed > line.speed { 2.0 * line.distance / (speed - line.speed) } else { from });
        for other in &lower[..number] {
            add((other.distance - line.distance) / (line.speed - other.speed));
        }
    }
    between[..count].iter().fold(needed(from).max(needed(to)), |most, time| most.max(needed(*time)))
}

/// Whether two that go straight on and both brake with this deceleration touch before they stand or this time is over, in closed
/// form.
///
/// While both brake, the place of one relative to the other is a parabola. If they overlap along all four normals at any time,
/// they do so at the beginning, at the end, or when they begin to overlap along one. When one stands, the other goes straight on.
pub(super) fn touch_while_braking(
    (one, velocity): (Rectangle, Vector),
    (other, other_velocity): (Rectangle, Vector),
    deceleration: MetrePerSecondSquared,
    until: Second,
) -> bool {
    /// Where they begin to overlap, rounding may leave them this far apart, in m.
    const ROUNDED: Metre = 1e-9;
    let velocities = [velocity, other_velocity];
    let ahead = velocities.map(|velocity| velocity.try_normalize(0.0).unwrap_or_default());
    let stands = velocities.map(|velocity| velocity.norm() / deceleration);
    let end = stands[0].min(stands[1]).min(until);
    let (apart, speed) = (other.centre - one.centre, other_velocity - velocity);
    let braked = (ahead[1] - ahead[0]) * (deceleration / 2.0);
    let place = |time: Second| apart + speed * time - braked * (time * time);
    let axes = normals(&one, &other);
    let touch_at = |time: Second| {
        let place = place(time);
        axes.iter().all(|(normal, reach)| normal.dot(&place).abs() <= reach + ROUNDED)
    };
    let begins = |(normal, reach): &(Vector, Metre)| {
        let (room, change, bend) = (normal.dot(&apart), normal.dot(&speed), normal.dot(&braked));
        [-reach, *reach].into_iter().flat_map(move |side| roots(-bend, change, room - side))
    };
    let within = |time: &Second| (0.0..=end).contains(time);
    if touch_at(0.0) || touch_at(end) || axes.iter().flat_map(begins).filter(within).any(touch_at) {
        return true;
    }
    let moved = [0, 1].map(|which| {
        let travelled = |time: Second| {
            let brakes = time.min(stands[which]);
            ahead[which] * ((velocities[which].norm() - deceleration * brakes / 2.0) * brakes)
        };
        (travelled(end), travelled(until) - travelled(end))
    });
    let at = |of: &Rectangle, by: Vector| Rectangle { centre: of.centre + by, ..*of };
    slide(&at(&one, moved[0].0), &(moved[0].1 - moved[1].1), &at(&other, moved[1].0)).is_some()
}

/// The real roots of a t² + b t + c, without cancellation.
fn roots(a: f64, b: f64, c: f64) -> [f64; 2] {
    let root = (b * b - 4.0 * a * c).sqrt();
    let sum = -(b + root.copysign(b)) / 2.0;
    [sum / a, c / sum]
}

/// A distance that changes evenly over time.
#[derive(Clone, Copy, Default)]
struct UniformDistance {
    distance: Metre,
    speed: MetrePerSecond,
}

/// The least constant deceleration with which the ego does not pass a distance before a time; 0 if it does not anyway.
pub(super) fn to_stay_behind(speed: MetrePerSecond, time: Second, distance: Metre) -> MetrePerSecondSquared {
    let unbraked = speed * time;
    // Both are computed, because which of them applies is unpredictable.
    let to_stand = speed * speed / (2.0 * distance);
    let to_wait = 2.0 * (unbraked - distance) / (time * time);
    let needed = if unbraked >= 2.0 * distance { to_stand } else { to_wait };
    if unbraked <= distance { 0.0 } else { needed }
}
