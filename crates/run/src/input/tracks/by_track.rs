//! The tracks of a recording, one road user after the other: searched for jumps, smoothed if that is wanted, completed, and put in
//! the order of time. Only smoothing needs a whole track in memory.

use std::io::Result;

use super::complete::Completer;
use super::field::Field;
use super::filter::JumpFinder;
use super::headings::Headings;
use super::jumps::Jumps;
use super::mapped_table::Table;
use super::smooth::Smoother;
use super::spill::{Order, Row, Sorted, Sorter};
use super::users::Users;
use closecall::util::units::{Metre, Second};

/// Where ids are used again, a road user that is away for longer than this does not come back.
const AWAY: Second = 5.0;

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
    /// The track that is read, where it is to be smoothed.
    track: Vec<Row>,
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
            self.smooth(users)?;
        }
        self.track.push(row);
        Ok(())
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

    fn smooth(&mut self, users: &mut Users) -> Result<()> {
        let mut track = std::mem::take(&mut self.track);
        if let Some(smoother) = &mut self.smoother {
            let [headings, speeds] = smoother.smooth(&mut track, |jump| self.jumps.add(jump));
            users.counts.headings += headings;
            users.counts.speeds += speeds;
        }
        track.iter().try_for_each(|row| self.complete(*row, users))?;
        track.clear();
        self.track = track;
        Ok(())
    }

    fn complete(&mut self, row: Row, users: &mut Users) -> Result<()> {
        self.completer.next(row, &mut users.counts).map_or(Ok(()), |row| self.steps.push(row))
    }

    /// All rows in the order of time.
    pub fn finish(&mut self, users: &mut Users) -> Result<Sorted> {
        self.smooth(users)?;
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
