//! Encounters become conflicts: one event per pair and run of steps that meet the log's condition.
//!
//! An event opens at the first step that meets the condition and closes when it has not been met for [`CLOSES_AFTER`] or
//! one of the two has left the scene. A side or frontal event then waits for its PET, at most [`pet::WAIT`].
//!
//! Where the condition asks for the PET, a pair is followed over all steps that meet it if the PET is short enough. Whether
//! it is, is known at the end: then the whole event is one conflict. Otherwise only what meets the rest of the condition is
//! logged, each run of such steps as a conflict of its own.

mod added;
mod event;
mod extremes;
mod moment;
mod past;
mod snapshot;
mod span;
mod why;

pub use event::Conflict;
pub use moment::Moment;
pub use why::{Cause, Causes, Manoeuvre, Surroundings};

use crate::detection::encounter::{Encounter, Nearness};
use crate::detection::kind::{Kind, Severity};
use crate::detection::measures::driven_path::DrivenPath;
use crate::detection::measures::pet;
use crate::geometry::Point;
use crate::geometry::bisection::Bisection;
use crate::options::Options;
use crate::traffic::frame::Frame;
use crate::traffic::profile::Category;
use crate::traffic::roster::{Roster, UserIndex};
use crate::util::units::{Metre, Radian, SAME_MOMENT, Second};
use extremes::{Extremes, Observation};
use past::Past;
use span::Span;

pub use snapshot::Snapshot;

/// How long the condition must not be met before an event closes, in s (docs/log.md).
pub const CLOSES_AFTER: Second = 1.0;

/// The road users of an open conflict and its current severity, as painted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alarm {
    /// The ego of the last step that meets the log's condition.
    pub ego: UserIndex,
    /// The foe of that step.
    pub foe: UserIndex,
    /// The severity in that step.
    pub severity: Severity,
    /// The kind in that step.
    pub kind: Kind,
    /// The ego's front at the conflict point of that step, or that of its carriage that touches.
    pub at: Point,
    /// That step, in s.
    pub time: Second,
    /// The margin in that step, in m.
    pub margin: Metre,
    /// The measures of that step.
    pub nearness: Option<Nearness>,
}

/// Follows the pairs that meet the log's condition over the steps.
#[derive(Debug)]
pub struct Tracker {
    /// Paths that meet at a smaller angle do not cross.
    crossing: Radian,
    /// Whether the condition asks for the PET.
    needs_pet: bool,
    /// Whether each step of a conflict is kept.
    keeps_steps: bool,
    past: Past,
    /// The time of the last step; not a number before the first.
    last_time: Second,
    /// In the order of the pairs.
    events: Vec<(Pair, Box<Event>)>,
    /// Closed, but its PET is not known yet.
    waiting: Vec<(Pair, Box<Event>)>,
    closed: Vec<Conflict>,
}

/// Two road users, in their order.
type Pair = [UserIndex; 2];

/// An event under way, or closed and waiting for its PET.
#[derive(Debug)]
struct Event {
    /// None while the pair is only followed for its PET.
    alarm: Option<Alarm>,
    /// All steps that meet the condition if the PET is short enough.
    followed: Span,
    /// The PET has to be below this for that.
    pet_below: Second,
    /// The runs of steps that meet the condition whatever the PET is; none where it does not ask for the PET.
    met: Option<Vec<Span>>,
    driven: Option<Box<PetTracker>>,
}

/// The paths that the two of a side or frontal event have driven, from some seconds before it became one, in their order,
/// and the PET so far.
#[derive(Debug)]
struct PetTracker {
    paths: [DrivenPath; 2],
    pet: Option<pet::Pet>,
}

impl Event {
    fn pet(&self) -> Option<pet::Pet> {
        self.driven.as_ref().and_then(|driven| driven.pet)
    }

    /// The conflicts that it is, by the PET so far.
    fn conflicts(&self, roster: &Roster) -> impl Iterator<Item = Conflict> {
        let pet = self.pet();
        let spans = match &self.met {
            Some(met) if pet.is_none_or(|pet| pet.lasts >= self.pet_below) => &met[..],
            _ => std::slice::from_ref(&self.followed),
        };
        spans.iter().map(move |span| span.conflict(pet, roster))
    }

    /// Adds a step, the first or a later one, to the runs that need no PET.
    fn meet(met: &mut Vec<Span>, seen: &Observation, path: &impl Fn(u32) -> Vec<Point>, keeps_steps: bool) {
        match met.last_mut().filter(|last| !is_over(&last.extremes, seen.frame.time)) {
            Some(last) => last.take(seen, path),
            None => met.push(Span::of(seen, path, keeps_steps)),
        }
    }
}

