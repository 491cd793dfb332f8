//! How conflicts are grouped.

use std::borrow::Cow;

use serde::Serialize;

use crate::filter::NamedPlaces;
use crate::logged::LoggedConflict;
use closecall::detection::kind::{Kind, Severity};

/// How conflicts are grouped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum By {
    /// Rear-end, frontal, side.
    #[default]
    Kind,
    /// Caution, serious, critical.
    Severity,
    /// The edge of the conflict point.
    Edge,
    /// The junction of the conflict point; conflicts outside junctions are one group.
    Junction,
    /// The vehicle types, the ego's first.
    Type,
    /// What the two were doing.
    Manoeuvre,
    /// Why it came about, by the strongest evidence.
    Cause,
    /// The place of --places; conflicts elsewhere are one group.
    Place,
    /// The simulated hour in which the margin was smallest.
    Hour,
}

/// The group of conflicts without an edge, junction, manoeuvre or cause.
const NOWHERE: &str = "(none)";

impl By {
    /// The columns that it needs; logs of earlier versions may lack them.
    pub fn columns(self) -> &'static [&'static str] {
        match self {
            Self::Kind => &["kind"],
            Self::Severity => &["severity"],
            Self::Edge | Self::Junction => &["lane"],
            Self::Type => &["ego_type", "foe_type"],
            Self::Manoeuvre => &["manoeuvre"],
            Self::Cause => &["cause"],
            Self::Place => &["lane", "x", "y"],
            Self::Hour => &["time"],
        }
    }

    /// The group of a conflict, at the named places if it is by place.
    pub fn group<'a>(self, conflict: &'a LoggedConflict, named: Option<&'a NamedPlaces>) -> Cow<'a, str> {
        let place = |name: &'a str| if name.is_empty() { NOWHERE } else { name };
        match self {
            Self::Kind => conflict.kind.name().into(),
            Self::Severity => conflict.severity.name().into(),
            Self::Edge => place(conflict.edge()).into(),
            Self::Junction => place(conflict.junction()).into(),
            Self::Manoeuvre => place(&conflict.manoeuvre).into(),
            Self::Cause => place(conflict.cause.split(' ').next().unwrap_or_default()).into(),
            Self::Type => format!("{}/{}", plain(&conflict.ego_type), plain(&conflict.foe_type)).into(),
            Self::Place => named.and_then(|named| named.of(conflict)).map_or(NOWHERE, |place| &place.name).into(),
            Self::Hour => ((conflict.time / 3600.0).floor() as i64).to_string().into(),
        }
    }

    /// Sorts groups for a table: kinds, severities and hours in their natural order, the others by count.
    pub fn sort<T>(self, groups: &mut [T], name: impl Fn(&T) -> &str, count: impl Fn(&T) -> u64) {
        let rank = |group: &T| -> i64 {
            let of = |place: Option<usize>| place.map_or(i64::MAX, |place| place as i64);
            match self {
                Self::Kind => of(Kind::ALL.iter().position(|kind| kind.name() == name(group))),
                Self::Severity => of(Severity::ALL.iter().position(|severity| severity.name() == name(group))),
                Self::Hour => name(group).parse().unwrap_or(i64::MAX),
                Self::Edge | Self::Junction | Self::Type | Self::Manoeuvre | Self::Cause | Self::Place => {
                    -(count(group) as i64)
                }
            }
        };
        groups.sort_by(|a, b| (rank(a), name(a)).cmp(&(rank(b), name(b))));
    }
}

/// The type's own name: SUMO calls a type that was changed for one vehicle "type@vehicle".
fn plain(type_name: &str) -> &str {
    type_name.split_once('@').map_or(type_name, |(plain, _)| plain)
}
