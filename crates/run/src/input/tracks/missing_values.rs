//! Headings and speeds that rows lack, from how each road user moved: row by row, so that no track is kept in memory.

use super::spill::Row;
use super::users::Counts;
use closecall::geometry::Point;
use closecall::util::units::{Metre, Second};

/// A road user that moves less than this between the steps before and after keeps its heading, in m: noise would turn it.
const MOVED: Metre = 0.2;

/// Completes tracks, one after the other, each in the order of time.
#[derive(Default)]
pub(super) struct Completer {
    before: Option<(Second, Point)>,
    /// The row that waits for the one after it.
    waiting: Option<Row>,
    heading: f64,
    /// By road user: the first known heading. While standing at first, a road user heads where it goes later.
    first: Vec<f64>,
}

impl Completer {
    /// Takes the next row; returns the one before it. One that stood from its first row on has no heading yet: see
    /// [`Completer::heading`].
    pub fn next(&mut self, row: Row, counts: &mut Counts) -> Option<Row> {
        let last = self.waiting.replace(row)?;
        let completed = self.complete(last, Some(row).filter(|row| row.user == last.user), counts);
        self.before = (row.user == last.user).then(|| place(&last));
        Some(completed)
    }

    /// The last row.
    pub fn finish(&mut self, counts: &mut Counts) -> Option<Row> {
        let last = self.waiting.take()?;
        Some(self.complete(last, None, counts))
    }

    fn complete(&mut self, mut row: Row, next: Option<Row>, counts: &mut Counts) -> Row {
        let here = place(&row);
        let (from, to) = (self.before.unwrap_or(here), next.as_ref().map_or(here, place));
        let (lasted, displacement) = (to.0 - from.0, to.1 - from.1);
        if self.before.is_none() {
            self.heading = f64::NAN;
        }
        let values = &mut row.values;
        if values[2].is_nan() {
            counts.headings += 1;
            values[2] = if displacement.norm() >= MOVED { displacement.y.atan2(displacement.x) } else { self.heading };
        }
        if values[3].is_nan() {
            counts.speeds += 1;
            values[3] = if lasted > 0.0 { displacement.norm() / lasted } else { 0.0 };
        }
        if self.heading.is_nan() && !values[2].is_nan() {
            let user = row.user as usize;
            if self.first.len() <= user {
                self.first.resize(user + 1, f64::NAN);
            }
            if self.first[user].is_nan() {
                self.first[user] = values[2];
            }
        }
        self.heading = values[2];
        row
    }

    /// The heading of a completed row. Without movement, it is +x.
    pub fn heading(&self, row: &Row) -> f64 {
        let first = || self.first.get(row.user as usize).copied().filter(|heading| !heading.is_nan()).unwrap_or(0.0);
        if row.values[2].is_nan() { first() } else { row.values[2] }
    }
}

fn place(row: &Row) -> (Second, Point) {
    (row.time, Point::new(row.values[0], row.values[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The headings in degrees and the speeds that follow from places of road users along x or y, a second apart.
    fn completed(tracks: &[&[[f64; 2]]]) -> Vec<(f64, f64)> {
        let mut completer = Completer::default();
        let mut counts = Counts::default();
        let mut rows = Vec::new();
        for (user, track) in (0..).zip(tracks) {
            for (second, [x, y]) in (0..).zip(*track) {
                let values = [*x, *y, f64::NAN, f64::NAN, 0.0, 0.0];
                rows.extend(completer.next(Row { user, class: 0, time: second.into(), values }, &mut counts));
            }
        }
        rows.extend(completer.finish(&mut counts));
        assert_eq!(counts.headings, rows.len() as u64);
        rows.iter().map(|row| (completer.heading(row).to_degrees(), row.values[3])).collect()
    }

    #[test]
    fn one_that_stands_at_first_heads_where_it_goes() {
        let stands_then_goes: &[[f64; 2]] = &[[0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 4.0], [0.0, 4.0]];
        let stands: &[[f64; 2]] = &[[1.0, 1.0], [1.0, 1.0]];
        let goes: &[[f64; 2]] = &[[0.0, 0.0], [-3.0, 0.0]];
        let found = completed(&[stands_then_goes, stands, goes, &[[9.0, 9.0]]]);
        assert_eq!(found[..5], [(90.0, 0.0), (90.0, 0.0), (90.0, 2.0), (90.0, 2.0), (90.0, 0.0)]);
        assert_eq!(found[5..], [(0.0, 0.0), (0.0, 0.0), (180.0, 3.0), (180.0, 3.0), (0.0, 0.0)]);
    }
}
