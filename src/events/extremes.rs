//! The state of an event: the step with the smallest margin, and the extremes of all steps so far.

use std::cell::LazyCell;

use super::chosen_measures::{ChosenMeasures, Step};
use super::moment::Moment;
use super::past::Past;
use super::snapshot::Snapshot;
use super::struck::Struck;
use super::substep::Closest;
use super::why::{Artefact, Manoeuvre, Pair, STANDS, Surroundings, Why, one_will_wait};
use crate::detection::encounter::{Encounter, Nearness};
use crate::detection::kind::{Kind, Severity};
use crate::detection::measures::pet::Pet;
use crate::detection::measures::table::LoggedMeasure::{
    CrashProbability, CrashProbabilityBraking, ExtendedDeltaV, ResponseLeft, Ttb, Ttc,
};
use crate::detection::measures::table::LoggedValues;
use crate::detection::severity::{AT_SPEED, Assessment, Consequence, LIKELY_CLEARANCE, LIKELY_PET, NearnessLevel};
use crate::options::measures::ChosenValues;
use crate::options::thresholds::SeverityThresholds;
use crate::traffic::frame::Frame;
use crate::traffic::net::LaneIndex;
use crate::traffic::profile::Category;
use crate::traffic::roster::{Roster, UserIndex};
use crate::util::units::{Metre, MetrePerSecond, Radian, Second};

/// Margins that differ by less than this are equal, in m: a pair that keeps its speeds has the same in every step.
const SAME_MARGIN: Metre = 1e-9;

/// A slower vehicle does not pass another, it creeps, in m/s.
const DRIVES: MetrePerSecond = 3.0;
/// A slower person stands and waits, in m/s.
const WALKS: MetrePerSecond = 0.5;

/// One step of a pair.
#[derive(Clone, Copy)]
pub(super) struct Observation<'a> {
    pub frame: &'a Frame,
    pub roster: &'a Roster,
    pub found: &'a Encounter,
    /// The chosen measures of this step; none where none is chosen.
    pub chosen: Option<&'a ChosenValues>,
    /// Since the step before, in s; 0 in the first of a run.
    pub lasted: Second,
    pub around: Surroundings<'a>,
    pub past: &'a Past,
    pub rule: SeverityThresholds,
}

/// The extremes so far; [`super::Conflict`] describes the values.
#[derive(Debug)]
pub(super) struct Extremes {
    pub begin: Second,
    pub end: Second,
    /// The last step.
    pub last: Assessment,
    /// The worst of all steps.
    pub assessed: Assessment,
    /// The worst of the steps that are traffic; none where none is.
    pub of_traffic: Option<Assessment>,
    /// What the worst of the other steps is.
    pub artefact: Option<Artefact>,
    /// Whether sensors tracked the two, and they overlap in the first step: a track that begins too late, or in error.
    pub is_tracked: bool,
    pub begins_in_contact: bool,
    pub collision: bool,
    pub overlap: Metre,
    /// Whether SUMO reported a collision of the two; none where it is not known what SUMO reports.
    pub collision_sumo: Option<bool>,
    pub clearance: Metre,
    /// The smallest clearance in steps in which both cross each other's path at speed; infinite where there is none.
    pub passed_at: Metre,
    pub values: LoggedValues,
    pub unavoidable: bool,
    /// When and where the TTC and the DRAC were found.
    pub found: [Option<Moment>; 2],
    pub worst: WorstStep,
    /// How they struck each other first, if that is known.
    pub struck: Option<Struck>,
    /// The chosen measures; none where none is chosen.
    pub chosen: Option<Box<ChosenMeasures>>,
    /// The manoeuvre of that step, and the causes of all steps that were the worst so far.
    pub why: Why,
    /// The vehicles that stood in the last step and of which a stop would be a cause.
    pub standing: [Option<UserIndex>; 2],
}

/// The step with the smallest margin.
#[derive(Debug)]
pub(super) struct WorstStep {
    pub ego: UserIndex,
    pub foe: UserIndex,
    pub kind: Kind,
    pub time: Second,
    pub gap: Metre,
    pub mu: Metre,
    pub margin: Metre,
    pub angle: Radian,
    pub x: Metre,
    pub y: Metre,
    pub lane: Option<LaneIndex>,
    /// The ego's and the foe's.
    pub speeds: [MetrePerSecond; 2],
    /// The ego's and the foe's.
    pub snapshots: [Snapshot; 2],
}

