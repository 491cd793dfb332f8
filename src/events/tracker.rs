//! Follows the pairs that meet the log's condition over the steps, each as an event.

use smallvec::SmallVec;

use super::alarm::{Alarm, PetSoFar};
use super::event::Conflict;
use super::extremes::Observation;
use super::past::Past;
use super::under_way::{Event, Keeps, Pair, Pets, Rules, SevereEvent, in_order};
use super::why::Surroundings;
use crate::detection::encounter::Encounter;
use crate::detection::kind::Severity;
use crate::detection::path::Pose;
use crate::geometry::bisection::Bisection;
use crate::options::Options;
use crate::traffic::frame::Frame;
use crate::traffic::roster::{Roster, UserIndex};
use crate::util::units::Second;

/// Follows the pairs that meet the log's condition over the steps.
#[derive(Debug)]
pub struct Tracker {
    pets: Pets,
    keeps: Keeps,
    rules: Rules,
    past: Past,
    /// The time of the last step; not a number before the first.
    last_time: Second,
    /// In the order of the pairs.
    #[expect(clippy::vec_box, reason = "they are inserted in order, and an event is large")]
    events: Vec<Box<Event>>,
    /// Closed, but its PET is not known yet.
    #[expect(clippy::vec_box, reason = "as above")]
    waiting: Vec<Box<Event>>,
    closed: Vec<Conflict>,
    /// The events that these were.
    #[expect(clippy::vec_box, reason = "as above")]
    settled: Vec<Box<Event>>,
}

impl Tracker {
    /// A tracker of what is logged with these options; it keeps each step of a conflict if these are logged, too.
    pub fn new(options: &Options, keeps_steps: bool) -> Self {
        Self {
            pets: Pets { widest: options.kind_bounds().rear_end_below, longest: options.log.longest_pet() },
            keeps: Keeps { met: options.log.needs_pet(), steps: keeps_steps, probability: false },
            rules: Rules {
                contact_tolerance: options.contact_tolerance,
                severity: options.severity_thresholds(),
                kinds: options.kind_bounds(),
                counts_artefacts: options.artefacts,
            },
            past: Past::of_last(options.log.longest_pet()),
            last_time: Second::NAN,
            events: Vec::new(),
            waiting: Vec::new(),
            closed: Vec::new(),
            settled: Vec::new(),
        }
    }

