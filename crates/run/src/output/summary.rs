//! The numbers of a run: the table at its end and the counts in `run.json`.

use std::collections::BTreeMap;
use std::fmt;

use ecow::EcoString;
use serde::{Deserialize, Serialize};

use super::overlaps::{Overlaps, SumoCollisions};
use super::rank::Rank;
use crate::util::decimal::Written;
use closecall::detection::detector::{LeftOut, Work};
use closecall::detection::kind::{Kind, Severity};
use closecall::events::{Artefact, Conflict};
use closecall::traffic::roster::Roster;
use closecall::util::remark::Remark;
use closecall::util::units::{Second, counted};

/// How many conflicts are none of traffic's, by what they are.
pub type SetAside = BTreeMap<String, u64>;

/// What a run found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Summary {
    /// First step, in s.
    pub begin: Second,
    /// Last step, in s; it lasts as long as the others.
    pub end: Second,
    /// Steps that were checked; 0 in the `run.json` of a run that was killed or still goes on.
    pub steps: u64,
    /// All logged conflicts, by kind and severity; those set aside by reason.
    pub conflicts: Vec<Count>,
    /// Conflicts in which the two rectangles overlapped.
    pub collisions: u64,
    /// The sum of all crash probabilities: compares plans with the same steps; not a number of crashes. Earlier versions called
    /// it `expected_crashes`.
    #[serde(default, alias = "expected_crashes")]
    pub risk_index: f64,
    /// The collisions that SUMO itself reported; none where it was not asked.
    #[serde(default)]
    pub collisions_sumo: Option<SumoCollisions>,
    /// The amount of traffic.
    pub exposure: Exposure,
    /// The vehicles that entered each junction, by its id; empty where vehicles have no lanes.
    #[serde(default)]
    pub entered: BTreeMap<String, u64>,
    /// What the scene did not need; not read back.
    #[serde(skip_deserializing)]
    pub left_out: Vec<LeftOut>,
    /// The conflict to look at first; not written to `run.json`.
    #[serde(skip)]
    pub worst: Option<WorstConflict>,
    /// What the overlaps have in common; not written to `run.json`.
    #[serde(skip)]
    pub overlaps: Overlaps,
    /// The share of tests that was skipped; not written to `run.json`.
    #[serde(skip)]
    pub skipped: Skipped,
    /// What its reader should know before believing it.
    #[serde(default)]
    pub remarks: Vec<Remark>,
    /// Each part of the work and the seconds it took; not written to `run.json`.
    #[serde(skip)]
    pub spent: Vec<(&'static str, f64)>,
}

/// The number of conflicts of one kind and severity that count, or that are set aside for one reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Count {
    /// The kind.
    pub kind: Kind,
    /// The severity.
    pub severity: Severity,
    /// Why they are none of traffic's, and so are set aside; none of those that count.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub artefact: Option<Artefact>,
    /// The number of conflicts.
    pub count: u64,
}

/// The amount of traffic in a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Exposure {
    /// Vehicles that were in the scene.
    pub vehicles: u64,
    /// Persons that were in the scene.
    pub persons: u64,
    /// Distance driven by all vehicles, in km.
    pub vehicle_kilometres: f64,
    /// Time that all vehicles spent in the scene, in h.
    pub vehicle_hours: f64,
}

/// The worst conflict of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct WorstConflict {
    /// Its id in `conflicts.csv`.
    pub id: u64,
    /// SUMO's id of the ego.
    pub ego: EcoString,
    /// SUMO's id of the foe.
    pub foe: EcoString,
    /// Its kind.
    pub kind: Kind,
    /// Its severity.
    pub severity: Severity,
    /// Whether the rectangles overlapped.
    pub collision: bool,
    /// The step with the smallest margin, in s.
    pub time: Second,
    rank: Rank,
}

impl WorstConflict {
    fn of(conflict: &Conflict, id: u64) -> Self {
        Self {
            id,
            ego: conflict.ego.clone(),
            foe: conflict.foe.clone(),
            kind: conflict.kind,
            severity: conflict.severity,
            collision: conflict.collision,
            time: conflict.time,
            rank: conflict.into(),
        }
    }
}

impl fmt::Display for WorstConflict {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { id, ego, foe, kind, severity, collision, time, .. } = self;
        let what = if *collision { "collision" } else { "conflict" };
        let (severity, kind, time) = (severity.name(), kind.name(), Written(*time));
        write!(f, "no. {id}, a {severity} {kind} {what} of {ego} (ego) and {foe} (foe) at {time} s")
    }
}

/// The tests that a run skipped because they could not change its result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Skipped {
    /// Pairs that were not tested in full, of all pairs.
    pub pair_tests: Share,
    /// Lanes that were not asked for, of all lanes of moving vehicles.
    pub lane_lookups: Share,
}

/// A part of a whole, in counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Share {
    /// The part.
    pub part: u64,
    /// The whole.
    pub whole: u64,
}

impl Skipped {
    /// The shares of the detector's work, when this many lanes were asked for.
    pub(crate) fn of(work: &Work, lane_lookups: u64) -> Self {
        let Work { areas_apart, paths_apart, in_line, pairs, known_paths, .. } = *work;
        Self {
            pair_tests: Share { part: areas_apart + paths_apart + in_line, whole: areas_apart + pairs },
            lane_lookups: Share { part: known_paths, whole: known_paths + lane_lookups },
        }
    }
}

