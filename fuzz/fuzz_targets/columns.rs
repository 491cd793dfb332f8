//! The door `columns` of tests/common/doors.rs.

#![no_main]

#[path = "../../tests/common/doors.rs"]
mod doors;

// A panic of the Parquet library, which closecall catches, does not end the fuzzer; one that gets out does.
libfuzzer_sys::fuzz_target!(init: drop(std::panic::take_hook()), |bytes: &[u8]| doors::columns(bytes));
