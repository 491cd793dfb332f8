//! Indices of a type for each kind of table: a table, a [`TiVec`], takes only its own.

use typed_index_collections::TiVec;

/// Lets structs of one `u32` index the tables.
macro_rules! index_tables {
    ($($index:ident),+) => {
        $(
            impl From<usize> for $index {
                #[inline]
                fn from(place: usize) -> Self {
                    Self(place as u32)
                }
            }

            impl From<$index> for usize {
                #[inline]
                fn from(index: $index) -> Self {
                    index.0 as Self
                }
            }
        )+
    };
}
pub(crate) use index_tables;

/// Makes room for `len` rows, and an eighth more: a table that doubles when it grows is a third empty on average.
pub fn make_room<T>(table: &mut Vec<T>, len: usize) {
    if table.capacity() < len {
        table.reserve_exact(len + len / 8 - table.len());
    }
}

/// The row of an index, in a table that grows to have it.
#[inline]
pub fn row_of<I: From<usize>, T>(table: &mut TiVec<I, T>, index: I, fill: impl FnMut() -> T) -> &mut T
where
    usize: From<I>,
{
    let place = usize::from(index);
    if table.len() <= place {
        make_room(&mut table.raw, place + 1);
        table.resize_with(place + 1, fill);
    }
    &mut table.raw[place]
}
