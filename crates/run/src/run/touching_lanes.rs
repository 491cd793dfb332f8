//! On which lanes two road users touch: those under their nearest parts. The front bumper's lane is often another one: the tail
//! of a bus may still be in the junction.

use closecall::detection::path::Foot;
use closecall::events::{Conflict, Snapshot};
use closecall::geometry::Point;
use closecall::geometry::rectangle::direction;
use closecall::traffic::net::{EdgeFunction, Lane, LaneIndex, Net};
use closecall::traffic::profile::Category;
use closecall::traffic::roster::Roster;
use closecall::util::units::Metre;

/// The distance of the places that are looked at, in m.
const STEP: Metre = 0.5;
/// A person may be this far beside a pavement or a walking area, in m.
const BESIDE: Metre = 0.3;
/// The number of lanes around one after which a search ends.
const MOST_LANES: usize = 200;
/// The length of a shorter lane counts as this, in m, so that a search along lanes ends.
const SHORTEST: Metre = 0.1;

/// The lanes of the ego and the foe where they touch; none where one of them is on no lane.
pub(super) fn touching_lanes(net: &Net, conflict: &Conflict, roster: &Roster) -> Option<[LaneIndex; 2]> {
    let Conflict { ego_snapshot, foe_snapshot, ego_profile, foe_profile, .. } = conflict;
    // Before they touch, it is the paths that show where they will.
    let is_ahead = conflict.gap > 0.0;
    let category = |profile| roster.profile_at(profile).category;
    let [ego_lane, foe_lane] = conflict.lanes;
    let mut ego = places(net, ego_snapshot, category(*ego_profile), ego_lane, is_ahead)?;
    let foe = places(net, foe_snapshot, category(*foe_profile), foe_lane, is_ahead)?;
    let at = Point::new(conflict.x, conflict.y);
    let is_there = |place: &Place| (place.0 - at).norm() <= ego_snapshot.length.max(STEP);
    if is_ahead && ego.iter().any(is_there) {
        ego.retain(is_there);
    }
    let pairs = ego.iter().flat_map(|one| foe.iter().map(move |other| (one, other)));
    let nearest = pairs.min_by(|a, b| (a.0.0 - a.1.0).norm_squared().total_cmp(&(b.0.0 - b.1.0).norm_squared()));
    nearest.map(|(one, other)| [one.1, other.1])
}

/// A place and the lane that it is on.
type Place = (Point, LaneIndex);

/// The places along a road user's middle, from its rear, and along its path if that is wanted.
fn places(
    net: &Net,
    of: &Snapshot,
    category: Category,
    known: Option<LaneIndex>,
    with_path: bool,
) -> Option<Vec<Place>> {
    if category == Category::Person {
        return Some(vec![(of.front, lane_on_foot(net, of.front)?)]);
    }
    let lane = known.or_else(|| net.lane_at(of.front))?;
    let ahead: &[Point] = if with_path { &of.path } else { &[] };
    let rear = of.front - direction(of.heading) * of.length;
    let line = [rear, of.front].into_iter().chain(ahead.iter().copied()).collect::<Vec<_>>();
    let position = Foot::on_any_part(net.lines.line(lane.0), of.front).distance;
    let travelled = line[1..].windows(2).map(|ends| (ends[1] - ends[0]).norm()).sum::<Metre>();
    let before = |lane: &Lane| lane.from.clone();
    let after = |lane: &Lane| lane.links.iter().map(|link| link.via.unwrap_or(link.to)).collect();
    let mut lanes = reached(net, lane, of.length - position, before);
    lanes.extend(reached(net, lane, travelled - (net.lines.length(lane.0) - position), after));
    let away = |lane: LaneIndex, place: Point| (Foot::on_any_part(net.lines.line(lane.0), place).point - place).norm();
    let on = |place: Point| lanes.iter().copied().min_by(|a, b| away(*a, place).total_cmp(&away(*b, place)));
    Some(along(&line).filter_map(|place| Some((place, on(place)?))).collect())
}

/// The walking area or pavement at a place, or else the crossing.
fn lane_on_foot(net: &Net, place: Point) -> Option<LaneIndex> {
    // The shape of a walking area is its outline, that of other lanes their middle.
    let is_on_foot =
        |lane: &LaneIndex| net.function(*lane) != EdgeFunction::WalkingArea && !net.lanes[*lane].has_vehicles;
    let lanes = net.lanes_at(place, BESIDE).filter(is_on_foot);
    let pavement = lanes.min_by_key(|lane| (net.function(*lane) == EdgeFunction::Crossing, *lane));
    pavement
        .filter(|lane| net.function(*lane) == EdgeFunction::Normal)
        .or_else(|| net.walking_area_at(place))
        .or(pavement)
}

/// A lane and those that are reached from its end within a distance.
fn reached(net: &Net, from: LaneIndex, within: Metre, next: impl Fn(&Lane) -> Vec<LaneIndex>) -> Vec<LaneIndex> {
    let mut reached = vec![(from, 0.0)];
    let mut at = 0;
    while let Some(&(lane, travelled)) = reached.get(at).filter(|_| reached.len() < MOST_LANES) {
        at += 1;
        for next in next(&net.lanes[lane]).into_iter().filter(|_| travelled < within) {
            if reached.iter().all(|(known, _)| *known != next) {
                reached.push((next, travelled + net.lanes[next].length.max(SHORTEST)));
            }
        }
    }
    reached.into_iter().map(|(lane, _)| lane).collect()
}

/// Places along a line, its ends among them.
fn along(line: &[Point]) -> impl Iterator<Item = Point> {
    let pieces = line.windows(2).flat_map(|ends| {
        let displacement = ends[1] - ends[0];
        let steps = (displacement.norm() / STEP).ceil().max(1.0);
        (0..steps as usize).map(move |step| ends[0] + displacement * (step as f64 / steps))
    });
    pieces.chain(line.last().copied())
}