impl Observation<'_> {
    /// How severe this step is, in which one of the two may have to wait.
    fn assessment(&self, pair: &Pair) -> Assessment {
        let foreseen = self.foreseen();
        let waits = foreseen.nearness > NearnessLevel::Possible && !self.found.collision && one_will_wait(pair);
        if waits { foreseen.of_one_that_waits(self.rule) } else { foreseen }
    }

    /// How severe this step is as both drive now.
    fn foreseen(&self) -> Assessment {
        const NONE: Assessment = Assessment {
            severity: Severity::Caution,
            nearness: NearnessLevel::Possible,
            consequence: Consequence::Minor,
        };
        self.found.nearness.map_or(NONE, |near| near.assessment)
    }

    /// The clearance, if both cross each other's path at speed.
    fn passed_at(&self) -> Metre {
        let speeds = [self.found.ego_row, self.found.foe_row].map(|row| self.frame.state(row).speed);
        let both_move = [self.found.ego, self.found.foe].into_iter().zip(speeds).all(|(user, speed)| {
            let is_vehicle = self.roster.profile_of(user).category == Category::Vehicle;
            speed >= if is_vehicle { DRIVES } else { WALKS }
        });
        let (sin, cos) = self.found.angle.sin_cos();
        let relative = (speeds[0] - speeds[1] * cos).hypot(speeds[1] * sin);
        if self.found.kind == Kind::Side && both_move && relative >= AT_SPEED {
            self.clearance()
        } else {
            f64::INFINITY
        }
    }

    fn clearance(&self) -> Metre {
        self.found.nearness.map_or(f64::INFINITY, |near| near.clearance)
    }

    /// The values of this step. A crash probability that cannot exceed the known one is not worked out.
    fn values(&self, known: &LoggedValues) -> LoggedValues {
        let Some(near) = &self.found.nearness else { return LoggedValues::NONE };
        let known = [known.crash_probability(), known.crash_probability_braking()];
        let mut values = near.values;
        for (which, measure) in [CrashProbability, CrashProbabilityBraking].into_iter().enumerate() {
            if known[which].is_none_or(|known| near.crash_at_most[which] > known) {
                values = values.with(measure, (self.around.crash_probability)(near, measure));
            }
        }
        values
    }

    /// The measures of this step with its crash probability.
    pub fn nearness_with_probability(&self) -> Option<Nearness> {
        let near = self.found.nearness?;
        let value = (self.around.crash_probability)(&near, CrashProbability);
        Some(Nearness { values: near.values.with(CrashProbability, value), ..near })
    }

    fn ttc(&self) -> Option<Second> {
        self.found.nearness?.values.ttc()
    }

    fn is_unavoidable(&self) -> bool {
        self.found.nearness.is_some_and(|near| near.unavoidable)
    }

    fn chosen_step(&self) -> Option<Step<'_>> {
        self.chosen.map(|values| Step { values, ttc: self.ttc(), lasted: self.lasted })
    }

    fn pair(&self) -> Pair<'_> {
        Pair::of((self.frame, self.roster, self.found), self.around, self.past)
    }

    /// The standing vehicles of which a stop would be a cause: a followed vehicle's stop is its own affair.
    fn standing(&self) -> [Option<UserIndex>; 2] {
        let Encounter { ego, foe, ego_row, foe_row, kind, .. } = *self.found;
        let stands = |user: UserIndex, row| {
            let is_vehicle = self.roster.profile_of(user).category == Category::Vehicle;
            Some(user).filter(|_| self.frame.state(row).speed < STANDS && is_vehicle)
        };
        [stands(ego, ego_row).filter(|_| kind != Kind::RearEnd), stands(foe, foe_row)]
    }

    fn moment(&self) -> Moment {
        let Encounter { x, y, ego_row, .. } = *self.found;
        Moment { time: self.frame.time, x, y, speed: self.frame.state(ego_row).speed }
    }
}

impl WorstStep {
    /// This step, with the paths of both or without.
    fn of(&Observation { frame, roster, found, around, .. }: &Observation, has_paths: bool) -> Self {
        let Encounter { ego, foe, kind, gap, mu, margin, angle, x, y, lane, .. } = *found;
        let speeds = [found.ego_row, found.foe_row].map(|row| frame.state(row).speed);
        let path = |row| if has_paths { (around.path)(row) } else { Vec::new() };
        let snapshots = [(ego, found.ego_row), (foe, found.foe_row)]
            .map(|(user, row)| Snapshot::of(frame.state(row), roster.profile_of(user), &path(row)));
        Self { ego, foe, kind, time: frame.time, gap, mu, margin, angle, x, y, lane, speeds, snapshots }
    }
}

