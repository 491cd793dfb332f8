//! The detector on more and more threads, up to the machine's cores: what each number of threads gains, in which part of
//! a step, and how much of a part is serial. `cargo bench --bench cores`.
//!
//! As a comparison, as many detectors at once, each with all road users on a thread of its own: the most that this many threads
//! can gain on this machine, as they share its memory and its clock.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark may")]
#![allow(dead_code, reason = "this bench does not use all of scenes")]

mod scenes;

use std::hint::black_box;
use std::time::{Duration, Instant};

use closecall::util::threads::{Team, processors};
use closecall::{Detector, Options, State};
use closecall_study::reference::chance::Chance;
use scenes::{Scene, TIMES, detector, wake};

/// Steps are measured for at least this long.
const LONG_ENOUGH: Duration = Duration::from_millis(700);

/// At least this many steps are measured.
const FEWEST: usize = 3;

/// With more road users than this, not many detectors are run at once.
const LARGE: usize = 100_000;

/// The parts of a step that are timed, the whole first.
const PARTS: [&str; 4] = ["step", "track paths", "broad phase", "narrow phase"];

fn main() {
    println!("what,scene,method,size,value,unit");
    for (name, draw) in scenes::SCENES {
        for count in [10_000, LARGE, 1_000_000] {
            measure(name, &draw(&mut Chance::new(1), count));
        }
    }
}

/// Measures a scene with 1, 2, 4, … threads.
fn measure(name: &str, start: &[State]) {
    let count = start.len();
    let mut alone: Option<[f64; 4]> = None;
    for threads in (0..).map(|power| 1 << power).take_while(|threads| *threads <= processors().max(2)) {
        wake(threads, 0.5);
        let mut detector = detector(&Options::default(), threads);
        let times = times(&mut Scene::new(start.to_vec()), |scene| parts_of_step(&mut detector, scene));
        let one = *alone.get_or_insert(times);
        for ((part, time), one) in PARTS.iter().zip(times).zip(one) {
            let row = |what: &str, value: f64, unit: &str| {
                println!("{what},{name},{part} with {threads} threads,{count},{value:.4},{unit}");
            };
            row("cores", time * 1e9 / count as f64, "ns per road user");
            if threads > 1 {
                row("gain", one / time, "times one thread");
                let serial = (threads as f64 * time - one) / (threads as f64 - 1.0);
                row("serial", (serial / alone.map_or(one, |[whole, ..]| whole)).max(0.0), "of a step of one thread");
            }
        }
        println!("sorted anew,{name},{threads} threads,{count},{},steps", detector.work().sorted_anew);
        if threads > 1 && count <= LARGE {
            println!("gain,{name},{threads} at once,{count},{:.4},times one thread", at_once(threads, start, one[0]));
        }
    }
}

/// The medians of what `step` measures, in s: at least [`FEWEST`] steps, after those in which threads wake up and the
/// boxes get their order.
fn times(scene: &mut Scene, mut step: impl FnMut(&Scene) -> [f64; 4]) -> [f64; 4] {
    for time in TIMES {
        scene.advance(time);
        step(scene);
    }
    let (mut taken, begin) = ([(); 4].map(|()| Vec::new()), Instant::now());
    for time in TIMES.iter().cycle() {
        scene.advance(*time);
        taken.iter_mut().zip(step(scene)).for_each(|(taken, time)| taken.push(time));
        if taken[0].len() >= FEWEST && begin.elapsed() > LONG_ENOUGH {
            break;
        }
    }
    taken.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    })
}

/// Does a step: the times of the whole and of its parts, in s.
fn parts_of_step(detector: &mut Detector, Scene { frame, roster, .. }: &Scene) -> [f64; 4] {
    let begin = Instant::now();
    detector.track_paths(frame, roster);
    let tracked = begin.elapsed().as_secs_f64();
    detector.broad_phase(frame, roster);
    let paired = begin.elapsed().as_secs_f64();
    black_box(detector.narrow_phase(frame, roster).len());
    let all = begin.elapsed().as_secs_f64();
    [all, tracked, paired - tracked, all - paired]
}

/// How many times the work of one detector as many detectors at once do, if one alone takes `alone` for a step, in s.
fn at_once(threads: usize, start: &[State], alone: f64) -> f64 {
    let team = Team::new(threads);
    let mut detectors: Vec<_> = (0..threads).map(|_| detector(&Options::default(), 1)).collect();
    let [time, ..] = times(&mut Scene::new(start.to_vec()), |scene| {
        let begin = Instant::now();
        team.each(vec![(); threads], detectors.iter_mut(), |(), detector| _ = parts_of_step(detector, scene));
        [begin.elapsed().as_secs_f64(), 0.0, 0.0, 0.0]
    });
    threads as f64 * alone / time
}
