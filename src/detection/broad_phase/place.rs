//! Places along x, in strips: what is sorted.

use crate::geometry::Bounds;
use crate::util::units::Metre;

/// Where a box begins: what is sorted, while the boxes stay in their slots.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Its lowest x.
    pub begin: Metre,
    pub strip: i32,
    pub slot: u32,
}

impl Place {
    /// Where the box of its slot is now, and in which strip.
    pub fn follow(&mut self, boxes: &[Bounds], per_metre: f64) {
        let laid = &boxes[self.slot as usize];
        let strips = (laid.low.y + laid.high.y) / 2.0 * per_metre;
        // What `floor` says, without a call where the processor has no instruction for it.
        let towards_0 = strips as i32;
        self.strip = towards_0.saturating_sub(i32::from(f64::from(towards_0) > strips));
        self.begin = laid.low.x;
    }

    pub fn is_before(&self, other: &Self) -> bool {
        (self.strip, self.begin) < (other.strip, other.begin)
    }
}

/// How many of these sorted places, which begin with that strip or a later one, are in it.
pub(super) fn length(places: &[Place], strip: i32) -> usize {
    places.partition_point(|place| place.strip <= strip)
}

/// Moves a place to where it belongs among the sorted ones before it; `false` where that takes more moves than are left:
/// then all are still there.
pub(super) fn insert(places: &mut [Place], from: usize, moves: &mut usize) -> bool {
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
