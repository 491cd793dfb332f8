//! One event: a pair in the steps that meet the log's condition, until its PET is known.

use smallvec::SmallVec;

use super::alarm::{Alarm, PetSoFar};
use super::event::Conflict;
use super::extremes::{Extremes, Observation, WorstStep};
use super::past::Past;
use super::span::Span;
use super::struck::Struck;
use super::substep::{Between, Both, Closest, Moment};
use super::why::{self, Artefact, Surroundings};
use crate::detection::encounter::Encounter;
use crate::detection::kind::Severity;
use crate::detection::measures::driven_path::DrivenPath;
use crate::detection::measures::injury::{Body, injury_probability};
use crate::detection::measures::pet::{self, Pet};
use crate::detection::path::Pose;
use crate::detection::severity::{Assessment, SeverityInputs};
use crate::geometry::Point;
use crate::geometry::bisection::Bisection;
use crate::options::thresholds::{KindBounds, SeverityThresholds};
use crate::traffic::frame::{Frame, State};
use crate::traffic::profile::{Category, Profile};
use crate::traffic::roster::{Roster, UserIndex};
use crate::util::units::{Metre, Radian, SAME_MOMENT, Second};

/// How long the condition must not be met before an event closes, in s (docs/log.md).
pub const CLOSES_AFTER: Second = 1.0;

/// Two road users, in the order of their indices.
pub(super) type Pair = [UserIndex; 2];

/// An event under way, or closed and waiting for its PET.
#[derive(Debug)]
pub(super) struct Event {
    /// The ego and the foe of the first step: the order of their indices decides nothing.
    pair: [UserIndex; 2],
    /// None while the pair is only followed for its PET.
    pub alarm: Option<Alarm>,
    /// All steps that meet the condition if the PET is short enough.
    followed: Span,
    /// The PET has to be below this for that.
    pet_below: Second,
    /// The runs of steps that meet the condition whatever the PET is; none where it does not ask for the PET.
    met: Option<Vec<Span>>,
    /// Where both were in the last step, in the order of the pair.
    last: Seen,
    driven: Option<Box<Driven>>,
}

/// Where two road users were in a step.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    states: Both,
    /// As their source has them, later by `behind`.
    reported: Both,
    behind: Second,
}

/// The paths that the two of an event have driven whose paths may cross, from some seconds before that, in their order, and
/// the PET, once it is final.
#[derive(Debug)]
struct Driven {
    paths: [DrivenPath; 2],
    pet: Option<Pet>,
}

/// An event that is severe in some steps.
#[derive(Debug)]
pub(super) struct SevereEvent {
    pub pair: Pair,
    /// When and where each of its severe parts has been the worst so far.
    pub worst: SmallVec<[(Second, Point); 2]>,
}

/// By which rules events are judged.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rules {
    /// Deeper overlaps are collisions.
    pub contact_tolerance: Metre,
    pub severity: SeverityThresholds,
    pub kinds: KindBounds,
    /// Whether artefacts count.
    pub counts_artefacts: bool,
}

/// What PETs are looked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pets {
    /// Paths that meet at a smaller angle cross only where each goes on beyond the other.
    pub widest: Radian,
    /// How long they may be, and so how long after an event one is waited for.
    pub longest: Second,
}

/// What an event keeps of its steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Keeps {
    /// The runs that meet the condition whatever the PET is: it asks for the PET.
    pub met: bool,
    /// Each step.
    pub steps: bool,
    /// The crash probability of the last step, for alarms.
    pub probability: bool,
}

impl Event {
    /// Starts an event.
    pub fn of(seen: &Observation, keeps: Keeps) -> Self {
        let pair = [seen.found.ego, seen.found.foe];
        let followed = Span::of(seen, keeps.steps);
        let last = Seen::of(seen.frame, &pair).unwrap_or_default();
        let met = keeps.met.then(Vec::new);
        let mut event = Self { pair, alarm: None, followed, pet_below: f64::NEG_INFINITY, met, last, driven: None };
        event.note(seen, keeps);
        event
    }

    /// Adds a later step.
    pub fn take(&mut self, seen: &Observation, keeps: Keeps) {
        self.followed.take(seen);
        self.note(seen, keeps);
    }

