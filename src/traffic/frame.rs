//! The road users of one step, a row each.
//!
//! A `Roster` holds what does not change while a road user is in the scene (id, type, size, brakes); a [`Frame`]
//! holds what changes in every step. Both are filled by the source of the data (the bridge from libsumo, replay
//! from a file, a caller from arrays) and only read by the detector.

use typed_index_collections::TiVec;

use super::roster::UserIndex;
use crate::geometry::Point;
use crate::util::index::{make_room, row_of};
use crate::util::limits::{ANGLE, HEIGHT, POSITION, SPEED};
use crate::util::units::{Metre, MetrePerSecond, Radian, Second};

/// SUMO's own value for "no position" (`tcpip::INVALID_DOUBLE_VALUE`).
pub const SUMO_INVALID: f64 = -1_073_741_824.0;

/// Whether a value is [`SUMO_INVALID`], to the digits that a recording has.
pub fn is_nowhere(value: f64) -> bool {
    (value - SUMO_INVALID).abs() < 1.0
}

/// A road user's changing part, as it goes into a [`Frame`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Front-bumper centre (SUMO's reference point), x in m; an obstacle's is not used.
    pub x: Metre,
    /// Front-bumper centre, y in m.
    pub y: Metre,
    /// Height in m.
    pub z: Metre,
    /// Direction from the rear to the front bumper, in rad counter-clockwise from +x.
    pub heading: Radian,
    /// Speed in m/s, 0 or more.
    pub speed: MetrePerSecond,
}

impl State {
    /// Placeholder for a road user that is absent in this step.
    pub const NOWHERE: Self = Self { x: f64::NAN, y: f64::NAN, z: f64::NAN, heading: f64::NAN, speed: f64::NAN };

    /// The front bumper's centre.
    pub fn front(&self) -> Point {
        Point::new(self.x, self.y)
    }

    /// Whether it moves at all. SUMO's own threshold for halting would be too coarse.
    pub fn moves(&self) -> bool {
        self.speed > 0.0
    }

    /// Checks that the values are possible.
    ///
    /// # Errors
    /// A message that says which is not, and what it must be.
    pub fn check(&self) -> Result<(), String> {
        for (name, value, limit) in [
            ("x", self.x, &POSITION),
            ("y", self.y, &POSITION),
            ("z", self.z, &HEIGHT),
            ("heading", self.heading, &ANGLE),
            ("speed", self.speed, &SPEED),
        ] {
            limit.check(name, value)?;
        }
        Ok(())
    }

    #[inline]
    fn is_plausible(&self) -> bool {
        let Self { x, y, z, heading, speed } = *self;
        POSITION.holds(x) & POSITION.holds(y) & HEIGHT.holds(z) & ANGLE.holds(heading) & SPEED.holds(speed)
    }

    /// Whether it says that the road user is absent: a value that is SUMO's invalid one, or none, or a speed below 0.
    fn is_absent(&self) -> bool {
        let Self { x, y, z, heading, speed } = *self;
        !(x + y + z + heading + speed).is_finite() || is_nowhere(x) || is_nowhere(y) || speed < 0.0
    }
}

/// A road user in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// The road user.
    pub user: UserIndex,
    /// Its state.
    pub state: State,
}

/// The road users of one step.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    /// Simulated time in s.
    pub time: Second,
    /// By row.
    users: Vec<UserIndex>,
    /// By row.
    states: Vec<State>,
    /// By row, the states as their source has them, if these are not those.
    reported: Vec<State>,
    /// How long before `time` road users are where their states say, in s.
    behind: Second,
    /// By [`UserIndex`], the row.
    rows: TiVec<UserIndex, u32>,
    /// The first road user with an impossible state, and why.
    impossible: Option<(UserIndex, String)>,
}

/// No row.
const ABSENT: u32 = u32::MAX;

impl Frame {
    /// Empties the frame for the step at `time`; its memory is kept.
    pub fn begin(&mut self, time: Second) {
        self.time = time;
        for user in self.users.drain(..) {
            self.rows[user] = ABSENT;
        }
        self.states.clear();
        self.reported.clear();
        self.behind = 0.0;
        self.impossible = None;
    }

    /// The first road user whose state no road user can have, and why; its step cannot be checked.
    pub fn impossible(&self) -> Option<&(UserIndex, String)> {
        self.impossible.as_ref()
    }

    #[cold]
    fn leave_out(&mut self, user: UserIndex, state: &State) {
        if let (None, false, Err(why)) = (&self.impossible, state.is_absent(), state.check()) {
            self.impossible = Some((user, why));
        }
    }

    /// Adds a road user's row. Without a valid position (SUMO's invalid value, NaN and infinities are not) or a valid
    /// speed it is absent in this step: the row is left out, and `false` returned. So is one with values that no road user
    /// can have; `Run::step` then fails.
    pub fn push(&mut self, user: UserIndex, state: State) -> bool {
        let valid = state.is_plausible();
        if valid {
            self.users.push(user);
            self.states.push(state);
            self.number(self.len() - 1);
        } else {
            self.leave_out(user, &state);
        }
        valid
    }

