//! What ASAM's formats need and a clip lacks: heights and axles of road users, the formats' words for SUMO's classes, and
//! centres.

use std::f64::consts::{PI, TAU};

use closecall::events::{ClipCategory, ClipUser};
use closecall::geometry::{Bounds, Point, Vector};
use closecall::util::units::{Metre, MetrePerSecond, Radian};

/// The rear axle is this share of a vehicle's length behind its centre, and the front axle as far before it: that of cars, whose
/// wheelbase is about 0.6 of their length.
const AXLE: f64 = 0.3;
/// The diameter of a car's wheels in m.
pub(crate) const WHEEL: Metre = 0.65;
/// The height of an obstacle in m: as high as a car, since SUMO's polygons have none.
const OBSTACLE_HEIGHT: Metre = 1.5;

/// The words of the formats for a class.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Class {
    /// OpenSCENARIO's `VehicleCategory`.
    pub category: &'static str,
    /// OSI's `MovingObject.VehicleClassification.Type`.
    pub osi: u64,
    /// Height in m.
    pub height: Metre,
}

const CAR: Class = Class { category: "car", osi: 4, height: 1.5 };

/// The classes that differ from a car, with SUMO 1.28's default heights.
const CLASSES: [(&str, Class); 19] = [
    ("emergency", Class { category: "van", osi: 6, height: 2.86 }),
    ("delivery", Class { category: "van", osi: 6, height: 2.86 }),
    ("bus", Class { category: "bus", osi: 12, height: 3.4 }),
    ("coach", Class { category: "bus", osi: 12, height: 4.0 }),
    ("truck", Class { category: "truck", osi: 7, height: 2.4 }),
    // A truck with its trailer.
    ("trailer", Class { category: "truck", osi: 7, height: 4.0 }),
    ("tram", Class { category: "tram", osi: 13, height: 3.2 }),
    ("rail_urban", Class { category: "train", osi: 14, height: 3.6 }),
    ("subway", Class { category: "train", osi: 14, height: 3.6 }),
    ("rail", Class { category: "train", osi: 14, height: 3.75 }),
    ("rail_electric", Class { category: "train", osi: 14, height: 3.89 }),
    ("rail_fast", Class { category: "train", osi: 14, height: 3.89 }),
    ("motorcycle", Class { category: "motorbike", osi: 10, height: 1.5 }),
    ("moped", Class { category: "motorbike", osi: 10, height: 1.7 }),
    ("bicycle", Class { category: "bicycle", osi: 11, height: 1.7 }),
    ("scooter", Class { category: "bicycle", osi: 17, height: 1.7 }),
    ("wheelchair", Class { category: "bicycle", osi: 15, height: 1.2 }),
    ("ship", Class { category: "car", osi: 20, height: 4.0 }),
    // No vehicle: only the height counts.
    ("pedestrian", Class { category: "car", osi: 1, height: 1.719 }),
];

/// The class of a road user.
pub(crate) fn class_of(user: &ClipUser) -> Class {
    let known = CLASSES.iter().find(|(name, _)| *name == user.class);
    match user.category {
        ClipCategory::Obstacle => Class { height: OBSTACLE_HEIGHT, ..CAR },
        _ => known.map_or(CAR, |(_, class)| *class),
    }
}

/// How far the axles are from a vehicle's centre.
pub(crate) fn axle(user: &ClipUser) -> Metre {
    AXLE * user.length
}

/// Where a road user was at a time of the clip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The middle of its rectangle.
    pub centre: Point,
    /// The direction from its rear to its front, in rad; a road user's headings never jump by a turn.
    pub heading: Radian,
    /// Speed in m/s.
    pub speed: MetrePerSecond,
}

impl Place {
    /// The direction from the rear to the front.
    pub(crate) fn forward(&self) -> Vector {
        Vector::new(self.heading.cos(), self.heading.sin())
    }
}

/// Where a road user was at each time of its clip; none where it was absent.
pub fn places(user: &ClipUser) -> Vec<Option<Place>> {
    let mut last = None;
    let place = |at: usize| {
        let front = Point::new(user.x[at]?, user.y[at]?);
        let (to, speed) = (user.heading[at]?, user.speed[at]?);
        let from = last.unwrap_or(to);
        // The short way round.
        let heading = from + (to - from + PI).rem_euclid(TAU) - PI;
        last = Some(heading);
        let place = Place { centre: front, heading, speed };
        Some(Place { centre: front - place.forward() * (user.length / 2.0), ..place })
    };
    (0..user.x.len()).map(place).collect()
}

/// The box around a part of an obstacle, sides along x and y.
pub fn box_around(part: &[[Metre; 2]]) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    part.iter().for_each(|[x, y]| bounds.include(Point::new(*x, *y)));
    bounds
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_go_the_short_way_round() {
        let all = |value| vec![Some(value); 3];
        let heading = vec![Some(3.1), None, Some(-3.1)];
        let user = ClipUser { length: 4.0, x: all(0.0), y: all(0.0), heading, speed: all(1.0), ..ClipUser::default() };
        let found = places(&user);
        let turned = found[2].unwrap();
        assert!((turned.heading - (TAU - 3.1)).abs() < 1e-12 && found[1].is_none());
        assert!((turned.centre - Point::new(2.0 * 3.1_f64.cos().abs(), -2.0 * turned.heading.sin())).norm() < 1e-12);
    }
}
