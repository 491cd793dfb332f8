//! Memory follows the road users in the scene, not how long a run lasts: counted by the allocator itself.

#![allow(clippy::unwrap_used, reason = "a test may")]

#[path = "common/counting.rs"]
mod counting;
#[path = "common/day.rs"]
mod day;

use std::path::Path;

const HOUR: usize = 3600;

#[test]
fn a_day_takes_no_more_memory_than_an_hour() {
    let folder = tempfile::tempdir().unwrap();
    let mut day = day::Day::new(
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../sumo_nets/left_turn/left_turn.net.xml")),
        folder.path(),
        closecall_study::stress::car(),
    );
    (0..HOUR).for_each(|_| day.step());
    let (live, conflicts) = (counting::live_bytes(), day.conflicts());
    (HOUR..24 * HOUR).for_each(|_| day.step());
    assert!(conflicts > 500, "{conflicts}");
    assert_eq!(counting::live_bytes(), live);
}