    /// What the first step and each later one add alike.
    fn note(&mut self, seen: &Observation, keeps: Keeps) {
        let Encounter { ego, foe, kind, x, y, margin, nearness, pet_below, .. } = *seen.found;
        if seen.found.is_logged() {
            let (severity, time, at) = (self.followed.extremes.last.severity, seen.frame.time, Point::new(x, y));
            let (_, artefact) = self.followed.extremes.verdict();
            let nearness = if keeps.probability { seen.nearness_with_probability() } else { nearness };
            self.alarm = Some(Alarm { ego, foe, severity, artefact, kind, at, time, margin, nearness });
        }
        if let Some(met) = &mut self.met {
            if !seen.found.is_logged() {
                self.pet_below = self.pet_below.max(pet_below);
            } else if let Some(last) = met.last_mut().filter(|last| !is_over(&last.extremes, seen.frame.time)) {
                last.take(seen);
            } else {
                met.push(Span::of(seen, keeps.steps));
            }
        }
        if seen.found.may_cross() && self.driven.is_none() {
            let paths = self.pair.map(|user| driven_before(user, seen));
            self.driven = Some(Box::new(Driven { paths, pet: None }));
        }
    }

    /// The two road users.
    pub fn pair(&self) -> Pair {
        in_order(self.pair)
    }

    /// Its parts that are at least this severe, and count.
    pub fn severe(&self, least: Severity, rules: Rules) -> SevereEvent {
        let spans = [&self.followed].into_iter().chain(self.met.iter().flatten());
        let pet = self.driven.as_ref().and_then(|driven| driven.pet);
        let severe = spans.map(|span| &span.extremes).filter(|extremes| {
            let (assessment, artefact) = extremes.verdict_with(pet, rules.severity);
            assessment.severity >= least && (artefact.is_none() || rules.counts_artefacts)
        });
        let worst = severe.map(|extremes| (extremes.worst.time, Point::new(extremes.worst.x, extremes.worst.y)));
        SevereEvent { pair: self.pair(), worst: worst.collect() }
    }

    /// The conflicts that it is, by the PET so far.
    pub fn conflicts(&self, roster: &Roster, rule: SeverityThresholds) -> impl Iterator<Item = Conflict> {
        let pet = self.driven.as_ref().and_then(|driven| driven.pet);
        let spans = match &self.met {
            Some(met) if pet.is_none_or(|pet| pet.lasts >= self.pet_below) => &met[..],
            _ => std::slice::from_ref(&self.followed),
        };
        spans.iter().map(move |span| span.conflict(pet, roster, rule))
    }

    /// Takes how close the two came since the step before, if that met the condition. They collide where they overlap by
    /// more than its tolerance, and `is_seen` where they do now. `has_jumped` says whether one of them has meanwhile
    /// changed lanes, which SUMO does at once: it did not drive across.
    pub(crate) fn come_closest(
        &mut self,
        (frame, roster, before): (&Frame, &Roster, Second),
        rules: Rules,
        is_seen: bool,
        (around, past): (Surroundings, &Past),
        has_jumped: impl Fn(UserIndex) -> bool,
    ) {
        let Some(now) = Seen::of(frame, &self.pair) else { return };
        let last = std::mem::replace(&mut self.last, now);
        let profiles = self.pair.map(|user| roster.profile_of(user));
        if self.followed.extremes.end != before || !are_rectangles(&profiles) {
            return;
        }
        let mut moments = SmallVec::<[Moment; 3]>::from_slice(&[(before, last.states)]);
        if last.behind > 0.0 {
            let lasted = frame.time - now.behind - (before - last.behind);
            moments.push((before + (frame.time - before) * (last.behind / lasted), last.reported));
        }
        moments.push((frame.time, now.states));
        let step = Between { moments: &moments, profiles };
        let Some(closest) = step.closest(rules.contact_tolerance, is_seen) else { return };
        if self.followed.extremes.is_closer(&closest) && !self.pair.into_iter().any(has_jumped) {
            let ego = usize::from(self.pair[1] == self.followed.extremes.worst.ego);
            let met = self.met.as_mut().and_then(|met| met.last_mut());
            let met = met.filter(|met| met.extremes.end == before);
            let extremes = &self.followed.extremes;
            let struck = closest.contact.map(|contact| Struck::of(&contact, (self.pair, profiles), past, rules.kinds));
            let found = struck.as_ref().and_then(|struck| {
                let found = contact_of(extremes, &closest, struck, frame)?;
                let pair = why::Pair::of((frame, roster, &found), around, past);
                Some((assessed(struck, ego, profiles, rules.severity), Artefact::of(&pair)))
            });
            [&mut self.followed]
                .into_iter()
                .chain(met)
                .for_each(|span| span.extremes.come_closer(&closest, struck, found));
        }
    }

