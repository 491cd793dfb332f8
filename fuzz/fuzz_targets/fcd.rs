//! Any bytes as an fcd-output give steps or an error, never a panic.

#![no_main]

use std::path::Path;

use closecall::internals::input::{RecordedStep, Recording};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(mut recording) = Recording::parse(Path::new("fuzz"), bytes) else { return };
    let mut step = RecordedStep::default();
    while let Ok(true) = recording.next_step(&mut step) {
        assert!(step.time.is_finite());
        assert!(step.rows().iter().all(|row| !recording.id(row.user).is_empty()));
    }
});
