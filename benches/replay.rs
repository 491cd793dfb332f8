//! Vehicle-steps per second of a replay from CSV and from XML: reading alone and the whole replay, in sparse traffic (no
//! two vehicles near each other) and in platoons (each vehicle 25 m behind another). Also the peak memory of
//! `closecall replay` on a small and on a large recording. `cargo bench --bench replay`.
//!
//! `-- --large GIGABYTES` sets the size of the large recording (1). `-- [--net NET] RECORDING…` measures given recordings
//! instead; with a net they are replayed too.

#![allow(clippy::unwrap_used, clippy::panic, missing_docs, reason = "a benchmark may")]

use std::ffi::OsString;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;

use closecall::{Net, Options};
use closecall_run::input::replay::recorded_step::RecordedStep;
use closecall_run::input::replay::recording::Recording;
use closecall_run::{Replay, Run};

/// Parallel roads, far enough apart that their traffic never meets.
const ROADS: usize = 20;
const LENGTH: f64 = 10_000.0;
const SPEED: f64 = 13.89;
const STEPS: usize = 200;

/// Rounds per recording; the fastest counts.
const ROUNDS: usize = 3;

fn main() {
    let args = std::env::args().skip(1).filter(|word| word != "--bench").collect::<Vec<_>>();
    let args = args.iter().map(String::as_str).collect::<Vec<_>>();
    if let ["--alone", ..] = args[..] {
        return alone(&args[1..]);
    }
    println!("what,scene,method,size,value,unit");
    match &args[..] {
        [] => all(1.0),
        ["--large", gigabytes] => all(gigabytes.parse().unwrap()),
        ["--net", net, paths @ ..] => measure(given(paths), Some(Path::new(net))),
        paths => measure(given(paths), None),
    }
}

fn given(paths: &[&str]) -> Vec<Measured> {
    paths.iter().map(|path| Measured::new((*path).to_owned(), path.into())).collect()
}

fn all(large: f64) {
    // On the disk of the target folder, because the system's temporary folder may be in memory.
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    let net = write_net(folder.path());
    let mut recordings = Vec::new();
    for (traffic, headway) in [("sparse", 100.0), ("platoons", 25.0)] {
        for ending in ["csv", "xml"] {
            for columns in ["", " with all attributes"] {
                let scene = format!("{traffic}{columns}");
                let path = folder.path().join(format!("{scene}.{ending}"));
                write_recording(&path, headway, STEPS, !columns.is_empty());
                recordings.push(Measured::new(scene, path));
            }
        }
    }
    measure(recordings, Some(&net));
    for ending in ["csv", "xml"] {
        for megabytes in [10.0, large * 1000.0] {
            peak(&net, &folder.path().join(format!("fcd.{ending}")), megabytes);
        }
    }
}

/// Replays a recording of about this size in three processes and prints the least of their peak memories: that of one
/// recording varies by 0.5 MB.
fn peak(net: &Path, path: &Path, megabytes: f64) {
    write_recording(path, 100.0, 10, false);
    let steps = megabytes * 1e6 / std::fs::metadata(path).unwrap().len() as f64 * 10.0;
    write_recording(path, 100.0, steps as usize, false);
    let out = path.with_extension("log");
    let kilobytes = || {
        let mut command = Command::new(std::env::current_exe().unwrap());
        let args = ["--alone", "closecall", "replay", "--quiet", "--net"];
        let output = command.args(args).arg(net).arg("--out").arg(&out).arg(path).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap().trim().parse::<f64>().unwrap()
    };
    let least = (0..3).map(|_| kilobytes()).fold(f64::INFINITY, f64::min);
    println!("peak,{megabytes} MB,{},,{:.2},MB", name(path), least / 1e3);
    std::fs::remove_file(path).unwrap();
}

/// Runs closecall with these words and prints its peak memory, in kB, if the system reports it (Linux).
fn alone(args: &[&str]) {
    assert_eq!(closecall_cli::main(args.iter().map(OsString::from), None), 0);
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let most = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    println!("{}", most.map_or("NaN", |most| most.trim_end_matches("kB").trim()));
}

fn name(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_uppercase()
}

/// A recording, and the fastest times for reading and for replaying it, in s.
struct Measured {
    scene: String,
    path: PathBuf,
    rows: usize,
    reading: f64,
    replaying: f64,
}

impl Measured {
    fn new(scene: String, path: PathBuf) -> Self {
        Self { scene, path, rows: 0, reading: f64::INFINITY, replaying: f64::INFINITY }
    }

    fn read(&mut self) {
        self.rows = 0;
        let (rows, path) = (&mut self.rows, &self.path);
        let seconds = seconds(|| {
            let (mut recording, mut step) = (Recording::open(path).unwrap(), RecordedStep::default());
            // A recording that is cut short is read up to there.
            while let Ok(true) = recording.next_step(&mut step) {
                *rows += step.rows().len();
            }
        });
        self.reading = self.reading.min(seconds);
    }

