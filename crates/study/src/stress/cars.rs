//! Cars for the whole detector and its events.

use std::sync::Arc;

use closecall::braking::Brakes;
use closecall::detection::detector::Detector;
use closecall::detection::encounter::Encounter;
use closecall::events::Conflict;
use closecall::options::Options;
use closecall::traffic::driver_distributions::Driver;
use closecall::traffic::frame::{Frame, State};
use closecall::traffic::net::Net;
use closecall::traffic::placement::Placement;
use closecall::traffic::profile::{Category, Profile};
use closecall::traffic::roster::{ProfileIndex, Roster, UserIndex};
use closecall::util::units::{Metre, MetrePerSecond, Radian, Second};
use closecall_run::RunOptions;
use closecall_run::run::Run;

/// The car of 5 m by 2 m that stress cases and tests use.
pub fn car() -> Profile {
    Profile {
        name: "car".to_owned(),
        class: "passenger".to_owned(),
        category: Category::Vehicle,
        length: 5.0,
        width: 2.0,
        chord: 5.0,
        carriages: 1,
        mass: 1500.0,
        brakes: Brakes { response: 1.0, build_up: 0.1, deceleration: 8.0 },
        driver: Driver::certain(1.0, 8.0),
        unprotected: false,
        tailgates_from: f64::INFINITY,
    }
}

/// The gap between an ego at the origin (speed, heading) and a foe (x, y, heading, speed); none if they do not meet.
pub(super) fn gap(
    (v, heading): (MetrePerSecond, Radian),
    (x, y, turn, vi): (Metre, Metre, Radian, MetrePerSecond),
) -> Option<Metre> {
    encounter(State { x: 0.0, y: 0.0, z: 0.0, heading, speed: v }, State { x, y, z: 0.0, heading: turn, speed: vi })
        .map(|found| found.gap)
}

/// The encounter of two cars, if there is one.
pub(super) fn encounter(first: State, second: State) -> Option<Encounter> {
    encounter_of(None, [first, second], &[])
}

/// The encounter of two cars on a net.
pub(super) fn encounter_on(net: Arc<Net>, placed: [(State, Placement); 2]) -> Option<Encounter> {
    let states = placed.each_ref().map(|(state, _)| *state);
    encounter_of(Some(net), states, &placed.map(|(_, placement)| placement))
}

fn encounter_of(net: Option<Arc<Net>>, states: [State; 2], placements: &[Placement]) -> Option<Encounter> {
    let mut roster = Roster::default();
    let profile = roster.profile(car()).ok()?;
    let mut frame = Frame::default();
    frame.begin(0.0);
    for (name, state) in ["a", "b"].into_iter().zip(states) {
        let user = roster.enter(name, profile);
        frame.push(user, state);
    }
    let mut detector = Detector::new(&Options::default(), net);
    let rows = detector.track_paths(&frame, &roster).to_vec();
    for (row, placement) in rows.into_iter().filter_map(|row| Some((row, placements.get(row as usize)?))) {
        detector.set_placement(&frame, &roster, row, placement);
    }
    detector.broad_phase(&frame, &roster);
    detector.narrow_phase(&frame, &roster).next().copied()
}

/// A run of cars without SUMO, step by step.
pub(super) struct CarRun {
    run: Run,
    profile: ProfileIndex,
    /// Whether every resulting value was finite.
    pub finite: bool,
}

impl CarRun {
    /// A run on a net, or without one.
    pub fn new(net: Option<Arc<Net>>) -> closecall_run::Result<Self> {
        Self::of(car(), net)
    }

    /// A run of other road users.
    pub fn of(profile: Profile, net: Option<Arc<Net>>) -> closecall_run::Result<Self> {
        let mut run = Run::new(&RunOptions::default(), net)?;
        let profile = run.roster.profile(profile)?;
        Ok(Self { run, profile, finite: true })
    }

    /// Lets a car enter.
    pub fn enter(&mut self, id: &str) -> UserIndex {
        self.run.enter(id, self.profile)
    }

    /// Lets a car leave.
    pub fn leave(&mut self, user: UserIndex) {
        self.run.leave(user);
    }

    /// Makes one step with these cars and returns the number of pairs in conflict.
    pub fn step(&mut self, time: Second, states: &[(UserIndex, State)]) -> usize {
        self.advance(time, states, None)
    }

    /// The TTC of the first pair in conflict.
    pub fn ttc(&self) -> Option<Second> {
        self.run.in_conflict().next()?.nearness?.values.ttc()
    }

    /// Makes one step with all cars placed on one lane.
    pub(crate) fn step_placed(&mut self, time: Second, states: &[(UserIndex, State)], placement: &Placement) -> usize {
        self.advance(time, states, Some(placement))
    }

    fn advance(&mut self, time: Second, states: &[(UserIndex, State)], placement: Option<&Placement>) -> usize {
        let checked = self.try_step(time, states, placement);
        self.finite &= checked.is_ok() && self.run.in_conflict().all(is_finite);
        self.run.in_conflict().len()
    }

    /// Makes one step, if it can be made.
    pub(crate) fn try_step(
        &mut self,
        time: Second,
        states: &[(UserIndex, State)],
        placement: Option<&Placement>,
    ) -> closecall_run::Result<()> {
        self.run.begin_step(time);
        for &(user, state) in states {
            self.run.frame.push(user, state);
        }
        self.run.step(|run, rows| {
            placement.into_iter().for_each(|placement| rows.iter().for_each(|row| run.set_placement(*row, placement)));
            Ok(())
        })
    }

    /// Ends the run and returns all conflicts.
    pub fn finish(mut self) -> Vec<Conflict> {
        // Only writing a log can fail, and there is none.
        let _ = self.run.finish();
        self.run.conflicts()
    }
}

fn is_finite(found: &Encounter) -> bool {
    let nearness = found
        .nearness
        .map_or(0.0, |near| near.clearance + near.values.ttc().unwrap_or(0.0) + near.values.drac().unwrap_or(0.0));
    (found.gap + found.mu + found.angle + found.ego_distance + found.foe_distance + found.x + found.y + nearness)
        .is_finite()
}
