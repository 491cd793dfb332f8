//! Logs as the page needs them: the record of each, and its conflicts as [`Row`]s.

use std::path::Path;

use super::rows::{Row, Snapshot};
use crate::analysis::logged::{self, ConflictReader, LoggedConflict, LoggedSnapshot, PARQUET};
use crate::detection::kind::{Kind, Severity};
use crate::output::log::RUN;
use crate::{Error, Result};

/// A log's `run.json`; null where there is none.
pub fn record(log: &Path) -> Result<serde_json::Value> {
    if !log.join(RUN).is_file() && !log.join(PARQUET).is_file() {
        return Ok(serde_json::Value::Null);
    }
    let (path, text) = logged::record(log)?;
    serde_json::from_str(&text).map_err(|error| Error::content(&path, format!("it is no JSON: {error}")))
}

/// Passes on the conflicts of a log, in their order.
pub fn rows(log: &Path, mut take: impl FnMut(Row)) -> Result<()> {
    ConflictReader::open(log)?.with_snapshots().try_for_each(|conflict| {
        take(row(conflict?));
        Ok(())
    })
}

fn row(conflict: LoggedConflict) -> Row {
    let numbers = [
        Some(conflict.begin),
        Some(conflict.end),
        Some(conflict.time),
        Some(conflict.gap),
        Some(conflict.mu),
        Some(conflict.margin),
        conflict.ttc,
        conflict.drac,
        conflict.pet,
        Some(conflict.delta_v),
        Some(conflict.ego_speed),
        Some(conflict.foe_speed),
        Some(conflict.angle),
        Some(conflict.x),
        Some(conflict.y),
    ];
    Row {
        run: 0,
        id: conflict.id,
        kind: place(&Kind::ALL, conflict.kind),
        severity: place(&Severity::ALL, conflict.severity),
        collision: conflict.collision,
        numbers,
        ids: [conflict.ego.into(), conflict.foe.into()],
        types: [conflict.ego_type.into(), conflict.foe_type.into()],
        lane: conflict.lane.into(),
        snapshots: conflict.snapshots.map(|snapshots| Box::new(snapshots.map(stance))),
    }
}

fn stance(stance: LoggedSnapshot) -> Snapshot {
    let LoggedSnapshot { x, y, heading, length, width, path } = stance;
    Snapshot { numbers: [x, y, heading, length, width], path: path.into() }
}

fn place<T: PartialEq>(all: &[T], one: T) -> u8 {
    all.iter().position(|known| *known == one).unwrap_or_default() as u8
}
