//! `net_faults.csv`: the pairs of lanes at which SUMO drives road users through each other, to help mend the net.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::util::csv_safe::safe;
use crate::util::output_file;
use crate::{Error, Result};
use closecall::util::remark::{Remark, RemarkCode};
use closecall::util::units::{Metre, counted};

/// The name of the file.
pub const NET_FAULTS: &str = "net_faults.csv";

/// Why SUMO lets road users on two lanes overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FaultKind {
    /// A lane of vehicles lies on where persons walk or stand.
    OnFoot,
    /// A vehicle waits inside a junction where others pass.
    WaitsInside,
    /// Two links of one junction are not each other's foes.
    NotFoes,
    /// Two lanes have room beside each other, and vehicles are wider than they are.
    NarrowLane,
    /// Two lanes of different edges cross where no junction is.
    NoJunction,
    /// Two lanes of different edges are too near to each other.
    TooNear,
}

impl FaultKind {
    /// What is wrong, and how it could be mended.
    pub(crate) fn remedy(self) -> &'static str {
        match self {
            Self::OnFoot => {
                "vehicles drive over where persons walk or wait: a larger junction (netconvert --default.junctions.radius), \
                 or another shape of the walking area, crossing or connection"
            }
            Self::WaitsInside => {
                "a vehicle stands where others pass: a place to wait further back (contPos of the connection, netconvert \
                 --internal-junctions.vehicle-width), or a larger junction (--default.junctions.radius)"
            }
            Self::NotFoes => {
                "two links of the junction are no foes but lie on each other: a larger junction (netconvert \
                 --default.junctions.radius), smoother links (--junctions.internal-link-detail), or another shape of the \
                 connections"
            }
            Self::NarrowLane => {
                "vehicles need more room than their lanes have: wider lanes (width, netconvert --default.lanewidth), or \
                 lanes that are closed to wide vehicles"
            }
            Self::NoJunction => {
                "lanes cross where no junction is: a node there (netconvert --junctions.join where two lie on each other), \
                 or heights for a bridge"
            }
            Self::TooNear => {
                "lanes of different edges lie on each other: other lane widths (netconvert --default.lanewidth), spreadType \
                 or geometry (--geometry.avoid-overlap at junctions)"
            }
        }
    }
}

/// A pair of lanes at which SUMO drives road users through each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NetFault {
    /// One lane.
    pub lane: String,
    /// The other.
    pub other_lane: String,
    /// The junction of one of them; empty outside junctions.
    pub junction: String,
    /// Why it happens.
    pub fault: FaultKind,
    /// How often it happens: a standing road user counts once, however many pass it.
    pub times: u64,
    /// The conflicts in the log.
    pub conflicts: u64,
    /// Distinct road users.
    pub road_users: u64,
    /// The deepest overlap, in m.
    pub overlap: Metre,
    /// The conflict with that overlap, by its number in the log.
    pub deepest: u64,
    /// Where that is, x in m.
    pub x: Metre,
    /// The same, y in m.
    pub y: Metre,
    /// How it could be mended.
    pub remedy: String,
}

/// The faults in the order of the file: what happens most often first, then the deepest.
pub fn sort(faults: &mut [NetFault]) {
    faults.sort_by(|a, b| {
        let lanes = |of: &NetFault| [of.lane.clone(), of.other_lane.clone()];
        b.times.cmp(&a.times).then(b.overlap.total_cmp(&a.overlap)).then_with(|| lanes(a).cmp(&lanes(b)))
    });
}

/// Writes the file of a log, whole or not at all; `is_safe` where no cell is to be one that a spreadsheet would run.
///
/// # Errors
/// [`Error::File`] where it cannot be written.
pub fn write(folder: &Path, faults: &[NetFault], is_safe: bool) -> Result<()> {
    let path = folder.join(NET_FAULTS);
    let mut rows = csv::Writer::from_writer(Vec::new());
    let cell = |text: &str| if is_safe { safe(text, &mut String::new()).to_owned() } else { text.to_owned() };
    let fault = |error: csv::Error| Error::content(&path, error.to_string());
    for row in faults {
        let [lane, other_lane, junction] = [&row.lane, &row.other_lane, &row.junction].map(|text| cell(text));
        rows.serialize(NetFault { lane, other_lane, junction, ..row.clone() }).map_err(fault)?;
    }
    let bytes = rows.into_inner().map_err(|error| Error::content(&path, error.to_string()))?;
    output_file::write(&path, &bytes)
}

/// Two lines for the user: how many faults there are, and the worst; none without any.
pub fn in_words(faults: &[NetFault], road_users: usize, folder: Option<&Path>) -> Vec<Remark> {
    let Some(worst) = faults.first() else { return Vec::new() };
    let times = faults.iter().map(|fault| fault.times).sum::<u64>();
    let pairs = counted(faults.len() as u64, "pair");
    let file = folder.map_or_else(String::new, |folder| format!(": {}", folder.join(NET_FAULTS).display()));
    let NetFault { lane, other_lane, overlap, remedy, .. } = worst;
    let lines = [
        format!(
            "net faults: at {pairs} of lanes SUMO drives road users through each other, {} with {}{file}",
            counted(times, "time"),
            counted(road_users as u64, "road user")
        ),
        format!(
            "the worst is {lane} and {other_lane}, {}, {overlap:.2} m deep: {remedy}",
            counted(worst.times, "time")
        ),
    ];
    lines.map(|text| Remark::new(RemarkCode::NetFaults, text)).into()
}
