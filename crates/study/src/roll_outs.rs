//! The crash probability of one pair: by the formula, and by roll-outs in SUMO, which cost a simulation each.
//!
//! A car approaches a car that stands. Whether it strikes it follows from its response time and its deceleration, so that the
//! truth is an integral over the two.

use std::fs;
use std::hint::black_box;

use super::clock::{Timed, interleaved};
use super::measurement::{Axis, Measurement, Plan, Roller};
use super::quadratures::{BRAKING, RESPONSE};
use super::reference::{nearest, probability as reference};
use closecall::braking::{LateBraking, Leader};
use closecall::detection::measures::crash_probability::crash_probability;
use closecall::detection::measures::ttb::Evasion;
use closecall::options::{DriverModel, DriverOptions, Options};
use closecall::traffic::driver_distributions::Driver;
use closecall::util::units::{Metre, MetrePerSecond, Probability, Second};
use closecall_run::{Error, Result};

const SCENE: &str = "a car that stands";
/// The name of closecall's choice.
const FORMULA: &str = "formula";
/// Roll-outs of a conflict; a quick study leaves the last out.
const COUNTS: [u32; 3] = [10, 100, 1000];
/// The speed of the car that approaches, when it departs where, and where the rear of the other is.
const SPEED: MetrePerSecond = 15.0;
const DEPARTS: Second = 20.0;
const FROM: Metre = 10.0;
const REAR: Metre = 495.0;
/// When the run ends.
const END: Second = 70.0;
/// The time in which brakes build up.
const BUILD_UP: Second = 0.1;

/// A road without junctions.
const NET: &str = r#"<net version="1.16">
<location netOffset="0,0" convBoundary="0,0,1000,0" origBoundary="0,0,1000,0" projParameter="!"/>
<edge id="ab" from="a" to="b"><lane id="ab_0" index="0" speed="20" length="1000" shape="0,-1.6 1000,-1.6"/></edge>
<junction id="a" type="dead_end" x="0" y="0" incLanes="" intLanes="" shape="0,0 0,-3.2"/>
<junction id="b" type="dead_end" x="1000" y="0" incLanes="ab_0" intLanes="" shape="1000,-3.2 1000,0"/></net>
"#;
/// The one that approaches keeps so short a headway that a conflict opens before SUMO's driver brakes.
const ROUTES: &str = r#"<routes><vType id="car" sigma="0" decel="6" maxSpeed="15" length="5"/>
<vType id="late" sigma="0" decel="9" tau="0.3" speedFactor="1" maxSpeed="15" length="5"/><route id="r" edges="ab"/>
<vehicle id="leader" type="car" route="r" depart="0" departPos="30" departSpeed="15">
<stop lane="ab_0" endPos="500" duration="100"/></vehicle>
<vehicle id="follower" type="late" route="r" depart="20" departPos="10" departSpeed="15"/></routes>
"#;
const CONFIGURATION: &str = r#"<configuration><net-file value="a.net.xml"/><route-files value="a.rou.xml"/>
<step-method.ballistic value="true"/></configuration>
"#;

pub(super) fn measure(plan: &Plan, roll_out: &mut Roller) -> Result<Vec<Measurement>> {
    let scratch = tempfile::tempdir().map_err(|source| Error::file(&std::env::temp_dir(), source))?;
    let scenario = scratch.path().join("a.sumocfg");
    for (name, text) in [("a.net.xml", NET), ("a.rou.xml", ROUTES), ("a.sumocfg", CONFIGURATION)] {
        let path = scratch.path().join(name);
        fs::write(&path, text).map_err(|source| Error::file(&path, source))?;
    }
    let counts = if plan.quick { &COUNTS[..2] } else { &COUNTS };
    let rolled = roll_out(&scenario, END, counts[counts.len() - 1])?;
    let room = REAR - FROM - SPEED * (rolled.begin - DEPARTS);
    let truth = truth(room + Options::default().contact_tolerance);
    let row = |method, parameter: String, error, ns_per_item, items| Measurement {
        axis: Axis::RollOuts,
        method,
        parameter: format!("{SCENE}{parameter}"),
        error_name: "error of the crash probability, rms",
        error,
        false_negative_rate: 0.0,
        false_positive_rate: 0.0,
        ns_per_item,
        items,
        on_pareto_front: false,
        scene: SCENE.to_owned(),
        default: method == FORMULA,
    };
    let (formula, ns) = formula(room);
    let mut rows = vec![row(FORMULA, String::new(), (formula - truth).abs(), ns, 1)];
    for count in counts {
        // Any roll-outs that follow each other are as good as the first ones: their draws go on from another start.
        let conflicts = rolled.roll_outs.chunks(*count as usize);
        let items = conflicts.len();
        let share = |runs: &[(bool, Second)]| runs.iter().filter(|run| run.0).count() as f64 / runs.len() as f64;
        let square = conflicts.map(|runs| (share(runs) - truth).powi(2)).sum::<f64>() / items as f64;
        let cpu = rolled.roll_outs.iter().map(|run| run.1).sum::<Second>() / items as f64 + rolled.before;
        rows.push(row("roll-outs", format!(", {count}"), square.sqrt(), cpu * 1e9, items));
    }
    Ok(rows)
}

/// The probability that the car needs more than this room.
fn truth(room: Metre) -> Probability {
    let response = reference::Lognormal::new(RESPONSE[0], RESPONSE[1]);
    reference::mean_over_normal(BRAKING, 256, |deceleration| {
        let stops =
            SPEED * BUILD_UP / 2.0 + SPEED * SPEED / (2.0 * deceleration) - deceleration * BUILD_UP.powi(2) / 24.0;
        let wait = (room - stops) / SPEED;
        if wait <= 0.0 { 1.0 } else { nearest(&response.above(wait)) }
    })
}

/// What closecall says, and the ns that it takes.
fn formula(room: Metre) -> (Probability, f64) {
    const AGAIN: usize = 1000;
    let options = DriverOptions::default();
    let driver = Driver::new(DriverModel::Attentive, &options, &options, 1.0);
    let leader = Leader { room, speed: 0.0, deceleration: 0.0 };
    let probability = |leader: Leader| {
        let braking = |deceleration| LateBraking { speed: SPEED, present: 0.0, build_up: BUILD_UP, deceleration };
        crash_probability(&driver, false, |deceleration| {
            Evasion::<&[(Second, Metre)]>::Behind(leader).longest_wait(&braking(deceleration))
        })
    };
    let mut timed = [Timed::new(AGAIN, || {
        for _ in 0..AGAIN {
            black_box(probability(black_box(leader)));
        }
    })];
    let times = interleaved(&mut timed, 9);
    (probability(leader), times[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_formula_is_the_integral_without_a_tolerance() {
        assert!((formula(29.0).0 - truth(29.0)).abs() < 1e-3);
        assert!((truth(29.0) - 0.393).abs() < 1e-3, "docs/whatif.md");
    }
}
