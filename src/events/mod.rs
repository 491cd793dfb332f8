//! Encounters become conflicts: one event per pair and run of steps with margin < 0.
//!
//! An event opens at the first step with margin < 0 and closes when the margin has been ≥ 0 for [`CLOSES_AFTER`] or
//! one of the two has left the scene. A side or frontal event then waits for its PET, at most [`pet::WAIT`].

mod event;
mod extremes;
mod moment;
mod past;
pub mod pet;
mod snapshot;

pub use event::Conflict;
pub use moment::Moment;

use crate::detection::encounter::Encounter;
use crate::detection::kind::{Kind, Severity};
use crate::geometry::Point;
use crate::geometry::bisection::Bisection;
use crate::traffic::frame::Frame;
use crate::traffic::profile::Category;
use crate::traffic::roster::{Roster, UserIndex};
use crate::util::units::{Radian, Second};
use extremes::{Extremes, Observation};
use past::Past;

pub use snapshot::Snapshot;

/// How long the margin must be ≥ 0 before an event closes, in s (docs/log.md).
pub const CLOSES_AFTER: Second = 1.0;
/// Simulated times are sums of steps: times that differ by less are equal, in s.
const SAME_MOMENT: Second = 1e-6;

/// The road users of an open event and its current severity, as painted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alarm {
    /// The ego of the last step in conflict.
    pub ego: UserIndex,
    /// The foe of that step.
    pub foe: UserIndex,
    /// The severity in that step.
    pub severity: Severity,
    /// The kind in that step.
    pub kind: Kind,
    /// The ego's front at the conflict point of that step, or that of its carriage that touches.
    pub at: Point,
}

/// Follows the pairs in conflict over the steps.
#[derive(Debug)]
pub struct Tracker {
    /// Paths that meet at a smaller angle do not cross.
    crossing: Radian,
    past: Past,
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
    alarm: Alarm,
    extremes: Extremes,
    driven: Option<Box<PetTracker>>,
}

/// The paths that the two of a side or frontal event have driven, from some seconds before it became one, in their order,
/// and the PET so far.
#[derive(Debug)]
struct PetTracker {
    paths: [pet::DrivenPath; 2],
    pet: Option<pet::Pet>,
}

impl Event {
    fn conflict(&self, roster: &Roster) -> Conflict {
        Conflict::of(&self.extremes, self.driven.as_ref().and_then(|driven| driven.pet), roster)
    }
}

impl Tracker {
    /// A tracker for which two paths cross from this angle on.
    pub fn new(crossing: Radian) -> Self {
        Self { crossing, past: Past::default(), events: Vec::new(), waiting: Vec::new(), closed: Vec::new() }
    }

