//! Which parts of two road users touch: where they overlap at the worst step, or would first touch if both keep their speeds
//! along their paths from there.

use closecall::detection::measures::ttc::{SteadyMotion, time_to_collision};
use closecall::detection::path::Pose;
use closecall::geometry::rectangle::{Rectangle, direction};
use closecall::geometry::separating_axes::normals;
use closecall::geometry::{Point, Vector, left_of};
use closecall::util::units::{Metre, MetrePerSecond};
use closecall_run::output::schema::LoggedConflict;

/// A part of a road user, in the order of the page's words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Its front bumper.
    Front,
    /// Its rear bumper.
    Rear,
    /// Its left side.
    Left,
    /// Its right side.
    Right,
}

/// The ego's part and the foe's. None where the two would not touch, for an obstacle, and where the log has no snapshots.
pub fn parts(conflict: &LoggedConflict) -> Option<[Part; 2]> {
    let LoggedConflict { ego_x, ego_y, ego_heading, ego_length, ego_width, ego_path, ego_speed, .. } = conflict;
    let LoggedConflict { foe_x, foe_y, foe_heading, foe_length, foe_width, foe_path, foe_speed, .. } = conflict;
    let ego = Body::new([ego_x, ego_y, ego_heading, ego_length, ego_width], ego_path, *ego_speed)?;
    let foe = Body::new([foe_x, foe_y, foe_heading, foe_length, foe_width], foe_path, *foe_speed)?;
    let time = time_to_collision(&ego.motion(), &foe.motion())?;
    let [of_ego, of_foe] = [&ego, &foe].map(|body| body.motion().at(time));
    // Along the normal on which the two overlap least.
    let between = of_foe.centre - of_ego.centre;
    let room = |&(normal, reach): &(Vector, Metre)| normal.dot(&between).abs() - reach;
    let (normal, _) = normals(&of_ego, &of_foe).into_iter().max_by(|a, b| room(a).total_cmp(&room(b)))?;
    let towards_foe = normal * 1_f64.copysign(normal.dot(&between));
    Some([part_towards(&of_ego, towards_foe), part_towards(&of_foe, -towards_foe)])
}

/// The part of a rectangle that faces a direction.
fn part_towards(rectangle: &Rectangle, towards: Vector) -> Part {
    let (along, aside) = (rectangle.axis.dot(&towards), left_of(&rectangle.axis).dot(&towards));
    match (along.abs() >= aside.abs(), along > 0.0, aside > 0.0) {
        (true, true, _) => Part::Front,
        (true, false, _) => Part::Rear,
        (false, _, true) => Part::Left,
        (false, _, false) => Part::Right,
    }
}

/// One of the two at the worst step, and its path.
struct Body {
    poses: Vec<Pose>,
    speed: MetrePerSecond,
    length: Metre,
    width: Metre,
}

impl Body {
    fn new([x, y, heading, length, width]: [&Option<f64>; 5], path: &str, speed: MetrePerSecond) -> Option<Self> {
        let (length, width) = ((*length)?, (*width)?);
        let mut poses = vec![Pose { distance: 0.0, front: Point::new((*x)?, (*y)?), axis: direction((*heading)?) }];
        let numbers = path.split(' ').filter_map(|number| number.parse::<f64>().ok()).collect::<Vec<_>>();
        for point in numbers.chunks_exact(2) {
            let (last, front) = (poses[poses.len() - 1], Point::new(point[0], point[1]));
            let displacement = front - last.front;
            if let Some(axis) = displacement.try_normalize(0.0) {
                poses.push(Pose { distance: last.distance + displacement.norm(), front, axis });
            }
        }
        (length > 0.0 && width > 0.0).then_some(Self { poses, speed, length, width })
    }

    fn motion(&self) -> SteadyMotion<'_> {
        SteadyMotion {
            poses: &self.poses,
            speed: self.speed,
            deceleration: 0.0,
            length: self.length,
            width: self.width,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use closecall_run::output::sample_conflict::sample;

    /// The parts of two cars: x, y, heading, speed.
    fn parts_of(ego: [f64; 4], foe: [f64; 4], foe_path: &str) -> Option<[Part; 2]> {
        let [ego, foe] = [ego, foe].map(|values| values.map(|value| value.to_string()));
        let mut values = vec![("ego_path", ""), ("foe_path", foe_path)];
        values.extend(["ego_x", "ego_y", "ego_heading", "ego_speed"].into_iter().zip(ego.iter().map(|text| &**text)));
        values.extend(["foe_x", "foe_y", "foe_heading", "foe_speed"].into_iter().zip(foe.iter().map(|text| &**text)));
        values.extend([("ego_length", "5"), ("foe_length", "5"), ("ego_width", "2"), ("foe_width", "2")]);
        parts(&sample(&values).unwrap())
    }

    const NORTH: f64 = std::f64::consts::FRAC_PI_2;
    const WEST: f64 = std::f64::consts::PI;

    #[test]
    fn the_words_follow_from_where_the_rectangles_touch() {
        use Part::{Front, Left, Rear, Right};
        let ego = [0.0, 0.0, 0.0, 10.0];
        assert_eq!(parts_of(ego, [15.0, 0.0, 0.0, 5.0], ""), Some([Front, Rear]), "a leader");
        assert_eq!(parts_of(ego, [25.0, 0.0, WEST, 5.0], ""), Some([Front, Front]), "an oncoming one");
        assert_eq!(parts_of(ego, [20.0, -20.0, NORTH, 11.0], ""), Some([Front, Left]), "one from the right");
        assert_eq!(parts_of(ego, [3.0, -8.0, NORTH, 12.0], ""), Some([Right, Front]), "one that hits the flank");
        assert_eq!(parts_of(ego, [-4.0, -1.9, WEST, 1.0], ""), Some([Right, Right]), "one beside it");
        assert_eq!(parts_of(ego, [30.0, 20.0, -NORTH, 0.0], ""), None, "one elsewhere");
        let turns = "30.00 4.00 20.00 0.00 10.00 0.00";
        assert_eq!(parts_of(ego, [30.0, 12.0, -NORTH, 8.0], turns), Some([Front, Front]), "one that turns towards it");
    }

    #[test]
    fn one_that_draws_away_is_not_run_into() {
        assert_eq!(parts_of([0.0, 0.0, 0.0, 10.0], [15.0, 0.0, 0.0, 11.0], ""), None);
    }
}
