//! A source of road users of your own: two cars that cross, step by step, until their conflict closes.
//!
//!     cargo run --example own_source

use closecall::{Options, Profile, State, SumoType};
use closecall_run::{Result, Run};

/// Length of a step in s.
const STEP: f64 = 0.1;
/// Speed of both cars in m/s.
const SPEED: f64 = 12.0;

fn main() -> Result<()> {
    let options = Options::default();
    let mut run = Run::new(&options.clone().into(), None)?;
    let car = run.roster.profile(Profile::vehicle(&SumoType::car("car"), &options))?;
    let eastbound = run.enter("eastbound", car);
    let northbound = run.enter("northbound", car);
    for step in 0..100 {
        let time = f64::from(step) * STEP;
        let driven = SPEED * time;
        run.begin_step(time);
        run.frame.push(eastbound, State { x: driven - 60.0, y: 0.0, z: 0.0, heading: 0.0, speed: SPEED });
        let north = std::f64::consts::FRAC_PI_2;
        run.frame.push(northbound, State { x: 0.0, y: driven - 50.0, z: 0.0, heading: north, speed: SPEED });
        // Without a net, no placement has to be set.
        run.step(|_, _| Ok::<(), closecall_run::Error>(()))?;
    }
    run.finish()?;
    for conflict in run.conflicts() {
        println!(
            "{} and {}: {}, margin {:.1} m at {:.1} s, PET {:.2} s",
            conflict.ego,
            conflict.foe,
            conflict.kind.name(),
            conflict.margin,
            conflict.time,
            conflict.pet.unwrap_or(f64::NAN)
        );
    }
    Ok(())
}
