//! One frame by hand: a fast car behind a slow one, and how close that is.
//!
//!     cargo run --example frame_by_hand

use closecall::Result;
use closecall::{Detector, Frame, Options, Profile, Roster, State, SumoType};

fn main() -> Result<()> {
    let options = Options::default();
    let mut roster = Roster::default();
    let car = roster.profile(Profile::vehicle(&SumoType::car("car"), &options))?;
    let leader = roster.enter("leader", car);
    let follower = roster.enter("follower", car);

    // Front bumpers in m, heading east, speeds in m/s.
    let mut frame = Frame::default();
    frame.begin(0.0);
    frame.push(leader, State { x: 40.0, y: 0.0, z: 0.0, heading: 0.0, speed: 5.0 });
    frame.push(follower, State { x: 0.0, y: 0.0, z: 0.0, heading: 0.0, speed: 25.0 });

    let mut detector = Detector::new(&options, None);
    for encounter in detector.step(&frame, &roster) {
        println!(
            "{} behind {}: {}, gap {:.1} m, mu {:.1} m, margin {:.1} m",
            roster.id(encounter.ego),
            roster.id(encounter.foe),
            encounter.kind.name(),
            encounter.gap,
            encounter.mu,
            encounter.margin
        );
    }
    Ok(())
}
