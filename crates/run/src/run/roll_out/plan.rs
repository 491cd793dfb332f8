//! What is to be done in a roll-out: which pairs are watched, which drivers err and how.

use serde::{Deserialize, Serialize};

use closecall::util::units::{Probability, Second};

/// What is to be done in a roll-out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RollOut {
    /// The pairs whose paths are kept.
    pub watched: Vec<Watched>,
    /// The drivers that err, or answer the error of another; none in a baseline.
    pub drivers: Vec<ErringDriver>,
    /// Whether it ends at the first contact of one of the watched.
    pub ends_at_contact: bool,
    /// The errors of all drivers, of whatever conflict; none where only those above err.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lapses: Option<Lapses>,
}

/// Lapses of all drivers: in some conflicts that open, the ego's driver responds late.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lapses {
    /// The share of conflicts.
    pub share: Probability,
    /// Another number draws others.
    pub seed: u64,
}

/// A pair whose paths are kept from one time to another.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Watched {
    /// Their ids.
    pub pair: [String; 2],
    /// The first time, in s.
    pub from: Second,
    /// The last time, in s.
    pub until: Second,
}

/// A driver that errs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErringDriver {
    /// Its id.
    pub id: String,
    /// The other of its conflict.
    pub foe: String,
    /// What it does wrong.
    pub error: DriverError,
    /// When it would have to respond, in s; none where that is when its conflict opens.
    pub from: Option<Second>,
    /// The share of drivers that respond sooner.
    pub response: Probability,
    /// The share of drivers whose vehicles brake more weakly.
    pub deceleration: Probability,
}

/// What a driver does wrong. After its response time it brakes, until the conflict is over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum, strum::IntoStaticStr)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum DriverError {
    /// It responds late: from the moment the conflict opens, it goes on as it was for its response time.
    #[default]
    Late,
    /// It also misjudges the gap: until then it does not give way at junctions.
    Gap,
    /// It also does not see the signal: until then it does not stop for one.
    Signal,
}

impl RollOut {
    /// Reads the words of `--roll-out`.
    ///
    /// # Errors
    /// What is wrong with them.
    pub fn parse(text: &str) -> std::result::Result<Self, String> {
        serde_json::from_str(text).map_err(|error| error.to_string())
    }
}