    /// Finds how the two of a first step that is a collision struck each other, on the way from where they were last.
    pub fn strike_at_once(&mut self, seen: &Observation, rules: Rules) {
        let Observation { frame, roster, found, past, .. } = *seen;
        let profiles = self.pair.map(|user| roster.profile_of(user));
        let Some(now) = Seen::of(frame, &self.pair).filter(|_| found.collision && are_rectangles(&profiles)) else {
            return;
        };
        let [a, b] = [0, 1].map(|one| {
            let (time, place, heading) = past.of(self.pair[one], frame.time).last()?;
            Some((time, State { x: place.x, y: place.y, heading, ..now.states[one] }))
        });
        let Some(((time, a), (_, b))) = a.zip(b).filter(|((of_a, _), (of_b, _))| of_a == of_b) else { return };
        let moments = [(time, [a, b]), (frame.time, now.states)];
        let closest = Between { moments: &moments, profiles }.closest(rules.contact_tolerance, true);
        let struck = closest.and_then(|closest| closest.contact);
        let struck = struck.map(|contact| Struck::of(&contact, (self.pair, profiles), past, rules.kinds));
        let met = self.met.as_mut().and_then(|met| met.last_mut());
        [&mut self.followed].into_iter().chain(met).for_each(|span| span.extremes.struck = struck);
    }

    /// The PET at this time, if the first of both has left the conflict area; `ahead` has the poses that a road user will go
    /// through.
    pub fn pet_so_far(&self, time: Second, ahead: impl Fn(UserIndex) -> Vec<Pose>, pets: Pets) -> Option<PetSoFar> {
        let Driven { paths: [a, b], .. } = self.driven.as_deref()?;
        let mut halves = Bisection::default();
        let known = pet::post_encroachment_time(&mut halves, a, b, pets.widest);
        if let Some(pet) = known.filter(|pet| pet.is_final) {
            return Some(PetSoFar::Known(pet.lasts));
        }
        let expected = [(a, b, self.pair[1]), (b, a, self.pair[0])].into_iter().find_map(|(first, second, user)| {
            let second = second.going_on(&ahead(user));
            let Pet { lasts, enters, .. } = pet::post_encroachment_time(&mut halves, first, &second, pets.widest)?;
            Some(if enters > time { PetSoFar::AtLeast(time - (enters - lasts)) } else { PetSoFar::Known(lasts) })
        });
        expected.or(known.map(|pet| PetSoFar::Known(pet.lasts)))
    }

    /// Whether the condition holds at this time, that of its last step.
    pub(crate) fn is_met_at(&self, time: Second) -> bool {
        self.followed.extremes.end == time
    }

    /// The vehicles that stood at this time, its last step, and of which a stop would be a cause.
    pub fn standing(&self, time: Second) -> impl Iterator<Item = UserIndex> {
        let spans = [&self.followed].into_iter().chain(self.met.iter().filter_map(|met| met.last()));
        let last = spans.filter(move |span| span.extremes.end == time);
        last.flat_map(|span| span.extremes.standing.into_iter().flatten())
    }

    /// Notes which of these vehicles stood at this time, its last step, at a scheduled stop.
    pub(crate) fn note_stopped(&mut self, stopped: &[UserIndex], time: Second) {
        let met = self.met.as_mut().and_then(|met| met.last_mut());
        for span in [&mut self.followed].into_iter().chain(met).filter(|span| span.extremes.end == time) {
            if span.extremes.standing.iter().flatten().any(|user| stopped.contains(user)) {
                span.stood(time);
            }
        }
    }

    /// Notes whether SUMO reports a collision of the two.
    pub fn mark(&mut self, is_reported: bool) {
        self.followed.mark(is_reported);
        self.met.iter_mut().flat_map(|met| met.last_mut()).for_each(|met| met.mark(is_reported));
    }

    /// Records the paths of the two of an event whose paths may cross.
    pub fn follow(&mut self, frame: &Frame, roster: &Roster) {
        let Some(driven) = &mut self.driven else { return };
        for (user, path) in self.pair.iter().zip(&mut driven.paths) {
            // An index given to another road user meanwhile is not followed.
            let Some(row) = frame.row_of(*user).filter(|_| !path.has_ended()) else {
                path.end();
                continue;
            };
            if roster.profile_of(*user).category != Category::Obstacle {
                let state = frame.state(row);
                path.drive_to(frame.time, state.front(), state.heading);
                if frame.behind() > 0.0 {
                    let state = frame.reported(row);
                    path.drive_to(frame.time + frame.behind(), state.front(), state.heading);
                }
            }
        }
    }