impl Tracker {
    /// A tracker of what is logged with these options.
    pub fn new(options: &Options) -> Self {
        Self {
            crossing: options.kind_bounds().rear_end_below,
            needs_pet: options.log.needs_pet(),
            keeps_steps: options.series_file().is_some(),
            past: Past::default(),
            last_time: Second::NAN,
            events: Vec::new(),
            waiting: Vec::new(),
            closed: Vec::new(),
        }
    }

    /// Takes the encounters of one step and returns the conflicts that it settles, in the order of their begin and ids.
    /// `path` returns the path of a row's front bumper, from where it is; `around` is what else is known; `collided` are the
    /// pairs of ids of which SUMO
    /// reports a collision, if that is known.
    pub fn step<'a>(
        &mut self,
        frame: &Frame,
        roster: &Roster,
        encounters: impl Iterator<Item = &'a Encounter> + Clone,
        path: impl Fn(u32) -> Vec<Point>,
        around: Surroundings,
        collided: Option<&[[String; 2]]>,
    ) -> &[Conflict] {
        self.forget_closed();
        let lasted = if self.last_time.is_nan() { 0.0 } else { frame.time - self.last_time };
        self.last_time = frame.time;
        if !self.events.is_empty() || !self.waiting.is_empty() || encounters.clone().any(Encounter::may_be_logged) {
            let past = std::mem::take(&mut self.past);
            for found in encounters.filter(|found| found.may_be_logged()) {
                let added = (around.added)(found);
                let added = added.as_deref();
                self.take(&Observation { frame, roster, found, added, lasted, around, past: &past }, &path);
            }
            self.past = past;
            if let Some(collided) = collided {
                self.mark(collided, roster);
            }
            self.follow(frame, roster);
            self.close(frame);
            self.settle(frame.time, false, roster);
            sort(&mut self.closed);
        }
        self.past.add(frame, roster.len());
        &self.closed
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
    }

    /// Closes all open events at the end of the run.
    pub fn finish(&mut self, roster: &Roster) -> &[Conflict] {
        self.closed.clear();
        self.waiting.append(&mut self.events);
        self.settle(f64::INFINITY, true, roster);
        sort(&mut self.closed);
        &self.closed
    }

    /// The open conflicts, in no particular order; without pairs that are only followed for their PET.
    pub fn alarms(&self) -> impl Iterator<Item = Alarm> {
        self.events.iter().filter_map(|(_, event)| event.alarm)
    }

    /// The conflicts that are open or wait for their PET, as they are now, in the order of their begin and ids.
    pub fn open(&self, roster: &Roster) -> Vec<Conflict> {
        let events = self.events.iter().chain(&self.waiting);
        let mut open = events.flat_map(|(_, event)| event.conflicts(roster)).collect::<Vec<_>>();
        sort(&mut open);
        open
    }

    fn take(&mut self, seen: &Observation, path: &impl Fn(u32) -> Vec<Point>) {
        let Encounter { ego, foe, kind, x, y, margin, nearness, pet_below, .. } = *seen.found;
        let (severity, time, at) = (seen.severity(), seen.frame.time, Point::new(x, y));
        let alarm = Alarm { ego, foe, severity, kind, at, time, margin, nearness };
        let alarm = Some(alarm).filter(|_| seen.found.is_logged());
        let pair = [ego.min(foe), ego.max(foe)];
        let place = match self.events.binary_search_by_key(&pair, |(known, _)| *known) {
            Ok(place) => {
                let (_, event) = &mut self.events[place];
                event.alarm = alarm.or(event.alarm);
                event.followed.take(seen, path);
                place
            }
            Err(place) => {
                let (followed, met) = (Span::of(seen, path, self.keeps_steps), self.needs_pet.then(Vec::new));
                let event = Event { alarm, followed, pet_below: Second::NEG_INFINITY, met, driven: None };
                self.events.insert(place, (pair, Box::new(event)));
                place
            }
        };
        let (_, event) = &mut self.events[place];
        if let Some(met) = &mut event.met {
            if seen.found.is_logged() {
                Event::meet(met, seen, path, self.keeps_steps);
            } else {
                event.pet_below = event.pet_below.max(pet_below);
            }
        }
        if kind != Kind::RearEnd && event.driven.is_none() {
            let paths = pair.map(|user| {
                let profile = seen.roster.profile_of(user);
                let mut path = DrivenPath::of_carriages(profile.carriages(), profile.width);
                if profile.category != Category::Obstacle {
                    seen.past
                        .of(user, seen.frame.time)
                        .for_each(|(time, front, heading)| path.push(time, front, heading));
                }
                path
            });
            event.driven = Some(Box::new(PetTracker { paths, pet: None }));
        }
    }

    /// Marks the open events whose pairs collide as SUMO says.
    fn mark(&mut self, collided: &[[String; 2]], roster: &Roster) {
        for (pair, event) in &mut self.events {
            let [a, b] = pair.map(|user| roster.id(user).as_str());
            let is_reported = collided.iter().any(|[one, other]| [a, b] == [one, other] || [b, a] == [one, other]);
            event.followed.mark(is_reported);
            event.met.iter_mut().flat_map(|met| met.last_mut()).for_each(|met| met.mark(is_reported));
        }
    }

    /// Records the paths of the pairs in side and frontal events.
    fn follow(&mut self, frame: &Frame, roster: &Roster) {
        for (pair, event) in self.events.iter_mut().chain(&mut self.waiting) {
            let Some(driven) = &mut event.driven else { continue };
            for (user, path) in pair.iter().zip(&mut driven.paths) {
                // An index given to another road user meanwhile is not followed.
                let Some(row) = frame.row_of(*user).filter(|_| !path.has_ended()) else {
                    path.end();
                    continue;
                };
                if roster.profile_of(*user).category != Category::Obstacle {
                    let state = frame.state(row);
                    path.push(frame.time, state.front(), state.heading);
                }
            }
        }
    }

    fn close(&mut self, frame: &Frame) {
        for (_, event) in &mut self.events {
            let last = event.met.as_ref().map(|met| met.last());
            if last.is_some_and(|last| last.is_none_or(|last| is_over(&last.extremes, frame.time))) {
                event.alarm = None;
            }
        }
        let over = self.events.extract_if(.., |(pair, event)| {
            let is_gone = |user: &UserIndex| frame.row_of(*user).is_none();
            is_over(&event.followed.extremes, frame.time) || pair.iter().any(is_gone)
        });
        self.waiting.extend(over);
    }

    /// Passes on the closed events whose PET is known, or will not be.
    fn settle(&mut self, time: Second, at_once: bool, roster: &Roster) {
        // One for the step, not kept: a long wait in small steps would otherwise hold its memory for the rest of the run.
        let mut halves = Bisection::default();
        let settled = self.waiting.extract_if(.., |(_, event)| {
            let since = time - event.followed.extremes.end;
            if let (Some(driven), true) = (&mut event.driven, event.followed.extremes.worst.kind != Kind::RearEnd) {
                let PetTracker { paths, pet } = &mut **driven;
                let last_call = at_once
                    || since >= CLOSES_AFTER + pet::WAIT - SAME_MOMENT
                    || paths.iter().any(DrivenPath::has_ended);
                let just_closed = since < 2.0 * CLOSES_AFTER;
                if last_call || just_closed {
                    *pet = pet::post_encroachment_time(&mut halves, &paths[0], &paths[1], self.crossing);
                    return last_call || pet.is_some_and(|pet| pet.is_final);
                }
                return false;
            }
            true
        });
        self.closed.extend(settled.flat_map(|(_, event)| event.conflicts(roster).collect::<Vec<_>>()));
    }
}

