//! Entries of the sorted order: by strip, then by x.

use crate::geometry::Bounds;
use crate::util::units::Metre;

/// Where a box begins. Entries are sorted while the boxes stay in their slots.
#[derive(Clone, Copy, Debug)]
pub(super) struct StripEntry {
    /// Its lowest x.
    pub begin: Metre,
    pub strip: i32,
    pub slot: u32,
}

impl StripEntry {
    /// Updates it to where its box is now.
    pub fn follow(&mut self, boxes: &[Bounds], per_metre: f64) {
        let laid = &boxes[self.slot as usize];
        let strips = (laid.low.y + laid.high.y) / 2.0 * per_metre;
        // Floor by a cast: `floor` is a library call where the target has no instruction for it.
        let towards_0 = strips as i32;
        self.strip = towards_0.saturating_sub(i32::from(f64::from(towards_0) > strips));
        self.begin = laid.low.x;
    }

    pub(crate) fn is_before(&self, other: &Self) -> bool {
        (self.strip, self.begin) < (other.strip, other.begin)
    }
}

/// The number of these sorted entries that are in `strip`; none is in an earlier one.
pub(super) fn length(places: &[StripEntry], strip: i32) -> usize {
    places.partition_point(|place| place.strip <= strip)
}

/// Moves an entry to where it belongs among the sorted ones before it. Returns `false` where that takes more moves than
/// are left; all entries are still there then.
pub(super) fn insert(places: &mut [StripEntry], from: usize, moves: &mut usize) -> bool {
    if !places[from].is_before(&places[from - 1]) {
        return true;
    }
    let (place, mut to) = (places[from], from);
    while to > 0 && place.is_before(&places[to - 1]) && *moves > 0 {
        *moves -= 1;
        places[to] = places[to - 1];
        to -= 1;
    }
    places[to] = place;
    to == 0 || !place.is_before(&places[to - 1])
}