    /// Adds a row for each of these road users. `fill` gets all their states, each [`State::NOWHERE`], and may set them in
    /// any order. Rows that are then still invalid, as in [`Frame::push`], are left out.
    ///
    /// # Errors
    /// That of `fill`; no row is added then.
    pub fn extend<E>(
        &mut self,
        users: impl ExactSizeIterator<Item = UserIndex>,
        fill: impl FnOnce(&mut [State]) -> std::result::Result<(), E>,
    ) -> std::result::Result<(), E> {
        let first = self.len();
        make_room(&mut self.states, first + users.len());
        make_room(&mut self.users, first + users.len());
        self.states.resize(first + users.len(), State::NOWHERE);
        self.users.extend(users);
        let filled = fill(&mut self.states[first..]);
        let mut end = first;
        if filled.is_ok() {
            for row in first..self.len() {
                let state = self.states[row];
                if state.is_plausible() {
                    self.states.swap(end, row);
                    self.users.swap(end, row);
                    end += 1;
                } else {
                    self.leave_out(self.users[row], &state);
                }
            }
        }
        self.states.truncate(end);
        self.users.truncate(end);
        self.number(first);
        filled
    }

    /// Records the rows of the road users from this row on.
    fn number(&mut self, first: usize) {
        for (row, user) in (first as u32..).zip(&self.users[first..]) {
            *row_of(&mut self.rows, *user, || ABSENT) = row;
        }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.users.len()
    }

    /// Whether the step has no road users.
    pub fn is_empty(&self) -> bool {
        self.users.is_empty()
    }

    /// All rows, in the order in which they were added.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = Row> + Clone {
        self.users.iter().zip(&self.states).map(|(user, state)| Row { user: *user, state: *state })
    }

    /// A row.
    pub fn row(&self, row: u32) -> Row {
        Row { user: self.user(row), state: *self.state(row) }
    }

    /// The road user of a row.
    pub fn user(&self, row: u32) -> UserIndex {
        self.users[row as usize]
    }

    /// The state of a row.
    pub fn state(&self, row: u32) -> &State {
        &self.states[row as usize]
    }

    /// A row's state, to change it.
    pub(crate) fn state_mut(&mut self, row: u32) -> &mut State {
        &mut self.states[row as usize]
    }

    /// Keeps the states as they are now as those that were reported, before they are changed to those of `behind` s earlier.
    pub(crate) fn begin_to_move_back(&mut self, behind: Second) {
        self.reported.clear();
        make_room(&mut self.reported, self.states.len());
        self.reported.extend_from_slice(&self.states);
        self.behind = behind;
    }

    /// How long before [`Frame::time`] road users are where their states say, in s.
    pub(crate) fn behind(&self) -> Second {
        self.behind
    }

    /// The state of a row as its source has it, at [`Frame::time`].
    pub(crate) fn reported(&self, row: u32) -> &State {
        self.reported.get(row as usize).unwrap_or_else(|| self.state(row))
    }

    /// The row of a road user, the last one if it has several; none where it is absent in this step.
    pub fn row_of(&self, user: UserIndex) -> Option<u32> {
        self.rows.get(user).copied().filter(|row| *row != ABSENT)
    }
}

#[cfg(test)]
mod tests {
    use crate::traffic::frame::*;

    const HERE: State = State { x: 1.0, y: 2.0, z: 0.0, heading: 0.5, speed: 3.0 };

    fn row(user: u32) -> Row {
        Row { user: UserIndex(user), state: HERE }
    }

    #[test]
    fn rows_filled_in_any_order_skip_absent_road_users() {
        let mut frame = Frame::default();
        frame.push(UserIndex(7), HERE);
        let fill = |states: &mut [State]| {
            states[3] = HERE;
            states[0] = State { speed: -1.0, ..HERE };
            states[1] = HERE;
            Ok::<(), ()>(())
        };
        assert_eq!(frame.extend((0..4).map(UserIndex), fill), Ok(()));
        assert!(frame.rows().eq([7, 1, 3].map(row)));
        assert_eq!(
            [0, 1, 2, 3, 7, 9].map(|user| frame.row_of(UserIndex(user))),
            [None, Some(1), None, Some(2), Some(0), None]
        );
        frame.begin(1.0);
        assert_eq!([1, 7].map(|user| frame.row_of(UserIndex(user))), [None; 2]);
    }

    #[test]
    fn no_row_is_added_where_filling_fails() {
        let mut frame = Frame::default();
        frame.push(UserIndex(7), HERE);
        let fill = |states: &mut [State]| {
            states[0] = HERE;
            Err("gone")
        };
        assert_eq!(frame.extend((0..2).map(UserIndex), fill), Err("gone"));
        assert!(frame.rows().eq([row(7)]));
    }
}
