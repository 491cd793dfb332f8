//! The entry point `columns` of tests/common/entry_points.rs.

#![no_main]

#[path = "../../tests/common/entry_points.rs"]
mod entry_points;

// A panic of the Parquet library, which closecall catches, does not end the fuzzer; one that gets out does.
libfuzzer_sys::fuzz_target!(init: drop(std::panic::take_hook()), |bytes: &[u8]| entry_points::columns(bytes));