impl Extremes {
    /// Those of a first step, with the paths of both or without.
    pub fn of(seen: &Observation, has_paths: bool) -> Self {
        let (values, moment) = (seen.values(&LoggedValues::NONE), |_| seen.moment());
        let pair = seen.pair();
        let assessed = seen.assessment(&pair);
        let artefact = Artefact::of(&pair);
        Self {
            begin: seen.frame.time,
            end: seen.frame.time,
            last: assessed,
            assessed,
            of_traffic: Some(assessed).filter(|_| artefact.is_none()),
            artefact,
            is_tracked: seen.around.is_tracked,
            begins_in_contact: seen.found.overlap > 0.0,
            collision: seen.found.collision,
            overlap: seen.found.overlap,
            collision_sumo: None,
            clearance: seen.clearance(),
            passed_at: seen.passed_at(),
            values,
            unavoidable: seen.is_unavoidable(),
            found: [values.ttc().map(moment), values.drac().map(moment)],
            worst: WorstStep::of(seen, has_paths),
            struck: None,
            chosen: seen.chosen_step().map(|step| Box::new(ChosenMeasures::of(&step))),
            why: Why::of(&pair),
            standing: seen.standing(),
        }
    }

    /// Adds a later step of the same event.
    pub fn take(&mut self, seen: &Observation) {
        let with_the_same_ego = self.with_the_same_ego(seen.found);
        let seen = &Observation { found: with_the_same_ego.as_ref().unwrap_or(seen.found), ..*seen };
        let pair = LazyCell::new(|| seen.pair());
        // Of margins that differ by rounding only, the first is kept.
        let is_worst = seen.found.margin < self.worst.margin - SAME_MARGIN && self.leads_to_the_contact();
        if is_worst {
            self.worst = WorstStep::of(seen, true);
            self.why = self.why.then(Why::of(&pair));
        } else if seen.found.kind != Kind::RearEnd {
            // Who enters a junction first, and on what light, may show only after the smallest margin.
            self.why.causes.add(Why::of(&pair).causes.at_the_entry());
        }
        self.learn_edges(seen);
        if let (Some(chosen), Some(step)) = (&mut self.chosen, seen.chosen_step()) {
            chosen.take(&step, is_worst);
        }
        self.end = seen.frame.time;
        self.standing = seen.standing();
        let foreseen = seen.foreseen();
        let now = if foreseen.nearness > NearnessLevel::Possible { seen.assessment(&pair) } else { foreseen };
        self.last = now;
        self.assess(now, || Artefact::of(&pair));
        self.clearance = self.clearance.min(seen.clearance());
        self.passed_at = self.passed_at.min(seen.passed_at());
        self.collision |= seen.found.collision;
        self.overlap = self.overlap.max(seen.found.overlap);
        self.unavoidable |= seen.is_unavoidable();
        for (found, taken) in self.found.iter_mut().zip(self.values.take_all(&seen.values(&self.values))) {
            if taken {
                *found = Some(seen.moment());
            }
        }
    }
}

impl Extremes {
    /// Takes the edges of persons, which SUMO is asked for from the second step of a conflict on.
    fn learn_edges(&mut self, seen: &Observation) {
        let Encounter { ego, foe, ego_row, foe_row, .. } = *seen.found;
        for (user, lane) in [self.worst.ego, self.worst.foe].into_iter().zip(&mut self.why.lanes) {
            if lane.is_none() && seen.roster.profile_of(user).category == Category::Person {
                let row = [(ego, ego_row), (foe, foe_row)].into_iter().find(|(known, _)| *known == user);
                *lane = row.and_then(|(_, row)| (seen.around.course)(row, 0.0).at(0.0));
            }
        }
    }

    /// Whether the next step is one before two strike each other, or the one in which they do: their overlap afterwards is not
    /// a conflict.
    fn leads_to_the_contact(&self) -> bool {
        self.struck.is_none_or(|struck| struck.time > self.end)
    }

