//! One conflict: what a run reports.

use ecow::EcoString;

use super::Snapshot;
use super::extremes::{Extremes, WorstStep};
use super::moment::Moment;
use super::struck::Struck;
use super::why::{Artefact, Causes, Manoeuvre, Why};
use crate::detection::kind::{Kind, Severity};
use crate::detection::measures;
use crate::detection::measures::injury::{Body, injury_probability};
use crate::detection::measures::pet::Pet;
use crate::detection::measures::table::LoggedValues;
use crate::detection::severity::{Assessment, Consequence, NearnessLevel};
use crate::options::measures::{ChosenMeasure, ChosenValues};
use crate::options::thresholds::SeverityThresholds;
use crate::traffic::lane_change::LaneChangeReason;
use crate::traffic::net::LaneIndex;
use crate::traffic::roster::{ProfileIndex, Roster};
use crate::util::units::{Metre, MetrePerSecond, Radian, Second};

/// One conflict: a pair and a run of steps that meet the log's condition.
///
/// The fields from `time` on describe the step with the smallest margin, except `collision` and the event's extremes, from
/// `clearance` to `pet`; if they struck each other, `kind`, `angle`, `x` and `y` are those of the first contact. The columns of
/// a log follow from it: `output::schema`.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Conflict {
    /// SUMO's id of the ego.
    pub ego: EcoString,
    /// SUMO's id of the foe.
    pub foe: EcoString,
    /// The ego's type.
    pub ego_profile: ProfileIndex,
    /// The foe's type.
    pub foe_profile: ProfileIndex,
    /// The kind at the smallest margin; of two that struck each other, at their first contact.
    pub kind: Kind,
    /// The worst over the event.
    pub severity: Severity,
    /// How near to a crash it was, where it was most severe.
    pub nearness: NearnessLevel,
    /// What a crash would have meant there.
    pub consequence: Consequence,
    /// What it is if it is none of traffic's; none where it is.
    pub artefact: Option<Artefact>,
    /// First step that meets the log's condition, in s.
    pub begin: Second,
    /// Last step that meets it, in s.
    pub end: Second,
    /// The step with the smallest margin, in s.
    pub time: Second,
    /// The room that is left, in m.
    pub gap: Metre,
    /// The minimal collision distance, in m.
    pub mu: Metre,
    /// gap − μ, in m.
    pub margin: Metre,
    /// Smallest distance between the two rectangles, in m.
    pub clearance: Metre,
    /// The extremes of the measures that every log has.
    pub values: LoggedValues,
    /// Whether in any step before contact no deceleration would have avoided it.
    pub unavoidable: bool,
    /// Probability of a fatal injury of the one worse off, at the ΔV below.
    pub injury_probability: f64,
    /// Post-encroachment time, in s; none of followers.
    pub pet: Option<Second>,
    /// Speed change of the ego in a fully inelastic collision, in m/s.
    pub ego_delta_v: MetrePerSecond,
    /// The same of the foe, in m/s.
    pub foe_delta_v: MetrePerSecond,
    /// Speed of the ego, in m/s.
    pub ego_speed: MetrePerSecond,
    /// Speed of the foe, in m/s.
    pub foe_speed: MetrePerSecond,
    /// Angle α at the conflict point, in rad.
    pub angle: Radian,
    /// The ego's front-bumper centre at the conflict point, x in m.
    pub x: Metre,
    /// The same, y in m.
    pub y: Metre,
    /// The lane of the conflict point.
    pub lane: Option<LaneIndex>,
    /// The lanes of the ego and the foe, where their courses are known.
    pub lanes: [Option<LaneIndex>; 2],
    /// Whether the rectangles overlapped by more than the contact tolerance in any step.
    pub collision: bool,
    /// Deepest overlap of the rectangles over the event: the shortest displacement that parts them, in m; 0 where they never
    /// overlapped.
    pub overlap: Metre,
    /// Whether SUMO reported a collision of the two meanwhile; none where it is not known what SUMO reports.
    pub collision_sumo: Option<bool>,
    /// What the two were doing; none where it is not known.
    pub manoeuvre: Option<Manoeuvre>,
    /// Why it came about, where that is known.
    pub causes: Causes,
    /// SUMO's reason for the lane change, where that is a cause and known.
    pub lane_change_reason: Option<LaneChangeReason>,
    /// Where the ego was and would go.
    pub ego_snapshot: Snapshot,
    /// The same of the foe.
    pub foe_snapshot: Snapshot,
    /// When and where `ttc`, `drac` and `pet` were found.
    pub found: [Option<Moment>; 3],
    /// The measures that are logged only if they are chosen; none where none is.
    pub(crate) chosen: Option<Box<ChosenValues>>,
    /// Each of its steps as a conflict of its own, without paths and PET, where a series is wanted.
    pub steps: Vec<Self>,
}

