//! Whether a driver's line of sight to the end of a queue leaves the road, so that the queue ended behind a curve.
//!
//! The offset of the line is the horizontal sightline offset of A Policy on Geometric Design of Highways and Streets (AASHTO's
//! Green Book): R (1 − cos(28.65° S / R)) on a curve of radius R that is longer than the sight distance S. Here it is measured
//! from the path itself, so that it holds for every curve.

use super::pair::Pair;
use crate::geometry::Point;
use crate::traffic::net::{Direction, EdgeFunction, Net};
use crate::util::units::Metre;

/// Obstructions stand at least this far beside a road, in m: 18 in from the kerb (AASHTO's Green Book of 2001, chapter 5).
const BESIDE_THE_ROAD: Metre = 0.45;

/// Whether the straight line from the ego's front bumper to where it would touch the foe leaves the road.
///
/// A turn at a junction does not count as a curve: the corner between its roads is kept free for the drivers' sight there.
pub(super) fn is_behind_curve(pair: &Pair) -> bool {
    let Some(net) = pair.around.net else { return false };
    let ahead = (pair.around.path)(pair.found.ego_row);
    let Some((offset, place)) = sightline_offset(&ahead, pair.ego.to_meeting) else { return false };
    offset > BESIDE_THE_ROAD && is_beside_the_road(net, pair, place) && !turns(net, pair)
}

/// How far the straight line from the begin of a path to the point this far along it is from the path at most, and where on
/// that line that is.
fn sightline_offset(path: &[Point], reach: Metre) -> Option<(Metre, Point)> {
    let first = *path.first()?;
    let mut left = reach;
    let mut seen = Vec::new();
    for ends in path.windows(2) {
        let piece = ends[1] - ends[0];
        let length = piece.norm();
        if length >= left {
            seen.push(ends[0] + piece * (left / length.max(f64::MIN_POSITIVE)));
            break;
        }
        seen.push(ends[1]);
        left -= length;
    }
    let line = *seen.last()? - first;
    let offsets = seen.iter().map(|point| {
        let along = (point - first).dot(&line) / line.norm_squared().max(f64::MIN_POSITIVE);
        let place = first + line * along.clamp(0.0, 1.0);
        ((point - place).norm(), place)
    });
    offsets.max_by(|one, other| one.0.total_cmp(&other.0))
}

/// Whether a place is on no lane and in no junction of the ego's way.
fn is_beside_the_road(net: &Net, pair: &Pair, place: Point) -> bool {
    let within =
        pair.ego.course.stretches.iter().filter(|stretch| net.function(stretch.lane) == EdgeFunction::Internal);
    let mut junctions = within.map(|stretch| net.edges[net.lanes[stretch.lane].edge].ends[0]);
    net.lanes_at(place, BESIDE_THE_ROAD).next().is_none()
        && !junctions.any(|junction| net.is_near(junction, place, BESIDE_THE_ROAD))
}

/// Whether the ego turns before the conflict point where ways cross or join.
fn turns(net: &Net, pair: &Pair) -> bool {
    let ahead =
        pair.ego.course.stretches.iter().filter(|stretch| stretch.end > 0.0 && stretch.begin < pair.ego.to_meeting);
    let mut passages = ahead.filter_map(|stretch| net.passage(stretch.lane));
    passages.any(|passage| {
        passage.direction != Direction::Straight && net.junctions[passage.junction as usize].has_foes(passage.link)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An arc of this radius and length in m, as points 0.1 m apart.
    fn arc(radius: f64, length: f64) -> Vec<Point> {
        let angles = (0..=(length * 10.0) as u32).map(|number| f64::from(number) / 10.0 / radius);
        angles.map(|angle| Point::new(radius * angle.sin(), radius * (1.0 - angle.cos()))).collect()
    }

    #[test]
    fn the_offset_on_an_arc_is_that_of_the_green_book() {
        for (radius, distance) in [(60.0, 50.0), (30.0, 20.0), (200.0, 85.0)] {
            let (offset, _) = sightline_offset(&arc(radius, 100.0), distance).unwrap();
            let expected = radius * (1.0 - (28.65 * distance / radius).to_radians().cos());
            assert!((offset - expected).abs() < 0.01, "{offset} {expected}");
        }
    }

    #[test]
    fn a_straight_path_has_no_offset() {
        let straight = [0.0, 10.0, 40.0].map(|x| Point::new(x, 0.0));
        assert_eq!(sightline_offset(&straight, 25.0).map(|(offset, _)| offset), Some(0.0));
        assert_eq!(sightline_offset(&[], 25.0), None);
    }
}