    /// A step in which two strike each other, with the ego that it was before, if it is not: which of two that lie in each other
    /// moves faster towards the other depends on how deep they do.
    fn with_the_same_ego(&self, found: &Encounter) -> Option<Encounter> {
        let strikes = self.struck.is_some_and(|struck| struck.time > self.end);
        if !strikes || !found.collision || found.ego == self.worst.ego {
            return None;
        }
        let Encounter { ego, foe, ego_row, foe_row, .. } = *found;
        let mu = self.worst.mu;
        Some(Encounter { ego: foe, foe: ego, ego_row: foe_row, foe_row: ego_row, mu, margin: -mu, ..*found })
    }

    /// The kind: that of the contact if they struck each other, or else that of the worst step.
    pub fn kind(&self) -> Kind {
        self.struck.map_or(self.worst.kind, |struck| struck.kind)
    }

    /// Whether the two came closer than in any step so far.
    pub(crate) fn is_closer(&self, closest: &Closest) -> bool {
        closest.clearance < self.clearance || closest.overlap > self.overlap || closest.contact.is_some()
    }

    /// Takes how severe a step is, and which artefact: `artefact` is called only where it matters.
    fn assess(&mut self, now: Assessment, artefact: impl FnOnce() -> Option<Artefact>) {
        if self.of_traffic.is_none_or(|known| now > known) {
            match artefact() {
                None => self.of_traffic = Some(now),
                Some(artefact) if self.artefact.is_none() || now > self.assessed => self.artefact = Some(artefact),
                Some(_) => {}
            }
        }
        self.assessed = self.assessed.max(now);
    }

    /// How severe the event is, and which artefact. If only some steps are artefacts, the others count if they are as severe,
    /// or serious.
    pub fn verdict(&self) -> (Assessment, Option<Artefact>) {
        if self.is_tracked && self.begins_in_contact {
            return (self.assessed, Some(Artefact::Tracking));
        }
        let counts = |of: &Assessment| of.severity >= self.assessed.severity.min(Severity::Serious);
        match self.of_traffic.filter(counts) {
            Some(assessment) => (assessment, None),
            // A crash that SUMO reports is a crash.
            None if self.collision_sumo == Some(true) => (self.assessed, None),
            None => (self.assessed, self.artefact),
        }
    }

    /// The same, raised if one crossed the other's path close behind it, or passed close to it. After turning into the other's
    /// road close behind it, it follows from there.
    pub(crate) fn verdict_with(&self, pet: Option<Pet>, rule: SeverityThresholds) -> (Assessment, Option<Artefact>) {
        let (assessment, artefact) = self.verdict();
        let crosses = !matches!(self.why.manoeuvre, Some(Manoeuvre::Following | Manoeuvre::Merge));
        let follows = self.why.manoeuvre == Some(Manoeuvre::TurnInto);
        let is_close_behind = !follows && pet.is_some_and(|pet| pet.lasts < LIKELY_PET);
        let is_near = is_close_behind || self.passed_at < LIKELY_CLEARANCE;
        let is_passing = self.kind() == Kind::Side && crosses && artefact.is_none();
        let raised = || assessment.at_least(NearnessLevel::Likely, rule);
        (if is_passing && is_near { raised() } else { assessment }, artefact)
    }

    /// Whether it is over within a single frame of tracked road users: one bad frame, no conflict.
    pub(crate) fn is_a_bad_frame(&self) -> bool {
        self.is_tracked && self.begin == self.end
    }

    /// Adds how close the two came between two steps, how they struck each other, how severe that was, and which artefact.
    pub(crate) fn come_closer(
        &mut self,
        closest: &Closest,
        struck: Option<Struck>,
        assessed: Option<(Assessment, Option<Artefact>)>,
    ) {
        self.clearance = self.clearance.min(closest.clearance);
        self.overlap = self.overlap.max(closest.overlap);
        let Some(struck) = struck else { return };
        self.struck = self.struck.or(Some(struck));
        self.collision = true;
        if let Some((assessment, artefact)) = assessed {
            self.assess(assessment, || artefact);
        }
        for (measure, now) in [(ResponseLeft, 0.0), (Ttb, 0.0), (CrashProbability, 1.0), (CrashProbabilityBraking, 1.0)]
        {
            self.values.take(measure, Some(now));
        }
        self.values.take(ExtendedDeltaV, Some(struck.delta_v[0].max(struck.delta_v[1])));
        if self.values.take(Ttc, Some(0.0)) {
            self.found[0] = Some(struck.moment_of(self.worst.ego));
        }
    }
}