impl Conflict {
    /// The event so far, of two road users that are still in the roster, and its PET.
    pub(super) fn of(extremes: &Extremes, pet: Option<Pet>, roster: &Roster, rule: SeverityThresholds) -> Self {
        let Extremes {
            begin,
            end,
            last: _,
            assessed: _,
            of_traffic: _,
            is_tracked: _,
            begins_in_contact: _,
            artefact: _,
            passed_at: _,
            collision,
            collision_sumo,
            overlap,
            clearance,
            values,
            unavoidable,
            ref found,
            ref worst,
            struck,
            ref chosen,
            why: Why { manoeuvre, causes, lane_change_reason, lanes },
            standing: _,
        } = *extremes;
        let WorstStep { ego, foe, mut kind, time, gap, mu, margin, mut angle, mut x, mut y, lane, .. } = *worst;
        if let Some(struck) = struck {
            Struck { kind, angle, .. } = struck;
            let front = struck.front_of(ego);
            (x, y) = (front.x, front.y);
        }
        let ego_type = roster.profile_of(ego);
        let foe_type = roster.profile_of(foe);
        let [ego_speed, foe_speed] = worst.speeds;
        let [ego_snapshot, foe_snapshot] = worst.snapshots.clone();
        let [ego_delta_v, foe_delta_v] =
            measures::delta_v((ego_speed, ego_type.mass), (foe_speed, foe_type.mass), angle);
        let injury_probability =
            injury_probability(kind, Body::of(ego_type, ego_delta_v), Body::of(foe_type, foe_delta_v));
        let (Assessment { severity, nearness, consequence }, artefact) = extremes.verdict_with(pet, rule);
        let entered = pet.map(|pet| Moment { time: pet.enters, x, y, speed: ego_speed });
        Self {
            ego: roster.id(ego).clone(),
            foe: roster.id(foe).clone(),
            ego_profile: roster.type_of(ego),
            foe_profile: roster.type_of(foe),
            kind,
            severity,
            nearness,
            consequence,
            artefact,
            begin,
            end,
            time,
            gap,
            mu,
            margin,
            clearance,
            values,
            unavoidable,
            injury_probability,
            pet: pet.map(|pet| pet.lasts),
            ego_delta_v,
            foe_delta_v,
            ego_speed,
            foe_speed,
            angle,
            x,
            y,
            lane,
            lanes,
            collision,
            overlap,
            collision_sumo,
            manoeuvre,
            causes,
            lane_change_reason,
            ego_snapshot,
            foe_snapshot,
            found: [found[0], found[1], entered],
            chosen: chosen.as_ref().map(|chosen| Box::new(chosen.values())),
            steps: Vec::new(),
        }
    }

    /// The value of a measure that is logged only if it is chosen.
    pub fn chosen(&self, measure: ChosenMeasure) -> Option<f64> {
        self.chosen.as_ref().and_then(|values| values[measure as usize])
    }
}
