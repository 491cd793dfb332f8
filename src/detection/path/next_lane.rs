//! The lane that a path takes next.

use crate::traffic::net::{EdgeFunction, EdgeIndex, Lane, LaneIndex, Link, Net};
use crate::util::units::Metre;

/// How many edges ahead lanes are compared by how far they lead along the route.
const EDGES_AHEAD: usize = 9;

/// The link that leads on from a lane, towards the edges that are ahead on the route. Without a route (`is_free`) any
/// edge may come next.
pub(super) fn next_link<'a>(net: &'a Net, lane: LaneIndex, ahead: &[EdgeIndex], is_free: bool) -> Option<&'a Link> {
    let Lane { links, edge, .. } = &net.lanes[lane];
    let inside = net.edges[*edge].function == EdgeFunction::Internal;
    let wanted = ahead.first();
    if wanted.is_none() && !inside && !is_free {
        return None;
    }
    let mut leading = links.iter().filter(|link| inside || wanted.is_none_or(|edge| edge_of(net, link.to) == *edge));
    if links.len() < 2 {
        return leading.next();
    }
    let compared = &ahead[..ahead.len().min(EDGES_AHEAD)];
    let worth = |link: &Link| match wanted {
        Some(_) => continuation(net, compared, link.to),
        None => straightness(net, lane, link.via.unwrap_or(link.to)),
    };
    let best =
        leading.map(|link| (link, worth(link))).reduce(|best, next| if best.1 >= next.1 { best } else { next })?;
    Some(best.0)
}

/// Whether a lane is on the route, given the edges of the route from the current one on.
pub(super) fn is_on_route(net: &Net, lane: &Lane, route: &[EdgeIndex]) -> bool {
    if net.edges[lane.edge].function == EdgeFunction::Normal {
        return route.first() == Some(&lane.edge);
    }
    lane.links.first().is_some_and(|link| route.get(1) == Some(&edge_of(net, link.to)))
}

/// The edge of a lane.
pub(super) fn edge_of(net: &Net, lane: LaneIndex) -> EdgeIndex {
    net.lanes[lane].edge
}

/// How far a lane of the first edge of a route leads along the route without a lane change (SUMO's criterion for
/// choosing lanes).
fn continuation(net: &Net, route: &[EdgeIndex], lane: LaneIndex) -> Metre {
    let here = &net.lanes[lane];
    let beyond = match route {
        [_, rest @ ..] if !rest.is_empty() => here
            .links
            .iter()
            .filter(|link| edge_of(net, link.to) == rest[0])
            .map(|link| continuation(net, rest, link.to))
            .fold(0.0, f64::max),
        _ => 0.0,
    };
    here.length + beyond
}

/// The cosine of the turn from a lane to the next: 1 straight on, −1 for a U-turn.
fn straightness(net: &Net, lane: LaneIndex, next: LaneIndex) -> f64 {
    let here = &net.lanes[lane].shape;
    let there = &net.lanes[next].shape;
    let (Some([a, b]), Some([c, .., d])) = (here.last_chunk::<2>(), Some(there.as_slice())) else { return 0.0 };
    let out = b - a;
    let on = d - c;
    out.dot(&on) / (out.norm() * on.norm()).max(f64::MIN_POSITIVE)
}
