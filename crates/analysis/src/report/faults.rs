//! The faults of the net, of all logs: a pair of lanes once.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::{Error, Result};
use closecall_run::output::net_faults_csv::{NET_FAULTS, NetFault, sort};
use closecall_run::util::csv_safe::plain;

/// The page has the worst, this many.
const MOST: usize = 500;

/// The faults in the logs, the worst first.
///
/// # Errors
/// [`Error::file`] or [`Error::content`] that names a file that cannot be read.
pub fn json(logs: &[PathBuf]) -> Result<Value> {
    let mut faults = BTreeMap::<[String; 2], NetFault>::new();
    for log in logs.iter().map(|log| log.join(NET_FAULTS)).filter(|file| file.is_file()) {
        for fault in read(&log)? {
            let lanes = [fault.lane.clone(), fault.other_lane.clone()];
            match faults.get_mut(&lanes) {
                Some(known) => add(known, fault),
                None => drop(faults.insert(lanes, fault)),
            }
        }
    }
    let mut faults = faults.into_values().collect::<Vec<_>>();
    sort(&mut faults);
    let count = faults.len();
    faults.truncate(MOST);
    Ok(json!({ "count": count, "worst": faults }))
}

fn read(path: &Path) -> Result<Vec<NetFault>> {
    let fault = |error: csv::Error| Error::content(path, error.to_string());
    let rows = csv::Reader::from_path(path).map_err(fault)?.into_deserialize::<NetFault>();
    let unsafe_again = |row: NetFault| {
        let [lane, other_lane, junction] =
            [&row.lane, &row.other_lane, &row.junction].map(|cell| plain(cell).to_owned());
        NetFault { lane, other_lane, junction, ..row }
    };
    rows.map(|row| row.map(unsafe_again).map_err(fault)).collect()
}

/// Adds the same fault of another run, in which road users are others.
fn add(known: &mut NetFault, other: NetFault) {
    known.times += other.times;
    known.conflicts += other.conflicts;
    known.road_users += other.road_users;
    if other.overlap > known.overlap {
        let NetFault { overlap, x, y, .. } = other;
        (known.overlap, known.x, known.y) = (overlap, x, y);
    }
}