    /// Takes the encounters of one step and returns the conflicts that it settles, in the order of their begin and ids.
    /// `around` is what else is known; `collided` are the pairs of ids of which SUMO reports a collision, if that is known.
    pub fn step<'a>(
        &mut self,
        frame: &Frame,
        roster: &Roster,
        encounters: impl Iterator<Item = &'a Encounter> + Clone,
        around: Surroundings,
        collided: Option<&[[String; 2]]>,
    ) -> &[Conflict] {
        self.forget_closed();
        let before = std::mem::replace(&mut self.last_time, frame.time);
        if !self.events.is_empty() || !self.waiting.is_empty() || encounters.clone().any(Encounter::may_be_logged) {
            self.come_closest(frame, roster, before, encounters.clone(), around);
            if !around.stopped.is_empty() {
                self.events.iter_mut().for_each(|event| event.note_stopped(around.stopped, before));
            }
            let past = std::mem::take(&mut self.past);
            let lasted = if before.is_nan() { 0.0 } else { frame.time - before };
            for found in encounters.filter(|found| found.may_be_logged()) {
                let chosen = (around.chosen)(found);
                let chosen = chosen.as_deref();
                let rule = self.rules.severity;
                self.take(&Observation { frame, roster, found, chosen, lasted, around, past: &past, rule });
            }
            self.past = past;
            if let Some(collided) = collided {
                self.mark(collided, roster);
            }
            self.events.iter_mut().chain(&mut self.waiting).for_each(|event| event.follow(frame, roster));
            self.waiting.extend(self.events.extract_if(.., |event| event.closes(frame)));
            self.settle(frame.time, roster);
        }
        self.past.add(frame, roster.len());
        &self.closed
    }

    /// Works out the crash probability of each step of a conflict, because alarms are asked for it.
    pub fn keep_probabilities(&mut self) {
        self.keeps.probability = true;
    }

    /// The vehicles in conflict that stood in the last step. The next one is to tell which of them stop there: SUMO says so of
    /// a vehicle one step after it has come to its stop.
    pub fn standing(&self) -> impl Iterator<Item = UserIndex> {
        self.events.iter().flat_map(|event| event.standing(self.last_time))
    }

    /// The road users that were in conflict in the last step; one in several conflicts comes several times.
    pub fn in_conflict(&self) -> impl Iterator<Item = UserIndex> {
        self.events.iter().filter(|event| event.is_met_at(self.last_time)).flat_map(|event| event.pair())
    }

    /// Forgets where a road user was that has left the scene, as its index may be given to another.
    pub fn forget(&mut self, user: UserIndex) {
        self.past.forget(user);
    }

    /// The conflicts that the last step settled.
    pub fn closed(&self) -> &[Conflict] {
        &self.closed
    }

    /// Forgets them and frees their memory, which a step in which many close would otherwise keep for the rest of the run.
    pub fn forget_closed(&mut self) {
        self.closed = Vec::new();
        self.settled = Vec::new();
    }

    /// Closes all open events at the end of the run.
    pub fn finish(&mut self, roster: &Roster) -> &[Conflict] {
        self.forget_closed();
        self.waiting.append(&mut self.events);
        self.settle(f64::INFINITY, roster);
        &self.closed
    }

    /// The open conflicts, in no particular order; without pairs that are only followed for their PET.
    pub fn alarms(&self) -> impl Iterator<Item = Alarm> {
        self.alarms_of(&self.events)
    }

    /// The conflicts that are over and wait for their PET, as in their last step, in no particular order.
    pub fn waiting(&self) -> impl Iterator<Item = Alarm> {
        self.alarms_of(&self.waiting)
    }

    fn alarms_of<'a>(&'a self, events: &'a [Box<Event>]) -> impl Iterator<Item = Alarm> + 'a {
        let alarms = events.iter().filter_map(|event| event.alarm);
        alarms.filter(|alarm| alarm.artefact.is_none() || self.rules.counts_artefacts)
    }

    /// The PET of an open or waiting conflict, or its lower bound so far; `ahead` has the poses that a road user will go through.
    pub fn pet_so_far(&self, alarm: &Alarm, ahead: impl Fn(UserIndex) -> Vec<Pose>) -> Option<PetSoFar> {
        let pair = in_order([alarm.ego, alarm.foe]);
        let event = self.events.iter().chain(&self.waiting).find(|event| event.pair() == pair)?;
        event.pet_so_far(self.last_time, ahead, self.pets)
    }

    /// The events of which a part is at least this severe, with those that this step has settled: by the PET some become so
    /// only then.
    pub(super) fn severe(&self, least: Severity) -> impl Iterator<Item = SevereEvent> {
        let events = self.events.iter().chain(&self.waiting).chain(&self.settled);
        events.map(move |event| event.severe(least, self.rules)).filter(|event| !event.worst.is_empty())
    }

    /// The conflicts that are open or wait for their PET, as they are now, in the order of their begin and ids.
    pub fn open(&self, roster: &Roster) -> Vec<Conflict> {
        let events = self.events.iter().chain(&self.waiting);
        let mut open = events.flat_map(|event| event.conflicts(roster, self.rules.severity)).collect::<Vec<_>>();
        sort(&mut open);
        open
    }

    fn take(&mut self, seen: &Observation) {
        let pair = pair_of(seen.found);
        match self.events.binary_search_by_key(&pair, |event| event.pair()) {
            Ok(place) => self.events[place].take(seen, self.keeps),
            Err(place) => {
                let mut event = Event::of(seen, self.keeps);
                event.strike_at_once(seen, self.rules);
                self.events.insert(place, Box::new(event));
            }
        }
    }

    /// Takes how close the two of each event came since the step before.
    fn come_closest<'a>(
        &mut self,
        frame: &Frame,
        roster: &Roster,
        before: Second,
        encounters: impl Iterator<Item = &'a Encounter>,
        around: Surroundings,
    ) {
        let collisions = encounters.filter(|found| found.collision).map(pair_of).collect::<SmallVec<[Pair; 4]>>();
        let has_jumped = |user: UserIndex| {
            let course = frame.row_of(user).map(|row| (around.course)(row, 0.0));
            course.is_some_and(|course| course.has_jumped || course.change.is_some_and(|change| change.time >= before))
        };
        let Self { events, rules, past, .. } = self;
        for event in events {
            let is_seen = collisions.contains(&event.pair());
            event.come_closest((frame, roster, before), *rules, is_seen, (around, past), has_jumped);
        }
    }

    /// Marks the events whose pairs collide as SUMO says.
    fn mark(&mut self, collided: &[[String; 2]], roster: &Roster) {
        for event in &mut self.events {
            let [a, b] = event.pair().map(|user| roster.id(user).as_str());
            event.mark(collided.iter().any(|[one, other]| [a, b] == [one, other] || [b, a] == [one, other]));
        }
    }

    /// Passes on the closed events whose PET is known, or will not be.
    fn settle(&mut self, time: Second, roster: &Roster) {
        // One for the step, not kept: a long wait in small steps would otherwise hold its memory for the rest of the run.
        let mut halves = Bisection::default();
        let rule = self.rules.severity;
        self.settled.extend(self.waiting.extract_if(.., |event| event.settles(time, &mut halves, self.pets)));
        self.closed.extend(self.settled.iter().flat_map(|event| event.conflicts(roster, rule)));
        sort(&mut self.closed);
    }
}

