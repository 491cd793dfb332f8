//! The tracks of a recording, one road user after the other: searched for jumps, smoothed on request, completed, and sorted by
//! time. Smoothing keeps only part of a track in memory: rows further away have no effect.

use std::io::Result;

use super::field::Field;
use super::headings::Headings;
use super::jumps::Jumps;
use super::kalman::JumpFinder;
use super::mapped_table::Table;
use super::missing_values::Completer;
use super::smooth::Smoother;
use super::spill::{Order, Row, Sorted, Sorter};
use super::users::Users;
use closecall::util::units::{Metre, Second};

/// Where ids are used again, a road user that is away for longer than this does not come back.
const AWAY: Second = 5.0;

/// Rows of a track that are smoothed together; shorter tracks as a whole.
const PART: usize = 1 << 16;
/// Rows before and after a part that are smoothed with it. With noise of 0.1 m a row matters for about 0.2 s.
const AROUND: usize = 1 << 12;

/// Takes the rows of tracks.
pub(super) struct Tracks {
    /// Whether ids are used again after a while.
    are_reused: bool,
    /// The last row's number of its road user in the file and in the recording, and its time.
    last: Option<(u32, u32, Second)>,
    /// The headings, and the name of their column.
    headings: Option<(Headings, String)>,
    jumps: Jumps,
    finder: JumpFinder,
    smoother: Option<Smoother>,
    /// The track that is read, where it is to be smoothed, and how many of its rows are of the part before.
    track: Vec<Row>,
    before: usize,
    completer: Completer,
    steps: Sorter,
}

impl Tracks {
    /// Those of these files, to be smoothed if their places have this noise.
    pub fn new(tables: &[Table], noise: Option<Metre>) -> Self {
        let headings = tables.iter().find_map(|table| {
            let unit = table.mapping.given_headings()?;
            let name = table.mapping.name(Field::Heading).to_owned();
            Some((Headings::new(unit, table.mapping.is_picture), name))
        });
        Self {
            are_reused: tables.iter().any(|table| !table.mapping.reused.is_empty()),
            last: None,
            headings,
            jumps: Jumps::default(),
            finder: JumpFinder::default(),
            smoother: noise.map(Smoother::new),
            track: Vec::new(),
            before: 0,
            completer: Completer::default(),
            steps: Sorter::new(Order::Steps),
        }
    }

    /// Takes the next row: those of a road user follow each other in the order of time.
    pub fn add(&mut self, row: Row, users: &mut Users) -> Result<()> {
        let row = Row { user: self.user_of(&row, users), ..row };
        if let Some((headings, _)) = &mut self.headings {
            headings.add(&row);
        }
        if self.smoother.is_none() {
            self.finder.next(&row).into_iter().for_each(|jump| self.jumps.add(jump));
            return self.complete(row, users);
        }
        if self.track.first().is_some_and(|first| first.user != row.user) {
            self.smooth(users, true)?;
        }
        self.track.push(row);
        if self.track.len() < self.before + PART + AROUND { Ok(()) } else { self.smooth(users, false) }
    }

    /// The number of the row's road user: a new one where the id is used again.
    fn user_of(&mut self, row: &Row, users: &mut Users) -> u32 {
        let user = match self.last {
            Some((user, known, time)) if user == row.user => {
                let is_another = self.are_reused && row.time - time > AWAY;
                if is_another { users.again_as(known) } else { known }
            }
            _ => row.user,
        };
        self.last = Some((row.user, user, row.time));
        user
    }

    /// Smooths and completes the part that was read; of a track that goes on, the rows around its end remain.
    fn smooth(&mut self, users: &mut Users, has_ended: bool) -> Result<()> {
        let mut track = std::mem::take(&mut self.track);
        let end = if has_ended { track.len() } else { track.len() - AROUND };
        let part = self.before..end;
        if !has_ended {
            self.track.extend_from_slice(&track[end - AROUND..]);
        }
        self.before = if has_ended { 0 } else { AROUND };
        if let Some(smoother) = &mut self.smoother {
            let [headings, speeds] = smoother.smooth(&mut track, part.clone(), |jump| self.jumps.add(jump));
            users.counts.headings += headings;
            users.counts.speeds += speeds;
        }
        track[part].iter().try_for_each(|row| self.complete(*row, users))
    }

    fn complete(&mut self, row: Row, users: &mut Users) -> Result<()> {
        self.completer.next(row, &mut users.counts).map_or(Ok(()), |row| self.steps.push(row))
    }

    /// All rows in the order of time.
    pub fn finish(&mut self, users: &mut Users) -> Result<Sorted> {
        self.smooth(users, true)?;
        if let Some(row) = self.completer.finish(&mut users.counts) {
            self.steps.push(row)?;
        }
        std::mem::replace(&mut self.steps, Sorter::new(Order::Steps)).sorted()
    }

    /// The heading of a row that came back.
    pub fn heading(&self, row: &Row) -> f64 {
        self.completer.heading(row)
    }

    /// What is doubtful, a line each; `id` tells the id of a road user.
    pub fn remarks<'a>(self, id: impl Fn(u32) -> &'a str) -> Vec<String> {
        let headings = self.headings.and_then(|(headings, column)| headings.remark(&column));
        headings.into_iter().chain(self.jumps.remarks(id)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_track_that_is_smoothed_in_parts_is_as_smooth_as_in_one() {
        let shake = |step: u32, by: u32| 0.2 * (f64::from(step.wrapping_mul(by) % 1009) / 504.0 - 1.0);
        let rows = (0..150_000_u32).map(|step| {
            let time = f64::from(step) / 25.0;
            let angle = time / 20.0;
            let place = [200.0 * angle.cos() + shake(step, 7919), 200.0 * angle.sin() + shake(step, 104_729)];
            let heading = (angle + std::f64::consts::FRAC_PI_2) % std::f64::consts::TAU;
            Row { user: 0, class: 0, time, values: [place[0], place[1], heading, f64::NAN, 4.5, 1.8] }
        });
        let mut whole = rows.collect::<Vec<_>>();
        let (mut users, mut tracks) = (Users::default(), Tracks::new(&[], Some(0.1)));
        for row in &whole {
            tracks.add(*row, &mut users).unwrap();
            assert!(tracks.track.len() < PART + 2 * AROUND);
        }
        let mut parts = tracks.finish(&mut users).unwrap();
        let rows = whole.len();
        let added = Smoother::new(0.1).smooth(&mut whole, 0..rows, |_| panic!("a jump"));
        assert_eq!([users.counts.headings, users.counts.speeds], added);
        for row in &whole {
            let part = parts.next().unwrap().unwrap();
            let off = [0, 1, 3].map(|of| (part.values[of] - row.values[of]).abs());
            let turned = (part.values[2] - row.values[2]) / std::f64::consts::TAU;
            assert!(off.iter().all(|off| *off < 1e-6) && (turned - turned.round()).abs() < 1e-6, "{row:?} {part:?}");
        }
        assert!(parts.next().unwrap().is_none());
    }
}
