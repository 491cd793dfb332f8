//! Where and when a foe blocks the ego's path, and what the ego needs most to stay behind it.

use super::ttc::{HORIZON, SteadyMotion};
use crate::geometry::bisection::Bisection;
use crate::geometry::movement::TOLERANCE;
use crate::geometry::rectangle::Rectangle;
use crate::geometry::separating_axes::Contact;
use crate::util::golden_section::golden_section;
use crate::util::units::{Metre, Second};

/// Two directions are the same if the cosine of the angle between them is this near to 1.
pub(super) const PARALLEL: f64 = 1e-12;

/// Number of times at which the need is sampled before the contact.
const BEFORE: i32 = 6;
/// Number of times at which it is sampled after the contact.
const AFTER: i32 = 14;

/// Steps of the golden-section search about the largest sample. Each leaves 0.62 of the interval: 1 s becomes 1 ms.
const SEARCH_STEPS: u32 = 14;

/// The most times at which [`largest_need`] asks.
pub(crate) const MOST_TIMES: usize = (BEFORE + AFTER) as usize + SEARCH_STEPS as usize + 2;

/// The largest of what is `needed` at a time, over all times until the foe has left the ego's path; both touch after `ttc`
/// if neither does anything. Sampled at several times, then searched about the largest sample.
pub(super) fn largest_need(mut needed: impl FnMut(Second) -> f64, ttc: Second) -> f64 {
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

/// The largest value between two times, at least `most`: the need has one maximum there, or drops to 0 when the foe has
/// left.
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
pub(super) fn contact_distance(
    bisection: &mut Bisection,
    ego: &SteadyMotion,
    fixed: &Rectangle,
    furthest: Metre,
) -> Metre {
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
