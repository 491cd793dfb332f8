//! Time advantage (TAdv, the predicted PET) and T2 (Laureshyn, Svensson and Hydén 2010): the PET that two will have, and when
//! the second will enter the conflict area, if both keep their speeds along their predicted paths.
//!
//! ```text
//! not on a collision course:  TAdv = PET of the predicted paths,  T2 = when the second enters the conflict area
//! on a collision course:      TAdv = 0,                           T2 = TTC
//! ```
//!
//! Like the PET, only for paths that cross or merge, not for a follower. None if one of the two stands clear of the other's
//! path, or if the paths do not meet within [`HORIZON`].

use super::driven_path::DrivenPath;
use super::pet::post_encroachment_time;
use super::ttc::{HORIZON, SteadyMotion};
use crate::geometry::bisection::Bisection;
use crate::util::units::{Radian, Second};

/// What a pair has ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Advantage {
    /// The time advantage, in s.
    pub tadv: Second,
    /// When the second enters the conflict area, in s from now.
    pub t2: Second,
}

impl Advantage {
    /// That of two that touch after this time.
    pub(crate) fn on_collision_course(ttc: Second) -> Self {
        Self { tadv: 0.0, t2: ttc }
    }
}

/// TAdv and T2 of two that do not touch. Paths that meet at an angle below `crossing` do not cross.
pub fn advantage(pair: [&SteadyMotion; 2], crossing: Radian) -> Option<Advantage> {
    let [a, b] = pair.map(predicted);
    let pet = post_encroachment_time(&mut Bisection::default(), &a, &b, crossing)?;
    Some(Advantage { tadv: pet.lasts, t2: pet.enters })
}

/// The path that a road user will drive within [`HORIZON`], from time 0 on.
fn predicted(motion: &SteadyMotion) -> DrivenPath {
    let mut path = DrivenPath::new(motion.length, motion.width);
    if motion.speed > 0.0 {
        let within = motion.speed * HORIZON;
        let known = motion.poses.iter().take_while(|pose| pose.distance < within);
        known.for_each(|pose| path.push(pose.distance / motion.speed, pose.front, pose.axis.y.atan2(pose.axis.x)));
        if let Some(last) = motion.poses.last().filter(|last| last.distance < within) {
            let front = last.front + last.axis * (within - last.distance);
            path.push(HORIZON, front, last.axis.y.atan2(last.axis.x));
        } else if let Some(next) = motion.poses.iter().find(|pose| pose.distance >= within) {
            path.push(next.distance / motion.speed, next.front, next.axis.y.atan2(next.axis.x));
        }
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detection::measures::ttc::time_to_collision;
    use crate::detection::path::{Pose, arc};
    use crate::geometry::Point;
    use crate::geometry::exact::touches;
    use crate::geometry::rectangle::{Rectangle, direction};
    use fastrand::Rng;

    /// The bound below which a conflict is rear-end.
    const CROSSING: Radian = std::f64::consts::FRAC_PI_6;

    fn poses((x, y): (f64, f64), heading: f64, speed: f64, curvature: f64) -> Vec<Pose> {
        let (front, axis) = (Point::new(x, y), direction(heading));
        let mut poses = vec![Pose { distance: 0.0, front, axis }];
        arc::poses(front, axis, curvature, 5.0, &[speed * HORIZON], &mut poses);
        poses
    }

    fn motion(poses: &[Pose], speed: f64) -> SteadyMotion<'_> {
        SteadyMotion { poses, speed, deceleration: 0.0, length: 4.0, width: 2.0 }
    }

    /// TAdv and T2 from rectangles at each hundredth of a second.
    fn sampled(pair: [&SteadyMotion; 2]) -> Option<(f64, f64)> {
        const STEP: f64 = 0.02;
        let at = |of: &SteadyMotion| (0..500).map(|step| of.at(f64::from(step) * STEP)).collect::<Vec<Rectangle>>();
        let [a, b] = pair.map(at);
        let meets = |own: &Rectangle, other: &[Rectangle]| other.iter().any(|other| touches(own, other));
        let span = |own: &[Rectangle], other: &[Rectangle]| {
            let enters = own.iter().position(|own| meets(own, other))?;
            let leaves = own.iter().rposition(|own| meets(own, other))?;
            (leaves + 1 < own.len()).then_some((enters as f64 * STEP, leaves as f64 * STEP))
        };
        let (a, b) = (span(&a, &b)?, span(&b, &a)?);
        let (first, second) = if a.0 < b.0 { (a, b) } else { (b, a) };
        Some((second.0 - first.1, second.0))
    }

    #[test]
    fn it_is_what_small_steps_along_the_predicted_paths_say() {
        let mut chance = Rng::with_seed(5);
        let mut between = |low: f64, high: f64| low + (high - low) * chance.f64();
        let mut compared = 0;
        while compared < 25 {
            let [own, other] = [between(3.0, 15.0), between(3.0, 15.0)];
            let a = poses((0.0, 0.0), 0.0, own, between(-0.02, 0.02));
            let place = (between(20.0, 50.0), between(-60.0, -15.0));
            let b = poses(place, between(1.2, 2.0), other, between(-0.02, 0.02));
            let pair = [&motion(&a, own), &motion(&b, other)];
            if time_to_collision(pair[0], pair[1]).is_some() {
                continue;
            }
            let (Some(found), Some((tadv, t2))) = (advantage(pair, CROSSING), sampled(pair)) else { continue };
            compared += 1;
            assert!((found.tadv - tadv).abs() < 0.05 && (found.t2 - t2).abs() < 0.03, "{found:?}, {tadv} and {t2}");
        }
    }

    #[test]
    fn of_two_that_just_miss_it_is_nearly_that_of_a_collision_course() {
        // The first has left the second's path, 2 m wide, after 4.5 s.
        let north = std::f64::consts::FRAC_PI_2;
        for late in [0.05, 0.02] {
            let (a, b) = (poses((0.0, 0.0), 0.0, 10.0, 0.0), poses((40.0, -46.0 - 10.0 * late), north, 10.0, 0.0));
            let found = advantage([&motion(&a, 10.0), &motion(&b, 10.0)], CROSSING).unwrap();
            let limit = Advantage::on_collision_course(4.5);
            assert!(
                (found.tadv - limit.tadv - late).abs() < 0.01 && (found.t2 - limit.t2 - late).abs() < 0.01,
                "{found:?}"
            );
        }
    }

    #[test]
    fn neither_a_follower_nor_one_that_stands_beside_has_one() {
        let (a, b) = (poses((0.0, 0.0), 0.0, 10.0, 0.0), poses((20.0, 0.0), 0.0, 10.0, 0.0));
        assert_eq!(advantage([&motion(&a, 10.0), &motion(&b, 10.0)], CROSSING), None);
        let aside = poses((20.0, -9.0), 1.6, 0.0, 0.0);
        assert_eq!(advantage([&motion(&a, 10.0), &motion(&aside, 0.0)], CROSSING), None);
    }
}
