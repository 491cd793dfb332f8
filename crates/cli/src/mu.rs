//! `closecall mu`: the minimal collision distance of two road users under each model.

use clap::{Args, ValueEnum};

use super::print::print;
use closecall::braking::{Brakes, Braking, MuModel, mu, stopping_distance};
use closecall::detection::kind::Kind;
use closecall::options::{BUILD_UP, EPSILON, RESPONSE};
use closecall::options::{angle, deceleration, duration, reserve, speed};
use closecall::traffic::sumo_type::SumoType;
use closecall::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Radian, Second};
use closecall_run::Result;
use closecall_run::util::decimal::Written;

/// Two braking road users.
#[derive(Args)]
pub(crate) struct MuArgs {
    /// Speed of the ego, in m/s.
    #[arg(long, value_name = "V", value_parser = speed)]
    speed: MetrePerSecond,
    /// Speed of the foe, in m/s.
    #[arg(long, value_name = "V", value_parser = speed)]
    foe_speed: MetrePerSecond,
    /// Deceleration of the ego, in m/s². The default is SUMO's emergencyDecel of a car.
    #[arg(long, value_name = "A", default_value_t = SumoType::car("").emergency_decel, value_parser = deceleration)]
    decel: MetrePerSecondSquared,
    /// Deceleration of the foe, in m/s².
    #[arg(long, value_name = "A", default_value_t = SumoType::car("").emergency_decel, value_parser = deceleration)]
    foe_decel: MetrePerSecondSquared,
    /// Response time t1 + t2 of both, in s.
    #[arg(long, value_name = "T", default_value_t = RESPONSE, value_parser = duration)]
    response_time: Second,
    /// Time t3 in which the deceleration of both builds up, in s.
    #[arg(long, value_name = "T3", default_value_t = BUILD_UP, value_parser = duration)]
    build_up: Second,
    /// Redundancy ε, in m.
    #[arg(long, value_name = "E", default_value_t = EPSILON, value_parser = reserve)]
    epsilon: Metre,
    /// Kind of encounter, which sets σ = cos α: 1 for rear_end, 0 for side, −1 for frontal.
    #[arg(long, value_enum, default_value = "rear_end")]
    kind: Kind,
    /// Angle α between the headings, in rad; replaces the kind.
    #[arg(long, value_name = "RAD", value_parser = angle)]
    angle: Option<Radian>,
    /// Print the result as JSON.
    #[arg(long)]
    json: bool,
}

/// Prints μ under each model.
pub fn run(arguments: &MuArgs) -> Result<()> {
    let brakes =
        Brakes { response: arguments.response_time, build_up: arguments.build_up, deceleration: arguments.decel };
    let foe_brakes = Brakes { deceleration: arguments.foe_decel, ..brakes };
    let ego = Braking { speed: arguments.speed, brakes: &brakes };
    let foe = Braking { speed: arguments.foe_speed, brakes: &foe_brakes };
    let sigma = arguments.angle.map_or(arguments.kind.sigma(), f64::cos);
    let found = MuModel::ALL.map(|model| (name(model), mu(model, ego, foe, sigma, arguments.epsilon)));
    let stops = [stopping_distance(ego.speed, &brakes), stopping_distance(foe.speed, &foe_brakes)];
    if arguments.json {
        let mut object = serde_json::Map::new();
        object.insert("sigma".to_owned(), sigma.into());
        object.insert("stopping_distance".to_owned(), stops[0].into());
        object.insert("foe_stopping_distance".to_owned(), stops[1].into());
        object.extend(found.map(|(name, mu)| (name.replace('-', "_"), mu.into())));
        print(format_args!("{}\n", serde_json::Value::Object(object)))?;
    } else {
        let [own, other] = [(ego.speed, stops[0]), (foe.speed, stops[1])]
            .map(|(speed, stop)| format!("{} m/s stops within {} m", Written(speed), Written(stop)));
        print(format_args!("sigma {}; the ego at {own}, the foe at {other}\n", Written(sigma)))?;
        for (name, mu) in found {
            print(format_args!("{name:<8} {} m\n", Written(mu)))?;
        }
    }
    Ok(())
}

fn name(model: MuModel) -> String {
    model.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
}
