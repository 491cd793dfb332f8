//! Routes for a replay: an fcd-output does not have them, but where everybody drove.

use std::path::Path;
use std::sync::Arc;

use rustc_hash::{FxHashMap, FxHashSet};

use super::recording::{Recording, Step};
use crate::net::{EdgeFunction, EdgeIndex, Net};
use crate::{Error, Result};

/// The edges that each vehicle drove, in order; equal ones are held once.
#[derive(Clone, Debug, Default)]
pub struct Routes {
    by_vehicle: FxHashMap<String, Arc<[EdgeIndex]>>,
}

impl Routes {
    /// Reads a recording for its routes. What is cut short ends where it is cut.
    ///
    /// # Errors
    /// As [`Recording`] has them.
    pub fn read(path: &Path, net: &Net) -> Result<Self> {
        let mut recording = Recording::open(path)?;
        let mut step = Step::default();
        let mut driven: FxHashMap<String, Vec<EdgeIndex>> = FxHashMap::default();
        loop {
            match recording.next_step(&mut step) {
                Ok(true) => {}
                Ok(false) | Err(Error::CutShort { .. }) => break,
                Err(error) => return Err(error),
            }
            for row in step.rows().iter().filter(|row| !row.person) {
                let Some(lane) = net.lane(&row.lane) else { continue };
                let edge = net.lanes[lane.0 as usize].edge;
                if net.edges[edge.0 as usize].function != EdgeFunction::Normal {
                    continue;
                }
                match driven.get_mut(&row.id) {
                    Some(route) if route.last() == Some(&edge) => {}
                    Some(route) => route.push(edge),
                    None => {
                        driven.insert(row.id.clone(), vec![edge]);
                    }
                }
            }
        }
        let mut shared: FxHashSet<Arc<[EdgeIndex]>> = FxHashSet::default();
        let by_vehicle = driven.into_iter().map(|(id, route)| {
            let route: Arc<[EdgeIndex]> = route.into();
            let known = shared.get(&route).cloned();
            let route = known.unwrap_or_else(|| {
                shared.insert(route.clone());
                route
            });
            (id, route)
        });
        Ok(Self { by_vehicle: by_vehicle.collect() })
    }

    /// The route of a vehicle; empty where it was never on a normal edge.
    pub fn of(&self, id: &str) -> Arc<[EdgeIndex]> {
        self.by_vehicle.get(id).cloned().unwrap_or_else(|| Arc::new([]))
    }
}
