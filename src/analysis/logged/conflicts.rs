//! The conflicts of a log one by one, whatever file they are in.

use serde::{Deserialize, Serialize};

use crate::detection::kind::{Kind, Severity};
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Radian, Second};

/// A row of `conflicts.csv`; docs/log.md says what each column is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoggedConflict {
    /// 1, 2, 3, … in the order of the file.
    pub id: u64,
    /// SUMO's id of the ego.
    pub ego: String,
    /// SUMO's id of the foe.
    pub foe: String,
    /// The kind at the smallest margin.
    pub kind: Kind,
    /// The worst over the event.
    pub severity: Severity,
    /// First step with margin < 0, in s.
    pub begin: Second,
    /// Last step with margin < 0, in s.
    pub end: Second,
    /// The step with the smallest margin, in s.
    pub time: Second,
    /// The room that was left, in m.
    pub gap: Metre,
    /// The minimal collision distance, in m.
    pub mu: Metre,
    /// gap − μ, in m.
    pub margin: Metre,
    /// Smallest distance between the two rectangles, in m.
    pub clearance: Metre,
    /// Smallest time to collision, in s.
    pub ttc: Option<Second>,
    /// Largest deceleration rate to avoid the collision, in m/s².
    pub drac: Option<MetrePerSecondSquared>,
    /// Post-encroachment time, in s.
    pub pet: Option<Second>,
    /// Speed change of the ego in a fully inelastic collision, in m/s.
    pub delta_v: MetrePerSecond,
    /// Speed of the ego, in m/s.
    pub ego_speed: MetrePerSecond,
    /// Speed of the foe, in m/s.
    pub foe_speed: MetrePerSecond,
    /// Angle between the headings at the meeting place, in rad.
    pub angle: Radian,
    /// The ego's front bumper at the meeting place, x in m.
    pub x: Metre,
    /// The same, y in m.
    pub y: Metre,
    /// The lane of the meeting place; empty where there is none.
    pub lane: String,
    /// Whether the rectangles overlapped in any step.
    pub collision: bool,
    /// The ego's type; empty in logs of before there was this column.
    #[serde(default)]
    pub ego_type: String,
    /// The foe's type; empty in logs of before there was this column.
    #[serde(default)]
    pub foe_type: String,
    /// Where ego and foe stood and would go; only from [`ConflictReader::with_snapshots`], and where the log has it.
    #[serde(skip)]
    pub snapshots: Option<Box<[LoggedSnapshot; 2]>>,
}

/// Where one of the two stood in the step with the smallest margin, and where it would go.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoggedSnapshot {
    /// x of the front bumper, in m.
    pub x: Metre,
    /// y of the front bumper, in m.
    pub y: Metre,
    /// From the rear to the front bumper, in rad.
    pub heading: Radian,
    /// 0 for an obstacle, in m.
    pub length: Metre,
    /// 0 for an obstacle, in m.
    pub width: Metre,
    /// x y x y …, in m.
    pub path: String,
}

impl LoggedConflict {
    /// The edge of the meeting place; empty where there is no lane.
    pub fn edge(&self) -> &str {
        self.lane.rsplit_once('_').map_or("", |(edge, _)| edge)
    }

    /// The junction of the meeting place; empty where it is not within one.
    pub fn junction(&self) -> &str {
        let within = self.edge().strip_prefix(':');
        within.and_then(|edge| edge.rsplit_once('_')).map_or("", |(junction, _)| junction)
    }

    /// A number that is none. It would compare with nothing in every quantile that follows.
    pub(super) fn not_finite(&self) -> Option<f64> {
        let numbers = [self.begin, self.end, self.time, self.gap, self.mu, self.margin, self.delta_v, self.x, self.y];
        let measures = [self.ttc, self.drac, self.pet].into_iter().flatten();
        numbers.into_iter().chain(measures).find(|number| !number.is_finite())
    }
}