impl fmt::Display for Share {
    /// Per cent, rounded down: 100 only where all is part of it.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let per_mille = 1000 * u128::from(self.part) / u128::from(self.whole.max(1));
        write!(f, "{}.{} %", per_mille / 10, per_mille % 10)
    }
}

impl fmt::Display for Skipped {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let shares = [(self.pair_tests, "pair tests"), (self.lane_lookups, "lane lookups")];
        let shares = shares.iter().filter(|(share, _)| share.part > 0);
        let shares = shares.map(|(share, what)| format!("{share} of {what}")).collect::<Vec<_>>();
        write!(f, "{}", shares.join(" and "))
    }
}

impl Summary {
    /// Counts a conflict; an artefact only with `counts_artefacts`.
    pub fn add(&mut self, conflict: &Conflict, counts_artefacts: bool, roster: &Roster) {
        let Conflict { kind, severity, .. } = *conflict;
        let artefact = conflict.artefact.filter(|_| !counts_artefacts);
        let of = |count: &Count| (count.kind, count.severity, count.artefact);
        match self.conflicts.binary_search_by_key(&(kind, severity, artefact), of) {
            Ok(known) => self.conflicts[known].count += 1,
            Err(place) => self.conflicts.insert(place, Count { kind, severity, artefact, count: 1 }),
        }
        self.overlaps.add(conflict, artefact.is_some(), roster);
        if artefact.is_some() {
            return;
        }
        self.collisions += u64::from(conflict.collision);
        self.risk_index += conflict.values.crash_probability().unwrap_or(0.0);
        if let Some(of_sumo) = &mut self.collisions_sumo {
            of_sumo.in_conflict += u64::from(conflict.collision_sumo == Some(true));
        }
        if self.worst.as_ref().is_none_or(|worst| worst.rank < conflict.into()) {
            self.worst = Some(WorstConflict::of(conflict, self.logged()));
        }
    }

    /// The number of conflicts that are logged, with those that are set aside.
    pub fn logged(&self) -> u64 {
        self.conflicts.iter().map(|count| count.count).sum()
    }

    /// The conflicts that are set aside.
    pub fn set_aside(&self) -> SetAside {
        let mut found = SetAside::new();
        for (artefact, count) in self.conflicts.iter().filter_map(|count| Some((count.artefact?, count.count))) {
            *found.entry(artefact.name().to_owned()).or_default() += count;
        }
        found
    }

    /// The number of conflicts that count, of a kind, of a severity, or of both; of all where neither is given.
    pub fn count(&self, kind: Option<Kind>, severity: Option<Severity>) -> u64 {
        let wanted = |count: &&Count| {
            count.artefact.is_none()
                && kind.is_none_or(|kind| kind == count.kind)
                && severity.is_none_or(|severity| severity == count.severity)
        };
        self.conflicts.iter().filter(wanted).map(|count| count.count).sum()
    }
}

impl Summary {
    /// How many conflicts are set aside, and why; none where none is.
    pub fn set_aside_in_words(&self) -> Option<String> {
        in_words(&self.set_aside()).map(|words| format!("{words} (docs/artefacts.md)"))
    }
}

/// How many conflicts are set aside, and why; none where none is.
pub fn in_words(set_aside: &SetAside) -> Option<String> {
    let reasons = set_aside.iter().map(|(artefact, count)| format!("{count} {artefact}"));
    let reasons = reasons.collect::<Vec<_>>().join(", ");
    let all = set_aside.values().sum::<u64>();
    (all > 0).then(|| format!("set aside {all} that are not traffic's: {reasons}"))
}

impl fmt::Display for Summary {
    /// The remarks that were not said at the beginning, the table of conflicts, what was set aside, and the amount of traffic.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.remarks
            .iter()
            .filter(|remark| !remark.code.is_of_opening())
            .try_for_each(|remark| writeln!(f, "{remark}"))?;
        write!(f, "{:<10}", "conflicts")?;
        for severity in Severity::ALL.iter().rev() {
            write!(f, "{:>10}", severity.name())?;
        }
        writeln!(f, "{:>10}", "all")?;
        for kind in Kind::ALL.map(Some).into_iter().chain([None]) {
            write!(f, "{:<10}", kind.map_or("all", Kind::name))?;
            for severity in Severity::ALL.into_iter().rev() {
                write!(f, "{:>10}", self.count(kind, Some(severity)))?;
            }
            writeln!(f, "{:>10}", self.count(kind, None))?;
        }
        if let Some(set_aside) = self.set_aside_in_words() {
            writeln!(f, "{set_aside}")?;
        }
        writeln!(f, "{}", self.overlaps.in_words(self.collisions_sumo))?;
        let Exposure { vehicles, persons, vehicle_kilometres, .. } = self.exposure;
        writeln!(
            f,
            "{}, {}, {vehicle_kilometres:.1} vehicle-km, {} from {} to {} s; risk index \
             {:.2} (not a number of crashes)",
            counted(vehicles, "vehicle"),
            counted(persons, "person"),
            counted(self.steps, "step"),
            Written(self.begin),
            Written(self.end),
            self.risk_index
        )
    }
}

#[cfg(test)]
mod tests {
    use crate::output::summary::*;

    #[test]
    fn a_share_is_rounded_down() {
        let shares = [(0, 0), (1, 3), (9999, 10_000), (7, 7)];
        let texts = shares.map(|(part, whole)| Share { part, whole }.to_string());
        assert_eq!(texts, ["0.0 %", "33.3 %", "99.9 %", "100.0 %"]);
    }
}