    /// Whether it closes at this step; the alarm ends when the condition without the PET has not been met for as long.
    pub fn closes(&mut self, frame: &Frame) -> bool {
        let last = self.met.as_ref().map(|met| met.last());
        if last.is_some_and(|last| last.is_none_or(|last| is_over(&last.extremes, frame.time))) {
            self.alarm = None;
        }
        is_over(&self.followed.extremes, frame.time) || self.pair.iter().any(|user| frame.row_of(*user).is_none())
    }

    /// Whether the PET of a closed event is known at this time, or will not be. If the second is about to shorten it, it waits
    /// as long again.
    pub(crate) fn settles(&mut self, time: Second, halves: &mut Bisection, pets: Pets) -> bool {
        let since = time - self.followed.extremes.end;
        let Some(Driven { paths, pet }) = self.driven.as_deref_mut() else { return true };
        let wait = CLOSES_AFTER + pets.longest - SAME_MOMENT;
        let has_ended = paths.iter().any(DrivenPath::has_ended);
        if !has_ended && (2.0 * CLOSES_AFTER..wait).contains(&since) {
            return false;
        }
        let found = pet::post_encroachment_time(halves, &paths[0], &paths[1], pets.widest);
        *pet = found.filter(|pet| pet.is_final && pet.lasts <= pets.longest);
        let is_under_way = found.is_some_and(|pet| !pet.is_final) && since < wait + pets.longest;
        pet.is_some() || has_ended || (since >= wait && !is_under_way)
    }
}

/// Whether both are single rectangles: neither an obstacle nor articulated.
fn are_rectangles(profiles: &[&Profile; 2]) -> bool {
    profiles.iter().all(|of| of.category != Category::Obstacle && of.carriages == 1)
}

/// Two road users in the order of their indices.
pub(super) fn in_order([one, other]: [UserIndex; 2]) -> Pair {
    [one.min(other), one.max(other)]
}

/// The contact of the two between two steps as an encounter of the second.
fn contact_of(of: &Extremes, closest: &Closest, struck: &Struck, frame: &Frame) -> Option<Encounter> {
    let WorstStep { ego, foe, mu, .. } = of.worst;
    let (Struck { kind, angle, .. }, at) = (*struck, struck.front_of(ego));
    Some(Encounter {
        ego,
        foe,
        ego_row: frame.row_of(ego)?,
        foe_row: frame.row_of(foe)?,
        kind,
        angle,
        gap: 0.0,
        mu,
        margin: -mu,
        ego_distance: 0.0,
        foe_distance: 0.0,
        foe_leads: true,
        x: at.x,
        y: at.y,
        lane: None,
        overlap: closest.overlap,
        collision: true,
        nearness: None,
        pet_below: Second::INFINITY,
    })
}

/// How severe a contact is; `ego` is the place of the ego in the pair.
fn assessed(struck: &Struck, ego: usize, profiles: [&Profile; 2], rule: SeverityThresholds) -> Assessment {
    let [of_ego, of_foe] = [ego, 1 - ego].map(|one| Body::of(profiles[one], struck.delta_v[one]));
    let inputs = SeverityInputs {
        ttc: Some(0.0),
        drac: None,
        ego_deceleration: profiles[ego].brakes.deceleration,
        ttb: Some(0.0),
        crash_probability: 1.0,
        braking: 0.0,
        delta_v: of_ego.delta_v.max(of_foe.delta_v),
        injury_probability: injury_probability(struck.kind, of_ego, of_foe),
        collision: true,
    };
    Assessment::of(&inputs, rule)
}

/// The path of a road user in the seconds before a step.
fn driven_before(user: UserIndex, seen: &Observation) -> DrivenPath {
    let profile = seen.roster.profile_of(user);
    let mut path = DrivenPath::of_carriages(profile.carriages(), profile.width);
    if profile.category != Category::Obstacle {
        let past = seen.past.all_of(user, seen.frame.time);
        past.for_each(|(time, front, heading)| path.drive_to(time, front, heading));
    }
    path
}

impl Seen {
    /// Where a pair is in a step, if both are there.
    fn of(frame: &Frame, pair: &Pair) -> Option<Self> {
        let [one, other] = pair.map(|user| frame.row_of(user));
        let rows = [one?, other?];
        let [states, reported] = [Frame::state, Frame::reported].map(|of| rows.map(|row| *of(frame, row)));
        Some(Self { states, reported, behind: frame.behind() })
    }
}

/// Whether a run of steps has ended so long before this time that it is closed.
fn is_over(extremes: &Extremes, time: Second) -> bool {
    time - extremes.end >= CLOSES_AFTER - SAME_MOMENT
}