/// Whether a run of steps has ended so long before this time that it is closed.
fn is_over(extremes: &Extremes, time: Second) -> bool {
    time - extremes.end >= CLOSES_AFTER - SAME_MOMENT
}

fn sort(conflicts: &mut [Conflict]) {
    conflicts.sort_by(|a, b| a.begin.total_cmp(&b.begin).then_with(|| (&a.ego, &a.foe).cmp(&(&b.ego, &b.foe))));
}

#[cfg(test)]
mod tests {
    use crate::events::*;
    use crate::traffic::frame::State;
    use crate::traffic::profile::Profile;
    use crate::traffic::sumo_type::SumoType;

    /// The bound of the PET in the condition of these tests.
    const PET: f64 = 2.0;

    /// Surroundings of which nothing is known.
    fn nothing() -> Surroundings<'static> {
        static SIGNALS: std::sync::LazyLock<crate::traffic::signals::Signals> =
            std::sync::LazyLock::new(Default::default);
        Surroundings { net: None, signals: &SIGNALS, course: &|_| Default::default(), added: &|_| None }
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
            Self { tracker: Tracker::new(&Options::default()), roster, users, collided: None }
        }

        fn logging(condition: &str) -> Self {
            let options = Options { log: condition.parse().unwrap(), log_encounters: true, ..Options::default() };
            Self { tracker: Tracker::new(&options), ..Self::new() }
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
                _ if kind == Kind::Side && self.tracker.needs_pet => PET,
                _ => f64::NEG_INFINITY,
            };
            let encounter = self.encounter(kind, margin, pet_below);
            let found = if present.len() == 2 { vec![encounter] } else { vec![] };
            self.tracker
                .step(&frame, &self.roster, found.iter(), |_| Vec::new(), nothing(), self.collided.as_deref())
                .to_vec()
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
        let mut found = Vec::new();
        for step in 0..=100 {
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
            found.extend_from_slice(scene.tracker.step(
                &frame,
                &scene.roster,
                seen.iter(),
                |_| Vec::new(),
                nothing(),
                None,
            ));
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
