//! The route of a vehicle, from its recorded edges, route files and the net.
//!
//! Recorded edges decide. Edges that no step shows come from the route in a route file, if it joins the edges seen, otherwise
//! from the only shortest connection. A vehicle that is on the route of the file when it is last seen follows it to its end.

use super::connections::{Connections, length};
use super::drive::{NEVER, Reached};
use closecall::traffic::net::{EdgeIndex, Net};
use closecall::util::units::Metre;

/// A complete route.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Completed {
    /// Each edge, with the number of the step in which it was reached.
    pub edges: Vec<(EdgeIndex, u32)>,
    /// The number of places where nothing tells which edges were driven.
    pub gaps: u64,
}

/// Completes a route; `planned` is that of the route file, empty if none names it.
pub(super) fn complete(
    reached: &[Reached],
    planned: &[EdgeIndex],
    net: &Net,
    connections: &mut Connections,
) -> Completed {
    let mut completed = Completed::default();
    let edges = &mut completed.edges;
    // The planned edges that are still ahead, and whether the vehicle is on the edge before them.
    let mut ahead = planned;
    let mut is_as_planned = false;
    for Reached { edge, step, unseen } in reached.iter().copied() {
        let place = ahead.iter().position(|planned| *planned == edge);
        if let Some((last, _)) = edges.last().copied() {
            let as_planned = place.filter(|_| is_as_planned).map(|place| &ahead[..place]);
            let is_near =
                |skipped: &&[EdgeIndex]| skipped.iter().map(|edge| length(net, *edge)).sum::<Metre>() <= unseen;
            let connection = match as_planned.filter(is_near) {
                Some(_) => None,
                None => connections.between(net, last, edge, unseen),
            };
            match connection.as_deref().or(as_planned) {
                Some(between) => edges.extend(between.iter().map(|edge| (*edge, step))),
                None => completed.gaps += 1,
            }
        }
        edges.push((edge, step));
        is_as_planned = place.is_some();
        ahead = place.map_or(ahead, |place| &ahead[place + 1..]);
    }
    if is_as_planned {
        edges.extend(ahead.iter().map(|edge| (*edge, NEVER)));
    }
    completed
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::input::replay::complete_route::*;

    /// A street a b c d e, each 40 m, with a turnaround from each edge onto the edge back, A to E, and a side street x
    /// from a to d.
    fn net() -> Net {
        let mut text = "<net>".to_owned();
        for id in "abcdeABCDEx".chars() {
            text += &format!(r#"<edge id="{id}"><lane id="{id}_0" length="40" shape="0,0 9,0"/></edge>"#);
        }
        for link in "ab bc cd de ED DC CB BA aA bB cC dD eE Aa Bb Cc Dd Ee ax xd".split(' ') {
            let (from, to) = link.split_at(1);
            text += &format!(r#"<connection from="{from}" to="{to}" fromLane="0" toLane="0"/>"#);
        }
        crate::net::parse(Path::new("net"), text + "</net>").unwrap()
    }

    /// The route that follows from edges seen one step after the other, with dots for steps in which none was seen. Edges that
    /// the vehicle was not seen to reach are in brackets.
    fn route(seen: &str, planned: &str) -> (String, u64) {
        let net = net();
        let edge = |id: char| net.edge(&id.to_string()).unwrap();
        let mut reached = Vec::new();
        let mut unseen = 0.0;
        for (step, id) in (0..).zip(seen.chars()) {
            unseen += 50.0;
            if id != '.' {
                reached.push(Reached { edge: edge(id), step, unseen });
                unseen = 0.0;
            }
        }
        let planned = planned.chars().map(edge).collect::<Vec<_>>();
        let completed = complete(&reached, &planned, &net, &mut Connections::default());
        let mut told = String::new();
        let mut last = None;
        for (edge, step) in &completed.edges {
            let id = &net.edges[*edge].id;
            let is_seen = reached.iter().any(|reached| (reached.edge, reached.step) == (*edge, *step));
            told += &if is_seen {
                id.clone()
            } else if *step == NEVER {
                format!("({id})")
            } else {
                format!("[{id}]")
            };
            assert!(last <= Some(*step), "{told}");
            last = Some(*step);
        }
        (told, completed.gaps)
    }

    fn told(seen: &str, planned: &str) -> String {
        let (told, gaps) = route(seen, planned);
        assert_eq!(gaps, 0, "{told}");
        told
    }

    #[test]
    fn edges_that_no_step_shows_are_those_of_the_file_or_the_only_connection() {
        assert_eq!(told("ac", ""), "a[b]c");
        assert_eq!(told("a.d", "abcd"), "a[b][c]d", "x is shorter");
        assert_eq!(told("a.d", ""), "a[x]d");
        assert_eq!(told("b.D", ""), "b[c][d]D");
    }

    #[test]
    fn the_route_of_the_file_goes_on_where_the_recording_ends() {
        assert_eq!(told("ab", "abcde"), "ab(c)(d)(e)");
        assert_eq!(told("b", "abcde"), "b(c)(d)(e)", "it began on the way");
        assert_eq!(told("abB", "abcde"), "abB", "it turned");
        assert_eq!(told("axd", "abcde"), "axd(e)", "it went another way and came back");
        assert_eq!(told("cC", "ab"), "cC", "another route");
    }

    #[test]
    fn a_link_beats_a_file_whose_edges_are_too_long_to_be_unseen() {
        assert_eq!(told("ab", "aAab"), "ab", "80 m are more than 50 m");
        assert_eq!(told("a.b", "aAab"), "a[A][a]b");
    }

    #[test]
    fn a_gap_that_nothing_closes_is_counted() {
        assert_eq!(route("aE", "abc"), ("aE".to_owned(), 1));
    }
}
