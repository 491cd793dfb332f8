//! The entry point `demand` of tests/common/entry_points.rs.

#![no_main]

#[path = "../../tests/common/entry_points.rs"]
mod entry_points;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| entry_points::demand_files(bytes));