/// The two of an encounter, in their order.
fn pair_of(found: &Encounter) -> Pair {
    in_order([found.ego, found.foe])
}

fn sort(conflicts: &mut [Conflict]) {
    conflicts.sort_by(|a, b| a.begin.total_cmp(&b.begin).then_with(|| (&a.ego, &a.foe).cmp(&(&b.ego, &b.foe))));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detection::kind::Kind;
    use crate::events::Moment;
    use crate::geometry::Point;
    use crate::traffic::frame::State;
    use crate::traffic::profile::Profile;
    use crate::traffic::sumo_type::SumoType;

    /// The bound of the PET in the condition of these tests.
    const PET: f64 = 2.0;

    /// Surroundings of which nothing is known.
    fn nothing() -> Surroundings<'static> {
        static SIGNALS: std::sync::LazyLock<crate::traffic::signals::Signals> =
            std::sync::LazyLock::new(Default::default);
        Surroundings {
            net: None,
            is_tracked: false,
            step: 0.5,
            signals: &SIGNALS,
            stopped: &[],
            path: &|_| Vec::new(),
            course: &|_, _| Default::default(),
            chosen: &|_| None,
            crash_probability: &|near, _| Some(near.crash_at_most[0]),
            tadv: &|_| None,
        }
    }

    struct TrackedPair {
        tracker: Tracker,
        roster: Roster,
        users: [UserIndex; 2],
        /// What SUMO reports, if that is known.
        collided: Option<Vec<[String; 2]>>,
    }

    impl TrackedPair {
        fn new() -> Self {
            let mut roster = Roster::default();
            let sumo = SumoType { width: 2.0, ..SumoType::car("car") };
            let profile = roster.profile(Profile::vehicle(&sumo, &Options::default())).unwrap();
            let users = [roster.enter("a", profile), roster.enter("b", profile)];
            Self { tracker: Tracker::new(&Options::default(), false), roster, users, collided: None }
        }

        fn logging(condition: &str) -> Self {
            let options = Options { log: condition.parse().unwrap(), ..Options::default() };
            Self { tracker: Tracker::new(&options, true), ..Self::new() }
        }

        /// A step in which both are there and their margin is this (rear-end).
        fn step(&mut self, time: f64, margin: f64) -> Vec<Conflict> {
            self.step_with(time, &[(0, 0.0), (1, 20.0)], margin, Kind::RearEnd)
        }

        fn encounter(&self, kind: Kind, margin: f64, pet_below: f64) -> Encounter {
            Encounter {
                ego: self.users[0],
                foe: self.users[1],
                ego_row: 0,
                foe_row: 1,
                kind,
                angle: 0.0,
                gap: 10.0 + margin,
                mu: 10.0,
                margin,
                ego_distance: 10.0,
                foe_distance: 0.0,
                foe_leads: true,
                x: 0.0,
                y: 0.0,
                lane: None,
                overlap: 0.0,
                collision: false,
                nearness: None,
                pet_below,
            }
        }

        fn step_with(&mut self, time: f64, present: &[(usize, f64)], margin: f64, kind: Kind) -> Vec<Conflict> {
            let mut frame = Frame::default();
            frame.begin(time);
            for &(user, x) in present {
                frame.push(self.users[user], State { x, y: 0.0, z: 0.0, heading: 0.0, speed: 10.0 });
            }
            let pet_below = match margin {
                ..0.0 => f64::INFINITY,
                _ if kind == Kind::Side && self.tracker.keeps.met => PET,
                _ => f64::NEG_INFINITY,
            };
            let encounter = self.encounter(kind, margin, pet_below);
            let found = if present.len() == 2 { vec![encounter] } else { vec![] };
            self.tracker.step(&frame, &self.roster, found.iter(), nothing(), self.collided.as_deref()).to_vec()
        }
    }

    #[test]
    fn a_conflict_closes_after_a_second_of_positive_margin() {
        let mut scene = TrackedPair::new();
        for (time, margin) in [(0.0, 1.0), (0.5, -1.0), (1.0, -3.0), (1.5, -2.0), (2.0, 1.0)] {
            assert_eq!(scene.step(time, margin), []);
        }
        assert_eq!(scene.tracker.alarms().count(), 1);
        let [closed] = &scene.step(2.5, 1.0)[..] else { panic!() };
        assert_eq!((closed.begin, closed.end, closed.time, closed.margin), (0.5, 1.5, 1.0, -3.0));
        assert_eq!(scene.tracker.alarms().count(), 0);
    }

    #[test]
    fn of_margins_equal_but_for_rounding_the_first_counts() {
        let mut scene = TrackedPair::new();
        for (time, margin) in [(0.0, -1.0), (0.5, -3.0), (1.0, -3.0 - 1e-14), (1.5, -1.0)] {
            scene.step(time, margin);
        }
        let [closed] = scene.tracker.finish(&scene.roster) else { panic!() };
        assert_eq!((closed.time, closed.margin), (0.5, -3.0));
    }

    #[test]
    fn less_than_a_second_of_positive_margin_continues_the_conflict() {
        let mut scene = TrackedPair::new();
        for (time, margin) in [(0.0, -1.0), (0.9, 1.0), (1.5, -2.0), (2.0, 1.0)] {
            scene.step(time, margin);
        }
        let [closed] = scene.tracker.finish(&scene.roster) else { panic!() };
        assert_eq!((closed.begin, closed.end), (0.0, 1.5));
    }

    #[test]
    fn a_conflict_closes_when_one_of_the_two_leaves() {
        let mut scene = TrackedPair::new();
        scene.step(0.0, -1.0);
        assert_eq!(scene.step_with(0.1, &[(0, 0.0)], -1.0, Kind::RearEnd).len(), 1);
    }

    #[test]
    fn a_collision_that_sumo_reports_is_that_of_the_open_event() {
        let mut scene = TrackedPair::new();
        let mut marks = Vec::new();
        for collided in [None, Some(vec![]), Some(vec![["b", "x"]]), Some(vec![["b", "a"]]), Some(vec![])] {
            scene.collided = collided.map(|pairs| pairs.iter().map(|pair| pair.map(str::to_owned)).collect());
            scene.step(0.1 * marks.len() as f64, -1.0);
            marks.push(scene.tracker.open(&scene.roster)[0].collision_sumo);
        }
        assert_eq!(marks, [None, Some(false), Some(false), Some(true), Some(true)]);
    }

    #[test]
    fn a_crash_between_two_steps_is_a_collision() {
        let mut scene = TrackedPair::new();
        // Both cars are at the crossing after half a second; neither step shows them there.
        for (time, driven) in [(0.0, -10.0), (1.0, 15.0)] {
            let mut frame = Frame::default();
            frame.begin(time);
            frame.push(scene.users[0], State { x: driven, y: 0.0, z: 0.0, heading: 0.0, speed: 25.0 });
            let heading = std::f64::consts::FRAC_PI_2;
            frame.push(scene.users[1], State { x: 0.0, y: driven, z: 0.0, heading, speed: 25.0 });
            let found = (time == 0.0).then(|| scene.encounter(Kind::Side, -1.0, f64::INFINITY));
            scene.tracker.step(&frame, &scene.roster, found.iter(), nothing(), None);
        }
        let [crash] = scene.tracker.finish(&scene.roster) else { panic!() };
        assert!(crash.collision && crash.overlap > 1.0 && crash.clearance == 0.0);
        assert_eq!((crash.severity, crash.values.ttc()), (Severity::Critical, Some(0.0)));
        let Moment { time, x, speed, .. } = crash.found[0].unwrap();
        assert!(0.3 < time && time < 0.5 && (x - (25.0 * time - 10.0)).abs() < 1e-9 && speed == 25.0, "{time} {x}");
    }

    #[test]
    fn a_side_conflict_waits_for_its_pet() {
        let mut scene = TrackedPair::new();
        let both = [(0, 0.0), (1, 20.0)];
        scene.step_with(0.0, &both, -1.0, Kind::Side);
        assert_eq!(scene.step_with(1.0, &both, 1.0, Kind::Side), []);
        assert_eq!(scene.step_with(5.9, &both, 1.0, Kind::Side), []);
        assert_eq!(scene.step_with(6.0, &both, 1.0, Kind::Side).len(), 1);
    }

    /// The begin, end and steps of conflicts.
    fn spans(conflicts: &[Conflict]) -> Vec<(f64, f64, usize)> {
        conflicts.iter().map(|conflict| (conflict.begin, conflict.end, conflict.steps.len())).collect()
    }

    /// Two whose paths cross: the first leaves the conflict area at 1 s, the second enters it this much later.
    fn crossing(scene: &mut TrackedPair, pet: f64, margins: &[(f64, f64)]) -> Vec<Conflict> {
        crossing_in(0..=100, scene, pet, margins)
    }

    /// The same in these steps of 0.1 s.
    fn crossing_in(
        steps: std::ops::RangeInclusive<u32>,
        scene: &mut TrackedPair,
        pet: f64,
        margins: &[(f64, f64)],
    ) -> Vec<Conflict> {
        let mut found = Vec::new();
        for step in steps {
            let time = f64::from(step) / 10.0;
            let margin =
                margins.iter().find(|(at, _)| (at - time).abs() < 1e-9).map_or(f64::INFINITY, |(_, margin)| *margin);
            let mut frame = Frame::default();
            frame.begin(time);
            // Cars of 5 m by 2 m; the first drives east, the second north.
            frame.push(scene.users[0], State { x: 10.0 * time - 4.0, y: 0.0, z: 0.0, heading: 0.0, speed: 10.0 });
            let y = 10.0 * (time - 1.0 - pet) - 1.0;
            let heading = std::f64::consts::FRAC_PI_2;
            frame.push(scene.users[1], State { x: 0.0, y, z: 0.0, heading, speed: 10.0 });
            let pet_below = if margin < 0.0 { f64::INFINITY } else { PET };
            let encounter = scene.encounter(Kind::Side, margin, pet_below);
            let seen = (margin < f64::INFINITY).then_some(encounter);
            found.extend_from_slice(scene.tracker.step(&frame, &scene.roster, seen.iter(), nothing(), None));
        }
        found
    }

    #[test]
    fn a_pair_followed_for_its_pet_is_logged_if_that_is_short() {
        let steps = [(0.2, 5.0), (0.3, 4.0), (0.4, 3.0)];
        let [short, long] = [1.5, 2.5].map(|pet| crossing(&mut TrackedPair::logging("pet < 2"), pet, &steps));
        assert_eq!(spans(&short), [(0.2, 0.4, 3)]);
        assert!((short[0].pet.unwrap() - 1.5).abs() < 1e-6 && short[0].margin == 3.0);
        assert_eq!(spans(&long), []);
    }

    #[test]
    fn without_that_pet_each_run_that_meets_the_rest_is_a_conflict() {
        let steps = [(0.2, 5.0), (0.3, -1.0), (0.4, -2.0), (1.0, 1.0), (1.9, 1.0), (2.0, -1.0), (2.1, 1.0)];
        let condition = "pet < 2 or margin < 0";
        let [short, long] = [1.5, 2.5].map(|pet| crossing(&mut TrackedPair::logging(condition), pet, &steps));
        assert_eq!(spans(&short), [(0.2, 2.1, 7)]);
        assert_eq!(spans(&long), [(0.3, 0.4, 2), (2.0, 2.0, 1)]);
        assert!(long.iter().all(|conflict| (conflict.pet.unwrap() - 2.5).abs() < 1e-6));
    }

    #[test]
    fn the_pet_so_far_is_a_lower_bound_until_the_second_comes() {
        let mut scene = TrackedPair::new();
        let mut so_far = |steps: std::ops::RangeInclusive<u32>| {
            let now = f64::from(*steps.end()) / 10.0;
            crossing_in(steps, &mut scene, 1.5, &[(0.2, -5.0), (0.3, -4.0)]);
            let north = |driven: f64| Pose {
                distance: driven,
                front: Point::new(0.0, 10.0 * now - 26.0 + driven),
                axis: [0.0, 1.0].into(),
            };
            let ahead = |user| if user == scene.users[1] { vec![north(0.0), north(20.0)] } else { Vec::new() };
            let alarm = scene.tracker.alarms().chain(scene.tracker.waiting()).next().unwrap();
            (scene.tracker.waiting().count(), scene.tracker.pet_so_far(&alarm, ahead))
        };
        assert_eq!(so_far(0..=9), (0, None));
        for (steps, waiting, wanted) in [(10..=12, 0, 0.2), (13..=20, 1, 1.0)] {
            let (count, Some(PetSoFar::AtLeast(pet))) = so_far(steps) else { panic!() };
            assert!(count == waiting && (pet - wanted).abs() < 1e-6, "{count} {pet}");
        }
        let (1, Some(PetSoFar::Known(pet))) = so_far(21..=26) else { panic!() };
        assert!((pet - 1.5).abs() < 1e-6, "{pet}");
    }

    #[test]
    fn a_pair_that_is_only_followed_raises_no_alarm() {
        let mut scene = TrackedPair::logging("pet < 2 or margin < 0");
        let both = [(0, 0.0), (1, 20.0)];
        let alarms = [1.0, -1.0, 1.0, 1.0].into_iter().zip(0..).map(|(margin, number)| {
            scene.step_with(0.5 * f64::from(number), &both, margin, Kind::Side);
            (scene.tracker.alarms().count(), scene.tracker.open(&scene.roster).len())
        });
        assert_eq!(alarms.collect::<Vec<_>>(), [(0, 0), (1, 1), (1, 1), (0, 1)]);
    }
}
