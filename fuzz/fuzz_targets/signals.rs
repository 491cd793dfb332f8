//! The door `signals` of tests/common/doors.rs.

#![no_main]

#[path = "../../tests/common/doors.rs"]
mod doors;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| doors::signals(bytes));
