//! Replays with `--path driven`: predictions use the recorded future path.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use closecall::{Net, Options, Point};
use closecall_run::RunOptions;
use closecall_run::{Replay, Run};
use proptest::prelude::*;

/// The length of SUMO's default car in m.
const CAR: f64 = 5.0;

/// A car's way: the place of its front bumper by the metres driven, 0 where the recording begins.
type Road = Box<dyn Fn(f64) -> Point>;

/// A recording of cars that drive along their ways at constant speeds, on one lane.
fn recording(roads: &[(Road, f64)], seconds: f64, rate: f64) -> tempfile::NamedTempFile {
    let mut text =
        "timestep_time;vehicle_id;vehicle_x;vehicle_y;vehicle_angle;vehicle_speed;vehicle_lane;vehicle_pos\n"
            .to_owned();
    for step in 0..(seconds * rate) as u32 {
        let time = f64::from(step) / rate;
        for (number, (travelled, speed)) in roads.iter().enumerate() {
            let (front, rear) = (travelled(speed * time), travelled(speed * time - CAR));
            let ahead = front - rear;
            let (x, y, angle) = (front.x, front.y, 90.0 - ahead.y.atan2(ahead.x).to_degrees());
            writeln!(text, "{time};{number};{x};{y};{angle};{speed};a_0;{}", speed * time + 10.0).unwrap();
        }
    }
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), text).unwrap();
    file
}

/// Replays with these settings; calls `each` after every step.
fn replay(file: &Path, net: Option<&Arc<Net>>, settings: &[(&str, &str)], mut each: impl FnMut(f64, &Run)) {
    let options = RunOptions::from_settings(settings.iter().map(|(name, value)| (*name, (*value).to_owned()))).unwrap();
    let mut replay = Replay::open(file, &[], net.map(|net| &**net), &options.model).unwrap();
    let mut run = Run::new(&options, net.cloned()).unwrap();
    run.set_fixed_routes(true);
    while let Some(time) = replay.next(&mut run).unwrap() {
        each(time, &run);
    }
}

/// East, round a quarter of a circle to the left, north: the circle, of 10 m radius, begins after `turns_after` metres.
fn left_turn(from: Point, turns_after: f64) -> Road {
    Box::new(move |travelled| {
        let round = (travelled - turns_after).clamp(0.0, 10.0 * FRAC_PI_2);
        let (sine, cosine) = (round / 10.0).sin_cos();
        let beyond = (travelled - turns_after - 10.0 * FRAC_PI_2).max(0.0);
        Point::new(from.x + travelled.min(turns_after) + 10.0 * sine, from.y + 10.0 * (1.0 - cosine) + beyond)
    })
}

#[test]
fn a_turn_to_come_is_met_with_the_right_ttc_and_mu() {
    // Both at 10 m/s. The front of the one that turns touches the other's right side, y = −0.9 m, after 40 m, at 4 s; the other's
    // front has come to x = 0 then, the middle of the way north.
    let until_north = 20.0 - 10.0 - 0.9;
    let turns_after = 40.0 - until_north - 10.0 * FRAC_PI_2;
    let turner = left_turn(Point::new(-10.0 - turns_after, -20.0), turns_after);
    let roads: [(Road, f64); 2] = [(Box::new(|travelled| Point::new(-40.0 + travelled, 0.0)), 10.0), (turner, 10.0)];
    let file = recording(&roads, 6.0, 25.0);
    let mut seen = 0;
    replay(file.path(), None, &[("path", "driven"), ("log", "ttc < 5")], |time, run| {
        for found in run.in_conflict().filter(|_| time < 3.8) {
            seen += 1;
            let ttc = found.nearness.unwrap().values.ttc().unwrap();
            assert!((ttc - (4.0 - time)).abs() < 2e-3, "{ttc} s at {time} s");
            // They cross at a right angle at the latest moment; then μ is the stopping distance and ε.
            if (found.angle - FRAC_PI_2).abs() < 1e-3 {
                let stop = 10.0 * 1.05 + 10.0 * 0.1 / 2.0 + 100.0 / 18.0 - 9.0 * 0.01 / 24.0;
                assert!((found.mu - stop - 0.5).abs() < 1e-2, "{}", found.mu);
            }
        }
    });
    assert!(seen >= 90, "it is known from the first steps on: {seen}");
    for path in ["straight", "arc"] {
        let mut first = f64::INFINITY;
        replay(file.path(), None, &[("path", path), ("log", "ttc < 5")], |time, run| {
            if run.in_conflict().len() > 0 {
                first = first.min(time);
            }
        });
        assert!(first > 1.0, "with {path} from {first} s on");
    }
}

#[test]
fn without_attachment_to_a_recording_driven_is_refused() {
    let options = RunOptions::from_settings([("path", "driven".to_owned())]).unwrap();
    let message = options.model.check_future_is_unknown().unwrap_err().to_string();
    assert!(message.starts_with("path: driven") && message.contains("closecall replay"), "{message}");
    assert!(Options::default().check_future_is_unknown().is_ok());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn one_that_keeps_its_lane_drives_its_lane_path(
        radius in 8.0..60.0_f64, amplitude in 0.2..1.4_f64, speed in 2.0..20.0_f64, rate in 10.0..30.0_f64,
    ) {
        // A lane whose direction swings: no tighter than the radius.
        let wave = amplitude * radius * 2.0;
        let direction = move |travelled: f64| amplitude * f64::sin(travelled * 2.0 * PI / (wave * PI));
        let mut lane = vec![Point::new(0.0, 0.0)];
        for piece in 0..800 {
            let (sine, cosine) = direction(f64::from(piece) * 0.5).sin_cos();
            lane.push(lane.last().unwrap() + nalgebra::Vector2::new(cosine, sine) * 0.5);
        }
        let shape = lane.iter().map(|point| format!("{},{}", point.x, point.y)).collect::<Vec<_>>().join(" ");
        let net = format!(r#"<net><edge id="a" from="s" to="e"><lane id="a_0" index="0" length="400" shape="{shape}"/></edge></net>"#);
        let net = Arc::new(closecall_run::net::parse(Path::new("net"), net).unwrap());
        let travelled: Road = Box::new(move |travelled| {
            let along = (travelled + 10.0) / 0.5;
            let piece = along as usize;
            lane[piece] + (lane[piece + 1] - lane[piece]) * along.fract()
        });
        let file = recording(&[(travelled, speed)], 6.0, rate);
        let paths = ["lanes", "driven"].map(|path| {
            let mut paths = Vec::new();
            replay(file.path(), Some(&net), &[("path", path)], |_, run| paths.push(run.path(run.frame.user(0))));
            paths
        });
        // Between two recorded places the path is the chord.
        let most = 0.03 + (speed / rate).powi(2) / (8.0 * radius);
        // The last steps look beyond the recording's end.
        for (lanes, driven) in paths[0].iter().zip(&paths[1]).take((2.0 * rate) as usize) {
            for point in driven {
                let off = lanes.windows(2).map(|ends| from_segment(*point, ends[0], ends[1])).fold(f64::INFINITY, f64::min);
                prop_assert!(off < most, "{off} m beside the lane");
            }
        }
    }
}

fn from_segment(point: Point, start: Point, end: Point) -> f64 {
    let along = end - start;
    let share = ((point - start).dot(&along) / along.norm_squared().max(1e-12)).clamp(0.0, 1.0);
    (point - (start + along * share)).norm()
}
