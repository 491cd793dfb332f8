//! Places by the names of their streets: an edge has that of its street, a junction those of the streets that meet there.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap;

use closecall::traffic::net::{EdgeFunction, Net};

/// A junction is named after this many streets.
const MEETING: usize = 3;

/// The names of the places of a net, by the page's words for a place.
#[derive(Debug, Default)]
pub(crate) struct Streets {
    names: FxHashMap<String, String>,
}

impl Streets {
    /// Those of a net; none where its edges have no names.
    pub fn of(net: &Net) -> Self {
        let mut names = FxHashMap::default();
        let mut meeting = FxHashMap::<_, BTreeMap<&str, usize>>::default();
        let named = net.edges.iter().filter(|edge| edge.function == EdgeFunction::Normal && !edge.street.is_empty());
        for edge in named {
            names.insert(format!("edge {}", edge.id), edge.street.to_string());
            for end in edge.ends {
                *meeting.entry(end).or_default().entry(&edge.street).or_default() += 1;
            }
        }
        // The edges within a junction know its name.
        for edge in net.edges.iter().filter(|edge| edge.function != EdgeFunction::Normal) {
            let Some(streets) = meeting.get(&edge.ends[0]).filter(|_| !edge.junction.is_empty()) else { continue };
            let mut streets = streets.iter().collect::<Vec<_>>();
            // The one with the most edges there is the main street.
            streets.sort_by_key(|(_, edges)| std::cmp::Reverse(**edges));
            let streets = streets.into_iter().take(MEETING).map(|(street, _)| *street).collect::<Vec<_>>();
            names.entry(format!("junction {}", edge.junction)).or_insert_with(|| streets.join(" / "));
        }
        Self { names }
    }

    /// The name of a place; none where it has none.
    pub fn name(&self, place: &str) -> Option<&str> {
        self.names.get(place).map(String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_junction_has_the_names_of_the_streets_that_meet_there() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../sumo_nets/side/side.net.xml");
        let text = std::fs::read_to_string(path).unwrap();
        let mut number = 0;
        let named = text.split_inclusive('\n').map(|line| match line.contains("<edge ") && line.contains(" from=") {
            true => {
                number += 1;
                line.replace("<edge ", &format!("<edge name=\"{} Street\" ", ["High", "Mill"][number % 2]))
            }
            false => line.to_owned(),
        });
        let net = closecall_run::net::parse(std::path::Path::new("named"), named.collect::<String>()).unwrap();
        let streets = Streets::of(&net);
        let of = |is: fn(EdgeFunction) -> bool| net.edges.iter().find(|edge| is(edge.function)).unwrap();
        let edge = of(|function| function == EdgeFunction::Normal);
        assert_eq!(streets.name(&format!("edge {}", edge.id)), Some(edge.street.as_str()));
        let junction = &of(|function| function == EdgeFunction::Internal).junction;
        assert_eq!(streets.name(&format!("junction {junction}")), Some("High Street / Mill Street"));
        let unnamed = closecall_run::net::parse(std::path::Path::new("unnamed"), text).unwrap();
        assert_eq!(Streets::of(&unnamed).name(&format!("junction {junction}")), None);
    }
}
