//! Where a road user that drives on a circle first touches the area that another covers on a circle of its own: both paths are
//! halved until no contact can hide in between.
//!
//! A pose is the chord from the rear to the front bumper, both on the circle.

/// Two rectangles that are closer than this touch, in m.
const TOUCHES: f64 = 1e-6;

/// A road user on a circle, or on a straight line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Circling {
    /// Front-bumper centre now, in m.
    pub front: [f64; 2],
    /// Heading now, in rad.
    pub heading: f64,
    /// Curvature of the front bumper's way in 1/m, positive to the left.
    pub curvature: f64,
    /// Length and width in m.
    pub size: [f64; 2],
    /// How far it drives, in m.
    pub until: f64,
}

/// A rectangle: centre, direction, half length and half width.
struct Place([f64; 2], [f64; 2], [f64; 2]);

impl Circling {
    /// Front-bumper centre and heading at a distance: the circle's chord over that distance is turned by half the angle.
    pub fn pose(&self, distance: f64) -> ([f64; 2], f64) {
        let Self { front: [x, y], heading, curvature, size: [length, _], .. } = *self;
        // The tangent at the front is ahead of the chord from the rear.
        let tangent = heading + (curvature * length / 2.0).asin();
        let half = curvature * distance / 2.0;
        let chord = if half == 0.0 { distance } else { distance * half.sin() / half };
        let (sine, cosine) = (tangent + half).sin_cos();
        ([x + chord * cosine, y + chord * sine], heading + 2.0 * half)
    }

    fn place(&self, distance: f64) -> Place {
        let ([x, y], heading) = self.pose(distance);
        let [length, width] = self.size.map(|size| size / 2.0);
        let (sine, cosine) = heading.sin_cos();
        Place([x - length * cosine, y - length * sine], [cosine, sine], [length, width])
    }

    /// No point of it moves further than this for each metre of the front bumper's.
    fn pace(&self) -> f64 {
        let [length, width] = self.size;
        1.0 + self.curvature.abs() * length.hypot(width / 2.0)
    }
}

/// A lower bound on the distance of two rectangles that is 0 only if they touch: the widest room along one of their sides.
fn room(a: &Place, b: &Place) -> f64 {
    let between = [b.0[0] - a.0[0], b.0[1] - a.0[1]];
    let along = |[x, y]: [f64; 2], [ax, ay]: [f64; 2]| x * ax + y * ay;
    let reach = |place: &Place, axis| {
        let [ax, ay] = place.1;
        along([ax, ay], axis).abs() * place.2[0] + along([-ay, ax], axis).abs() * place.2[1]
    };
    let axes = [a.1, [-a.1[1], a.1[0]], b.1, [-b.1[1], b.1[0]]];
    axes.into_iter().map(|axis| along(between, axis).abs() - reach(a, axis) - reach(b, axis)).fold(0.0, f64::max)
}

/// The ego's distance at which it first touches the area that the foe covers on its way, to within `precision`.
pub(crate) fn first_touch(ego: &Circling, foe: &Circling, precision: f64) -> Option<f64> {
    earliest(ego, foe, [0.0, ego.until], precision)
}

fn earliest(ego: &Circling, foe: &Circling, [from, to]: [f64; 2], precision: f64) -> Option<f64> {
    let middle = (from + to) / 2.0;
    let reach = (to - from) / 2.0 * ego.pace();
    if is_clear(&ego.place(middle), foe, [0.0, foe.until], reach) {
        return None;
    }
    if to - from <= precision {
        return Some(from);
    }
    earliest(ego, foe, [from, middle], precision).or_else(|| earliest(ego, foe, [middle, to], precision))
}

/// Whether a rectangle surely stays further than `reach` from everything that the foe covers on this part of its way.
fn is_clear(place: &Place, foe: &Circling, [from, to]: [f64; 2], reach: f64) -> bool {
    let middle = (from + to) / 2.0;
    let room = room(place, &foe.place(middle)) - reach;
    let half = (to - from) / 2.0 * foe.pace();
    if room > half {
        return true;
    }
    if room <= 0.0 || half <= TOUCHES {
        return false;
    }
    is_clear(place, foe, [from, middle], reach) && is_clear(place, foe, [middle, to], reach)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_follower_touches_after_the_room_between() {
        let ego = Circling { front: [0.0, 0.0], heading: 0.0, curvature: 0.0, size: [5.0, 2.0], until: 50.0 };
        let foe = Circling { front: [15.0, 0.0], until: 20.0, ..ego };
        assert!((first_touch(&ego, &foe, 1e-6).unwrap() - 10.0).abs() < 1e-5);
        assert_eq!(first_touch(&ego, &Circling { front: [15.0, 2.1], ..foe }, 1e-6), None);
    }

    #[test]
    fn a_quarter_circle_ends_a_radius_ahead_and_aside() {
        let ego = Circling { front: [0.0, 0.0], heading: 0.0, curvature: 0.1, size: [0.0, 2.0], until: 50.0 };
        let ([x, y], heading) = ego.pose(5.0 * std::f64::consts::PI);
        assert!((x - 10.0).abs() + (y - 10.0).abs() + (heading - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    }
}