    fn replay(&mut self, net: &Arc<Net>) {
        let options = Options::default();
        let seconds = seconds(|| {
            let mut replay = Replay::open(&self.path, &[], Some(net), &options).unwrap();
            let mut run = Run::new(&options.clone().into(), Some(net.clone())).unwrap();
            run.set_fixed_routes(true);
            while let Ok(Some(_)) = replay.next(&mut run) {}
        });
        self.replaying = self.replaying.min(seconds);
    }
}

/// Measures the recordings in turns, because the machine's speed changes every few seconds.
fn measure(mut recordings: Vec<Measured>, net: Option<&Path>) {
    let net = net.map(|net| Arc::new(closecall_run::net::read(net).unwrap()));
    for _ in 0..ROUNDS {
        for recording in &mut recordings {
            recording.read();
            net.iter().for_each(|net| recording.replay(net));
        }
    }
    for Measured { scene, path, rows, reading, replaying } in &recordings {
        for (what, seconds) in [("read", reading), ("replay", replaying)].into_iter().filter(|(_, s)| s.is_finite()) {
            println!("{what},{scene},{},{rows},{:.3e},vehicle-steps per s", name(path), *rows as f64 / seconds);
        }
    }
}

/// The time that the action takes, in s: processor time if the system reports it, so that other programs do not count.
fn seconds(action: impl FnOnce()) -> f64 {
    let started = Instant::now();
    let now = || {
        let system = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
        let nanoseconds = system.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
        nanoseconds.map_or_else(|| started.elapsed().as_secs_f64(), |nanoseconds| nanoseconds / 1e9)
    };
    let before = now();
    action();
    now() - before
}

fn write_net(folder: &Path) -> PathBuf {
    let path = folder.join("roads.net.xml");
    let mut net = BufWriter::new(File::create(&path).unwrap());
    writeln!(net, "<net>").unwrap();
    for road in 0..ROADS {
        let y = road as f64 * 200.0;
        writeln!(net, r#"<edge id="road{road}" from="a" to="b"><lane id="road{road}_0" length="{LENGTH}" shape="0,{y} {LENGTH},{y}"/></edge>"#).unwrap();
    }
    writeln!(net, "</net>").unwrap();
    path
}

/// Vehicles drive along every road, and one enters as another leaves; ids are never reused.
fn write_recording(path: &Path, headway: f64, steps: usize, all: bool) {
    let xml = path.extension().is_some_and(|ending| ending == "xml");
    let mut file = BufWriter::new(File::create(path).unwrap());
    let names = ["x", "y", "angle", "type", "speed", "pos", "lane", "slope"];
    let more = if all { 14 } else { 0 };
    let between = if all { 6 } else { 0 };
    if xml {
        writeln!(file, "<fcd-export>").unwrap();
    } else {
        let names = names.map(|name| format!("vehicle_{name}")).join(";");
        let names = if all {
            let fill = |from, to| (from..to).map(|n| format!(";vehicle_more{n}")).collect::<String>();
            format!("{names}{};vehicle_speedLat{}", fill(0, between), fill(between, more))
        } else {
            names
        };
        writeln!(file, "timestep_time;vehicle_id;{names}").unwrap();
    }
    let on_road = (LENGTH / headway) as usize;
    for step in 0..steps {
        let time = step as f64 * 0.1;
        if xml {
            writeln!(file, "    <timestep time=\"{time:.2}\">").unwrap();
        }
        let gone = (SPEED * time / headway) as usize;
        for road in 0..ROADS {
            for vehicle in gone..gone + on_road {
                let x = SPEED * time + (on_road as f64 - 1.0 - vehicle as f64) * headway + (vehicle % 7) as f64 * 0.11;
                let x = x.rem_euclid(LENGTH);
                let y = road as f64 * 200.0;
                if xml {
                    write!(file, "        <vehicle id=\"v{road}.{vehicle}\" x=\"{x:.2}\" y=\"{y:.2}\" angle=\"90.00\" type=\"car\" speed=\"{SPEED:.2}\" pos=\"{x:.2}\" lane=\"road{road}_0\" slope=\"0.00\"").unwrap();
                    for n in 0..more {
                        write!(file, " more{n}=\"{:.2}\"", x / 3.0 + n as f64).unwrap();
                        if n + 1 == between {
                            write!(file, " speedLat=\"0.00\"").unwrap();
                        }
                    }
                    writeln!(file, "/>").unwrap();
                } else {
                    write!(
                        file,
                        "{time:.2};v{road}.{vehicle};{x:.2};{y:.2};90.00;car;{SPEED:.2};{x:.2};road{road}_0;0.00"
                    )
                    .unwrap();
                    for n in 0..more {
                        write!(file, ";{:.2}", x / 3.0 + n as f64).unwrap();
                        if n + 1 == between {
                            write!(file, ";0.00").unwrap();
                        }
                    }
                    writeln!(file).unwrap();
                }
            }
        }
        if xml {
            writeln!(file, "    </timestep>").unwrap();
        }
    }
    if xml {
        writeln!(file, "</fcd-export>").unwrap();
    }
}
