//! A part of the net: a SUMO selection file (`edge:ID`, `junction:ID`, `lane:ID` lines) as a set of lanes.

use std::path::Path;

use typed_index_collections::TiVec;

use crate::util::input_file;
use crate::{Error, Result};
use closecall::traffic::net::{EdgeFunction, EdgeIndex, LaneIndex, Net};

/// A part of the net.
#[derive(Clone, Debug)]
pub struct Filter {
    holds: TiVec<LaneIndex, bool>,
}

impl Filter {
    /// Reads a selection file.
    ///
    /// # Errors
    /// An error that names the file and line: unreadable, an unknown kind of object, an id that the net does not have.
    pub fn read(path: &Path, net: &Net) -> Result<Self> {
        Self::parse(path, &input_file::text(path)?, net)
    }

    /// Reads a selection from a text; `path` names it in errors.
    ///
    /// # Errors
    /// As for [`Filter::read`].
    pub fn parse(path: &Path, text: &str, net: &Net) -> Result<Self> {
        let mut filter = Self { holds: vec![false; net.lanes.len()].into() };
        for (line, text) in (1..).zip(text.lines()) {
            let text = text.trim();
            if text.is_empty() {
                continue;
            }
            let wrong = |message: String| Error::line(path, line, message);
            let (kind, id) = text
                .split_once(':')
                .ok_or_else(|| wrong(format!("\"{text}\" is not edge:ID, junction:ID or lane:ID")))?;
            let unknown = || wrong(format!("the net has no {kind} \"{id}\""));
            match kind {
                "edge" => filter.add_edge(net, net.edge(id).ok_or_else(unknown)?),
                "lane" => filter.add(net.lane(id).ok_or_else(unknown)?),
                "junction" => {
                    if !net.junctions.iter().any(|junction| junction.id == id) {
                        return Err(unknown());
                    }
                    for (index, edge) in net.edges.iter_enumerated() {
                        if edge.function != EdgeFunction::Normal && edge.junction == id {
                            filter.add_edge(net, index);
                        }
                    }
                }
                _ => return Err(wrong(format!("\"{text}\" is not edge:ID, junction:ID or lane:ID"))),
            }
        }
        Ok(filter)
    }

    /// Whether the filter holds a lane; a place without a lane is not held.
    pub fn holds(&self, lane: Option<LaneIndex>) -> bool {
        lane.is_some_and(|lane| self.holds[lane])
    }

    fn add_edge(&mut self, net: &Net, edge: EdgeIndex) {
        for &lane in &net.edges[edge].lanes {
            self.add(lane);
        }
    }

    fn add(&mut self, lane: LaneIndex) {
        self.holds[lane] = true;
    }
}
