//! Any bytes as a SUMO net: lanes that can be driven along, or an error, never a panic.

#![no_main]

use std::path::Path;

use closecall::net::Net;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(net) = Net::parse(Path::new("fuzz"), bytes) else { return };
    for lane in &net.lanes {
        assert!(lane.shape.len() >= 2 && lane.shape.len() == lane.ways.len());
        assert!(lane.ways.iter().all(|way| way.is_finite()));
        assert!(net.lane_at(lane.shape[0]).is_some());
    }
});
