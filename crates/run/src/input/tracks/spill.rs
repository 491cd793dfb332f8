//! Sorts more rows than memory holds: parts in temporary files, merged.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::collections::binary_heap::PeekMut;
use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Result, Seek, SeekFrom, Write};

/// Rows that are sorted in memory: 8 MB.
const PART: usize = 1 << 17;

/// A row of a table of trajectories.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    /// The number of the road user.
    pub user: u32,
    /// The number of its class.
    pub class: u32,
    /// The time, then what [`super::sorted_rows`] keeps.
    pub time: f64,
    pub values: [f64; 6],
}

const BYTES: usize = 64;

/// What rows are sorted by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Order {
    /// Road user by road user, each in time.
    Users,
    /// Step by step.
    Steps,
}

/// An order of rows whose times, of finite numbers, are compared as whole numbers.
type Key = (u64, u64);

impl Row {
    fn key(&self, order: Order) -> Key {
        let bits = self.time.to_bits();
        let time = if bits >> 63 == 1 { !bits } else { bits | 1 << 63 };
        let user = u64::from(self.user);
        if order == Order::Users { (user, time) } else { (time, user) }
    }

    fn bytes(&self) -> [u8; BYTES] {
        let mut bytes = [0; BYTES];
        bytes[..4].copy_from_slice(&self.user.to_le_bytes());
        bytes[4..8].copy_from_slice(&self.class.to_le_bytes());
        for (place, value) in (8..).step_by(8).zip(std::iter::once(self.time).chain(self.values)) {
            bytes[place..place + 8].copy_from_slice(&value.to_le_bytes());
        }
        bytes
    }

    fn of(bytes: &[u8; BYTES]) -> Self {
        let word = |place: usize| u32::from_le_bytes(std::array::from_fn(|byte| bytes[place + byte]));
        let number = |place: usize| f64::from_le_bytes(std::array::from_fn(|byte| bytes[place + byte]));
        Self { user: word(0), class: word(4), time: number(8), values: std::array::from_fn(|it| number(16 + 8 * it)) }
    }
}

/// Takes rows in any order.
pub(super) struct Sorter {
    order: Order,
    rows: Vec<Row>,
    parts: Vec<File>,
}

impl Sorter {
    pub fn new(order: Order) -> Self {
        Self { order, rows: Vec::new(), parts: Vec::new() }
    }

    pub fn push(&mut self, row: Row) -> Result<()> {
        self.rows.push(row);
        if self.rows.len() < PART { Ok(()) } else { self.spill() }
    }

    fn spill(&mut self) -> Result<()> {
        let order = self.order;
        self.rows.sort_by_key(|row| row.key(order));
        let mut file = BufWriter::new(tempfile::tempfile()?);
        self.rows.drain(..).try_for_each(|row| file.write_all(&row.bytes()))?;
        let mut file = file.into_inner().map_err(|error| error.into_error())?;
        file.seek(SeekFrom::Start(0))?;
        self.parts.push(file);
        Ok(())
    }

    /// The rows in order.
    pub fn sorted(mut self) -> Result<Sorted> {
        let order = self.order;
        self.rows.sort_by_key(|row| row.key(order));
        let parts = Parts { files: self.parts.into_iter().map(BufReader::new).collect(), rows: self.rows.into_iter() };
        let mut sorted = Sorted { order, parts, heads: BinaryHeap::new(), next: Vec::new() };
        for part in 0..=sorted.parts.files.len() {
            let next = sorted.parts.next(part)?;
            sorted.heads.extend(next.map(|row| Reverse((row.key(order), part))));
            sorted.next.push(next);
        }
        Ok(sorted)
    }
}

/// Rows in order.
pub(super) struct Sorted {
    order: Order,
    parts: Parts,
    heads: BinaryHeap<Reverse<(Key, usize)>>,
    /// By part, its next row.
    next: Vec<Option<Row>>,
}

/// Parts of the rows, each in order.
struct Parts {
    files: Vec<BufReader<File>>,
    /// Those that never left memory: the last part.
    rows: std::vec::IntoIter<Row>,
}

impl Parts {
    /// The next row of a part.
    fn next(&mut self, part: usize) -> Result<Option<Row>> {
        let Some(file) = self.files.get_mut(part) else { return Ok(self.rows.next()) };
        let mut bytes = [0; BYTES];
        match file.read_exact(&mut bytes) {
            Ok(()) => Ok(Some(Row::of(&bytes))),
            Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => Ok(None),
            Err(error) => Err(error),
        }
    }
}

impl Sorted {
    /// The next row; none at the end.
    pub fn next(&mut self) -> Result<Option<Row>> {
        let Some(mut head) = self.heads.peek_mut() else { return Ok(None) };
        let part = head.0.1;
        let next = self.parts.next(part)?;
        // Most often the next row is of the same part.
        match &next {
            Some(row) => head.0.0 = row.key(self.order),
            None => _ = PeekMut::pop(head),
        }
        Ok(std::mem::replace(&mut self.next[part], next))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_several_parts_come_in_order() {
        let row = |user: u32, time: f64| Row {
            user,
            class: 7,
            time,
            values: [time, -0.0, f64::NAN, 1e300, 0.1, user.into()],
        };
        let mut sorter = Sorter::new(Order::Steps);
        for (number, time) in [(3, 1.0), (1, -2.0), (2, 1.0), (1, 0.0), (4, -0.5)] {
            sorter.push(row(number, time)).unwrap();
            if number == 2 || number == 4 {
                sorter.spill().unwrap();
            }
        }
        sorter.push(row(9, 0.5)).unwrap();
        let mut sorted = sorter.sorted().unwrap();
        let mut found = Vec::new();
        while let Some(row) = sorted.next().unwrap() {
            assert_eq!((row.class, row.values[0], row.values[5]), (7, row.time, f64::from(row.user)));
            found.push((row.time, row.user));
        }
        assert_eq!(found, [(-2.0, 1), (-0.5, 4), (0.0, 1), (0.5, 9), (1.0, 2), (1.0, 3)]);
    }
}
