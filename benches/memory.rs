//! Memory that a run holds after the first hour and after a day of traffic that comes and goes (tests/memory.rs checks
//! that it is the same). `cargo bench --bench memory`.
//!
//! For the memory per road user beside SUMO, see benches/memory.py.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark may")]

#[path = "../tests/common/counting.rs"]
mod counting;
#[path = "../tests/common/day.rs"]
mod day;

use std::path::Path;

const HOUR: usize = 3600;

fn main() {
    let folder = tempfile::tempdir().unwrap();
    let before = counting::live_bytes();
    let mut day = day::Day::new(
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../sumo_nets/left_turn/left_turn.net.xml")),
        folder.path(),
        closecall_study::stress::car(),
    );
    println!("what,scene,method,size,value,unit");
    for hour in 1..=24 {
        (0..HOUR).for_each(|_| day.step());
        if [1, 24].contains(&hour) {
            println!("held,day,after hour {hour},{},{},bytes", day.cars(), counting::live_bytes() - before);
        }
    }
    assert!(day.conflicts() > 0, "a day without conflicts shows little");
}
