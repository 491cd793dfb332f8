//! One driver that errs: the commands for its vehicle in each step.

use super::super::Run;
use super::course::Course;
use super::outcome::DrawnError;
use super::plan::{DriverError, ErringDriver};
use closecall::detection::measures::accident::BRAKES;
use closecall::traffic::frame::Row;
use closecall::traffic::roster::UserIndex;
use closecall::util::units::{MetrePerSecond, SAME_MOMENT, Second};

/// A command for a vehicle: a function of TraCI's domain `vehicle` with its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// `setSpeedMode`: which checks of its own SUMO makes.
    SpeedMode(i32),
    /// `setLaneChangeMode`: which lane changes SUMO makes.
    LaneChangeMode(i32),
    /// `setSpeed`: the speed of the next step in m/s; below 0, SUMO's own.
    Speed(MetrePerSecond),
}

/// SUMO's modes: nothing is checked, no lane is changed; as SUMO has them; no right of way; no red light
/// (sumo.dlr.de/docs/TraCI/Change_Vehicle_State.html).
const UNCHECKED: i32 = 0;
const SUMOS_OWN: [Command; 3] =
    [Command::SpeedMode(31), Command::LaneChangeMode(0b0110_0101_0101), Command::Speed(-1.0)];
const NO_RIGHT_OF_WAY: i32 = 55;
const NO_RED_LIGHT: i32 = 7;

/// A driver that errs.
#[derive(Debug)]
pub(super) struct Steered {
    asked: ErringDriver,
    phase: Phase,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    /// It was not seen yet.
    Absent,
    /// It need not respond yet.
    Before,
    /// It goes on as it was, then brakes.
    Errs(Course),
    /// SUMO drives again.
    Over,
}

impl Steered {
    pub fn new(asked: ErringDriver) -> Self {
        Self { asked, phase: Phase::Absent }
    }

    /// The driver's id.
    pub fn id(&self) -> &str {
        &self.asked.id
    }

    /// The commands after a step; notes in `drawn` when the driver erred and how.
    pub fn step(&mut self, run: &Run, step: Second, is_ballistic: bool, drawn: &mut DrawnError) -> Vec<Command> {
        let mut commands = Vec::new();
        let Some(Row { user, state }) = run.frame.rows().find(|row| *run.roster.id(row.user) == self.asked.id) else {
            return commands;
        };
        let time = run.frame.time;
        if self.phase == Phase::Absent {
            self.phase = Phase::Before;
            match self.asked.error {
                DriverError::Late => {}
                DriverError::Gap => commands.push(Command::SpeedMode(NO_RIGHT_OF_WAY)),
                DriverError::Signal => commands.push(Command::SpeedMode(NO_RED_LIGHT)),
            }
        }
        let is_open = self.is_in_conflict(run, user);
        let has_to_respond = self.asked.from.map_or(is_open, |from| time > from - SAME_MOMENT);
        if self.phase == Phase::Before && has_to_respond {
            let profile = run.roster.profile_of(user);
            let slowed = run.deceleration(user);
            let course = Course {
                speed: state.speed,
                present: if slowed >= BRAKES { slowed } else { 0.0 },
                responds_at: time + profile.driver.response_within(self.asked.response),
                deceleration: profile.driver.deceleration_of(self.asked.deceleration),
                build_up: profile.driver.build_up().unwrap_or(profile.brakes.build_up),
            };
            let response = course.responds_at - time;
            let (id, deceleration) = (self.asked.id.clone(), course.deceleration);
            *drawn = DrawnError { id, from: Some(time), response, deceleration };
            self.phase = Phase::Errs(course);
            commands.extend([Command::SpeedMode(UNCHECKED), Command::LaneChangeMode(UNCHECKED)]);
        }
        if let Phase::Errs(course) = &mut self.phase {
            if time > course.responds_at && !is_open {
                self.phase = Phase::Over;
                commands.extend(SUMOS_OWN);
            } else {
                let distance = course.advance(time, step);
                commands.push(Command::Speed(if is_ballistic { course.speed } else { distance / step }));
            }
        }
        commands
    }

    /// Whether the conflict with the foe is open.
    fn is_in_conflict(&self, run: &Run, user: UserIndex) -> bool {
        let other = |alarm: &closecall::Alarm| match user {
            user if alarm.ego == user => Some(alarm.foe),
            user if alarm.foe == user => Some(alarm.ego),
            _ => None,
        };
        run.alarms().any(|alarm| other(&alarm).is_some_and(|other| *run.roster.id(other) == self.asked.foe))
    }
}
