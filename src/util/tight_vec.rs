//! Tables that hold little more memory than they need: [`Vec`] doubles when it is full, which leaves up to half of it
//! empty.

/// Makes room for further rows: where there is none, for a thirty-second more than that.
pub fn make_room<T>(table: &mut Vec<T>, further: usize) {
    if table.capacity() - table.len() < further {
        table.reserve_exact(further + (table.len() + further) / 32);
    }
}

/// Adds a row.
#[inline]
pub(crate) fn add<T>(table: &mut Vec<T>, row: T) {
    make_room(table, 1);
    table.push(row);
}

/// Gives a table so many rows, new ones with this value.
pub(crate) fn fill<T: Clone>(table: &mut Vec<T>, rows: usize, value: T) {
    make_room(table, rows.saturating_sub(table.len()));
    table.resize(rows, value);
}
