//! TTC of two road users that keep their speed, compared with parry2d's linear `cast_shapes`.

use closecall::Point;
use closecall::detection::measures::ttc::{HORIZON, SteadyMotion, time_to_collision};
use closecall::detection::path::Pose;
use closecall::geometry::contact::distance;
use closecall::geometry::rectangle::{Rectangle, direction};
use parry2d_f64::math::{Pose as ParryPose, Rotation, Vector};
use parry2d_f64::query::{ShapeCastOptions, cast_shapes};
use parry2d_f64::shape::Cuboid;

/// A linear congruential generator: the same pairs on every machine.
struct Chance(u64);

impl Chance {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }
}

struct RoadUser {
    pose: Pose,
    speed: f64,
    length: f64,
    width: f64,
}

impl RoadUser {
    fn new(chance: &mut Chance) -> Self {
        let front = Point::new(chance.between(-20.0, 20.0), chance.between(-20.0, 20.0));
        let axis = direction(chance.between(-4.0, 4.0));
        Self {
            pose: Pose { distance: 0.0, front, axis },
            speed: chance.between(0.0, 40.0),
            length: chance.between(0.5, 15.0),
            width: chance.between(0.3, 3.0),
        }
    }

    fn rectangle(&self) -> Rectangle {
        Rectangle::behind(self.pose.front, self.pose.axis, self.length, self.width)
    }

    fn at(&self, time: f64) -> Rectangle {
        Rectangle::behind(
            self.pose.front + self.pose.axis * (self.speed * time),
            self.pose.axis,
            self.length,
            self.width,
        )
    }

    fn motion<'a>(&self, poses: &'a [Pose]) -> SteadyMotion<'a> {
        SteadyMotion { poses, speed: self.speed, deceleration: 0.0, length: self.length, width: self.width }
    }

    fn parry(&self) -> (ParryPose, Vector, Cuboid) {
        let (rectangle, axis) = (self.rectangle(), self.pose.axis);
        let pose = ParryPose {
            rotation: Rotation { re: axis.x, im: axis.y },
            translation: Vector::new(rectangle.centre.x, rectangle.centre.y),
        };
        let velocity = Vector::new(axis.x * self.speed, axis.y * self.speed);
        (pose, velocity, Cuboid::new(Vector::new(rectangle.half_length, rectangle.half_width)))
    }
}

#[test]
fn ttc_at_any_angle_is_that_of_parrys_cast() {
    let mut chance = Chance(11);
    let (mut met, mut grazing) = (0, 0);
    for _ in 0..100_000 {
        let (a, b) = (RoadUser::new(&mut chance), RoadUser::new(&mut chance));
        let (poses_a, poses_b) = ([a.pose], [b.pose]);
        let ours = time_to_collision(&a.motion(&poses_a), &b.motion(&poses_b));
        let ((pose_a, velocity_a, shape_a), (pose_b, velocity_b, shape_b)) = (a.parry(), b.parry());
        let options = ShapeCastOptions::with_max_time_of_impact(HORIZON);
        let theirs = cast_shapes(&pose_a, velocity_a, &shape_a, &pose_b, velocity_b, &shape_b, options).unwrap();
        match (ours, theirs.map(|hit| hit.time_of_impact)) {
            (Some(ours), Some(theirs)) => {
                met += 1;
                // Where the two disagree, the rectangles decide: they touch at our time.
                if (ours - theirs).abs() > 1e-9 {
                    grazing += 1;
                    assert!(distance(&a.at(ours), &b.at(ours)) < 1e-9, "{ours} s against {theirs} s");
                }
            }
            (None, None) => {}
            (Some(ours), None) => assert!(distance(&a.at(ours), &b.at(ours)) < 1e-9, "only ours: {ours} s"),
            (None, Some(theirs)) => assert!(distance(&a.at(theirs), &b.at(theirs)) > 0.0, "only theirs: {theirs} s"),
        }
    }
    assert!(met > 10_000, "{met} pairs met");
    assert!(grazing * 1000 < met, "{grazing} of {met} differ by more than 1e-9 s");
}
