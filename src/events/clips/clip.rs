//! A clip: where the road users around a conflict were, as `clips.jsonl.gz` has it.

use serde::{Deserialize, Serialize};

use crate::detection::kind::Severity;
use crate::util::limits::{ANGLE, LENGTH, Limit, POSITION, SPEED, TIME, WIDTH};
use crate::util::units::{Metre, MetrePerSecond, Radian, Second};

/// A clip begins this long before the conflict's worst moment, in s.
pub const BEFORE: Second = 5.0;
/// It ends this long after it, in s.
pub const AFTER: Second = 3.0;
/// It shows the road users within this distance of the two or of the conflict, in m.
pub const AROUND: Metre = 50.0;

/// A clip has at most this many times: those of its seconds, ten a second, are fewer.
const MOST_TIMES: usize = 1000;

/// The seconds around a conflict's worst moment: lists of equal length, one value per time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Clip {
    /// The conflict's `id` in the log.
    pub conflict: u64,
    /// The times, in s, ascending.
    pub times: Vec<Second>,
    /// The severity of the pair at each time; none where it was in no conflict.
    pub severity: Vec<Option<Severity>>,
    /// Its time left, `response_left` of the log, in s; none where it was in no conflict, or where the ego stood.
    pub time_left: Vec<Option<Second>>,
    /// The ego, the foe, then the others.
    pub users: Vec<ClipUser>,
    /// The signals; empty where it is not known what they showed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub signals: Vec<ClipSignal>,
}

impl Clip {
    /// The worst severity of the pair so far, while it is in conflict.
    pub fn worst_so_far(&self, place: usize) -> Option<Severity> {
        self.severity[place].and_then(|_| self.severity[..=place].iter().flatten().max().copied())
    }

    /// Whether it is as a run writes it: values at each time, ascending, within their limits, and the two of the conflict.
    pub fn is_whole(&self) -> bool {
        let count = self.times.len();
        let is_full = |user: &ClipUser| {
            let lists = [&user.x, &user.y, &user.heading, &user.speed];
            let limits = [POSITION, POSITION, ANGLE, SPEED];
            let is_plausible = |(list, limit): (&Vec<Option<f64>>, Limit)| {
                list.len() == count && list.iter().flatten().all(|value| limit.holds(*value))
            };
            lists.into_iter().zip(limits).all(is_plausible)
                && user.length <= LENGTH.most
                && user.width <= WIDTH.most
                && user.outlines.iter().flatten().flatten().all(|it| POSITION.holds(*it))
        };
        (1..=MOST_TIMES).contains(&count)
            && [self.severity.len(), self.time_left.len()] == [count; 2]
            && self.times.is_sorted_by(|a, b| a < b)
            && self.times.iter().all(|time| TIME.holds(*time))
            && self.users.len() >= 2
            && self.users.iter().all(is_full)
            && self.signals.iter().all(|signal| signal.states.is_ascii() && signal.states.len() == count)
    }
}

/// A road user of a clip; where it is absent at a time, its values are none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ClipUser {
    /// SUMO's id.
    pub id: String,
    /// What it is.
    pub category: ClipCategory,
    /// SUMO's `vClass`; empty for an obstacle.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub class: String,
    /// Length in m.
    pub length: Metre,
    /// Width in m.
    pub width: Metre,
    /// The outlines of an obstacle's parts, each as x and y of its corners, in m.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outlines: Vec<Vec<[Metre; 2]>>,
    /// Front-bumper centre, x in m.
    pub x: Vec<Option<Metre>>,
    /// The same, y in m.
    pub y: Vec<Option<Metre>>,
    /// Direction from the rear to the front bumper, in rad counter-clockwise from +x.
    pub heading: Vec<Option<Radian>>,
    /// Speed in m/s.
    pub speed: Vec<Option<MetrePerSecond>>,
}

/// What a road user of a clip is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ClipCategory {
    /// A vehicle, bicycles included.
    #[default]
    Vehicle,
    /// A person on foot.
    Person,
    /// A static obstacle.
    Obstacle,
}

/// What a traffic light showed those who come from a lane.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClipSignal {
    /// The traffic light's id.
    pub light: String,
    /// The link's number at the traffic light.
    pub index: u32,
    /// The lane that ends at the signal.
    pub lane: String,
    /// SUMO's letter at each time.
    pub states: String,
}