    /// Takes the encounters of one step and returns the conflicts that it settles, in the order of their begin and ids.
    /// `path` returns the path of a row's front bumper, from where it is; `collided` are the pairs of ids of which SUMO
    /// reports a collision, if that is known.
    pub fn step<'a>(
        &mut self,
        frame: &Frame,
        roster: &Roster,
        encounters: impl Iterator<Item = &'a Encounter> + Clone,
        path: impl Fn(u32) -> Vec<Point>,
        collided: Option<&[[String; 2]]>,
    ) -> &[Conflict] {
        self.forget_closed();
        if !self.events.is_empty() || !self.waiting.is_empty() || encounters.clone().any(Encounter::in_conflict) {
            for found in encounters.filter(|found| found.in_conflict()) {
                self.take(&Observation { frame, roster, found }, &path);
            }
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

    /// The open events, in no particular order.
    pub fn alarms(&self) -> impl Iterator<Item = Alarm> {
        self.events.iter().map(|(_, event)| event.alarm)
    }

    /// The conflicts that are open or wait for their PET, as they are now, in the order of their begin and ids.
    pub fn open(&self, roster: &Roster) -> Vec<Conflict> {
        let events = self.events.iter().chain(&self.waiting);
        let mut open = events.map(|(_, event)| event.conflict(roster)).collect::<Vec<_>>();
        sort(&mut open);
        open
    }

    fn take(&mut self, seen: &Observation, path: &impl Fn(u32) -> Vec<Point>) {
        let Encounter { ego, foe, kind, x, y, .. } = *seen.found;
        let alarm = Alarm { ego, foe, severity: seen.severity(), kind, at: Point::new(x, y) };
        let pair = [ego.min(foe), ego.max(foe)];
        let place = match self.events.binary_search_by_key(&pair, |(known, _)| *known) {
            Ok(place) => {
                let (_, event) = &mut self.events[place];
                event.alarm = alarm;
                event.extremes.take(seen, path);
                place
            }
            Err(place) => {
                let event = Event { alarm, extremes: Extremes::of(seen, path), driven: None };
                self.events.insert(place, (pair, Box::new(event)));
                place
            }
        };
        let (_, event) = &mut self.events[place];
        if kind != Kind::RearEnd && event.driven.is_none() {
            let paths = pair.map(|user| {
                let profile = seen.roster.profile_of(user);
                let mut path = pet::DrivenPath::new(profile.length, profile.width);
                if profile.category != Category::Obstacle {
                    self.past
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
            let known = &mut event.extremes.collision_sumo;
            *known = Some(is_reported || *known == Some(true));
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
        let over = self.events.extract_if(.., |(pair, event)| {
            let is_gone = |user: &UserIndex| frame.row_of(*user).is_none();
            frame.time - event.extremes.end >= CLOSES_AFTER - SAME_MOMENT || pair.iter().any(is_gone)
        });
        self.waiting.extend(over);
    }

    /// Passes on the closed events whose PET is known, or will not be.
    fn settle(&mut self, time: Second, at_once: bool, roster: &Roster) {
        // One for the step, not kept: a long wait in small steps would otherwise hold its memory for the rest of the run.
        let mut halves = Bisection::default();
        let settled = self.waiting.extract_if(.., |(_, event)| {
            let since = time - event.extremes.end;
            if let (Some(driven), true) = (&mut event.driven, event.extremes.worst.kind != Kind::RearEnd) {
                let PetTracker { paths, pet } = &mut **driven;
                let last_call = at_once
                    || since >= CLOSES_AFTER + pet::WAIT - SAME_MOMENT
                    || paths.iter().any(pet::DrivenPath::has_ended);
                let just_closed = since < 2.0 * CLOSES_AFTER;
                if last_call || just_closed {
                    *pet = pet::post_encroachment_time(&mut halves, &paths[0], &paths[1], self.crossing);
                    return last_call || pet.is_some_and(|pet| pet.is_final);
                }
                return false;
            }
            true
        });
        self.closed.extend(settled.map(|(_, event)| event.conflict(roster)));
    }
}

fn sort(conflicts: &mut [Conflict]) {
    conflicts.sort_by(|a, b| a.begin.total_cmp(&b.begin).then_with(|| (&a.ego, &a.foe).cmp(&(&b.ego, &b.foe))));
}

#[cfg(test)]
mod tests {
    use crate::events::*;
    use crate::options::Options;
    use crate::traffic::frame::State;
    use crate::traffic::profile::Profile;
    use crate::traffic::sumo_type::SumoType;

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
            Self {
                tracker: Tracker::new(Options::default().kind_bounds().rear_end_below),
                roster,
                users,
                collided: None,
            }
        }

        /// A step in which both are there and their margin is this (rear-end).
        fn step(&mut self, time: f64, margin: f64) -> Vec<Conflict> {
            self.step_with(time, &[(0, 0.0), (1, 20.0)], margin, Kind::RearEnd)
        }

        fn step_with(&mut self, time: f64, present: &[(usize, f64)], margin: f64, kind: Kind) -> Vec<Conflict> {
            let mut frame = Frame::default();
            frame.begin(time);
            for &(user, x) in present {
                frame.push(self.users[user], State { x, y: 0.0, z: 0.0, heading: 0.0, speed: 10.0 });
            }
            let encounter = Encounter {
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
            };
            let found = if present.len() == 2 { vec![encounter] } else { vec![] };
            self.tracker.step(&frame, &self.roster, found.iter(), |_| Vec::new(), self.collided.as_deref()).to_vec()
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
}
