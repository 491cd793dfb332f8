//! Any bytes as a SUMO net give lanes with usable shapes or an error, never a panic.

#![no_main]

use std::path::Path;

use closecall::Net;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(net) = Net::parse(Path::new("fuzz"), bytes) else { return };
    for (number, lane) in (0..).zip(&net.lanes) {
        assert!(lane.shape.len() >= 2);
        assert!(net.lines.line(number).iter().all(|vertex| vertex.distance.is_finite()));
        assert!(net.lane_at(lane.shape[0]).is_some());
    }
});
