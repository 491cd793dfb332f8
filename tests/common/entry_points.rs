//! Everything that closecall reads, as functions of bytes: for the fuzz targets, and for the test that throws garbage.

#![allow(dead_code, reason = "each fuzz target has one entry point")]

use std::fs;
use std::path::Path;
use std::sync::Arc;

use closecall::Net;
use closecall_analysis::filter::{ConflictFilter, Place};
use closecall_analysis::logged::{ConflictReader, ConflictSelector, LoggedRun};
use closecall_analysis::playback::{Playback, svg};
use closecall_analysis::statistics::{Observed, Request, Statistics};
use closecall_analysis::{export, plot, report};
use closecall_run::RunOptions;
use closecall_run::input::replay::demand;
use closecall_run::input::replay::lights::RecordedLights;
use closecall_run::input::replay::recorded_step::RecordedStep;
use closecall_run::input::replay::recording::Recording;
use closecall_run::input::sumo_files::{check_xml, fault};
use closecall_run::input::tracks::{Opened, TrackOptions, inspect, open};
use closecall_run::net::selection::Filter;
use closecall_run::options::OptionsFile;
use closecall_run::output::formats::ExportFormat;
use closecall_run::{Replay, Run};

/// An entry point: its name, which is that of its fuzz target and of its examples in tests/fuzz, and what it does.
pub type Door = (&'static str, fn(&[u8]));

pub const ALL: [Door; 17] = [
    ("fcd", fcd),
    ("net", net),
    ("config", config),
    ("demand", demand_files),
    ("signals", signals),
    ("xml", xml),
    ("filter", filter),
    ("run_json", run_json),
    ("log", log),
    ("packed", packed),
    ("replay", replay),
    ("tracks", tracks),
    ("tracks_meta", tracks_meta),
    ("columns", columns),
    ("clips", clips),
    ("exported", exported),
    ("place", place),
];

const NET: &str = r#"<net>
<edge id="e" from="a" to="j"><lane id="e_0" length="90" shape="0,0 90,0"/></edge>
<edge id="f" from="j" to="b"><lane id="f_0" length="90" shape="100,10 100,100"/></edge>
<edge id=":j_0" function="internal"><lane id=":j_0_0" length="15" shape="90,0 97,3 100,10"/></edge>
<junction id="j" intLanes=":j_0_0" shape="90,-2 102,-2 102,10 98,10"/>
<connection from="e" to="f" fromLane="0" toLane="0" via=":j_0_0" tl="a" linkIndex="0"/>
<connection from=":j_0" to="f" fromLane="0" toLane="0"/></net>"#;

fn a_net() -> Net {
    closecall_run::net::parse(Path::new("net"), NET).unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A folder in memory where there is one.
fn folder() -> tempfile::TempDir {
    tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).unwrap()
}

/// Any bytes as a recording give steps or an error.
pub fn fcd(bytes: &[u8]) {
    let Ok(mut recording) = Recording::parse(Path::new("fcd"), bytes) else { return };
    let mut step = RecordedStep::default();
    while let Ok(true) = recording.next_step(&mut step) {
        assert!(step.time.is_finite());
        assert!(step.rows().iter().all(|row| !recording.id(row.user).is_empty()));
    }
}

/// Any bytes as a net give lanes with usable shapes or an error.
pub fn net(bytes: &[u8]) {
    let Ok(net) = closecall_run::net::parse(Path::new("net"), bytes) else { return };
    for (number, lane) in (0..).zip(&net.lanes) {
        assert!(lane.shape.len() >= 2);
        assert!(net.lines.line(number).iter().all(|vertex| vertex.distance.is_finite()));
        assert!(net.lane_at(lane.shape[0]).is_some());
    }
    let overlaps = net.overlaps();
    net.remarks(&overlaps, 0.25);
}

/// Any text as a TOML file of options gives words or an error.
pub fn config(bytes: &[u8]) {
    let known = ["mu", "epsilon", "obstacles", "no-shortcuts", "response-time"].map(str::to_owned);
    let Ok(file) = OptionsFile::parse(Path::new("config"), &text(bytes), &known, RunOptions::check_setting) else {
        return;
    };
    let settings = file.args.iter().filter_map(|word| word.trim_start_matches("--").split_once('='));
    let settings = settings.map(|(name, value)| (name, value.to_owned())).collect::<Vec<_>>();
    let _ = RunOptions::from_settings(settings);
}

/// Any bytes as route and additional files give types and routes or an error.
pub fn demand_files(bytes: &[u8]) {
    let _ = demand::parse(Path::new("demand"), bytes, &a_net());
}

/// Any bytes as SUMO's record of the traffic lights give their states or an error.
pub fn signals(bytes: &[u8]) {
    let folder = folder();
    let path = folder.path().join("signals.xml");
    fs::write(&path, bytes).unwrap();
    let net = Arc::new(a_net());
    let mut run = Run::new(&RunOptions::default(), Some(Arc::clone(&net))).unwrap();
    run.begin_step(0.0);
    if let Ok(mut lights) = RecordedLights::open(&path, &net) {
        let _ = lights.show(&mut run, 1e9);
    }
}

/// Any bytes as a file of SUMO's are well-formed or not, and a configuration names files or not.
pub fn xml(bytes: &[u8]) {
    let folder = folder();
    let path = folder.path().join("any.sumocfg");
    fs::write(&path, bytes).unwrap();
    let _ = check_xml(&path);
    let _ = fault(&path);
}

/// Any text as a selection holds lanes or not.
pub fn filter(bytes: &[u8]) {
    let _ = Filter::parse(Path::new("filter"), &text(bytes), &a_net());
}

/// Any text as a run.json is one or not.
pub fn run_json(bytes: &[u8]) {
    if let Ok(run) = LoggedRun::parse(Path::new("run.json"), &text(bytes)) {
        assert!(run.hours().is_finite());
    }
}

/// Any bytes as the log of a run give statistics, a report and pictures, or an error. A run.json may follow after a NUL.
pub fn log(bytes: &[u8]) {
    let (conflicts, run) = bytes.split_at(bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len()));
    let run =
        run.strip_prefix(&[0]).filter(|run| !run.is_empty()).unwrap_or(include_bytes!("../fuzz/run_json/run.json"));
    of_log(&[("conflicts.csv", conflicts), ("run.json", run)]);
}

/// Any bytes as a file of a sweep, in the same way.
pub fn packed(bytes: &[u8]) {
    of_log(&[("conflicts.parquet", bytes)]);
}

fn of_log(files: &[(&str, &[u8])]) {
    let folder = folder();
    let log = folder.path().join("log");
    fs::create_dir(&log).unwrap();
    files.iter().for_each(|(name, bytes)| fs::write(log.join(name), bytes).unwrap());
    if let Ok(conflicts) = ConflictReader::open(&log) {
        conflicts.with_snapshots().for_each(|conflict| drop(conflict.map(|conflict| conflict.delta_v())));
    }
    let filter = ConflictFilter::default();
    let folders = vec![log];
    let request = Request {
        folders: folders.clone(),
        by: Default::default(),
        against: folders.clone(),
        filter: filter.clone(),
        worst: 3,
        plan: Some(1.3),
        observed: Some(Observed { crashes: 14, years: 5.0 }),
    };
    let _ = Statistics::of(&request, &mut |_, _| ());
    let report = report::Request {
        folders: &folders,
        against: &folders,
        net: None,
        filter: &filter,
        is_summary: false,
        tiles: None,
        whatif: None,
        clips: None,
    };
    let _ = report::write(&report, &folder.path().join("report.html"), &mut |_, _| ());
    let plots = folder.path().join("plots");
    let (format, style) = (plot::PictureFormat::Svg, plot::PictureStyle::Screen);
    let _ = plot::write(&folders, None, &filter, (&plots, format, style), &mut |_, _| ());
}

/// Any bytes as a recording of another tool, in the format that they show, give steps or an error.
pub fn tracks(bytes: &[u8]) {
    let beside: [(&str, &[u8]); 2] = [
        ("00_tracksMeta.csv", b"trackId,class\n1,car\n2,pedestrian\n"),
        ("00_recordingMeta.csv", b"recordingId,frameRate\n0,25\n"),
    ];
    of_tracks(&[("00_tracks.csv", bytes), beside[0], beside[1]], &TrackOptions::default());
}

/// Any bytes as the classes of the road users of a recording, after a NUL as its frame rate.
pub fn tracks_meta(bytes: &[u8]) {
    let (classes, rate) = bytes.split_at(bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len()));
    let tracks = include_bytes!("../fuzz/tracks/inD.csv");
    let rate = rate.strip_prefix(&[0]).unwrap_or(rate);
    let files: [(&str, &[u8]); 3] =
        [("00_tracks.csv", tracks), ("00_tracksMeta.csv", classes), ("00_recordingMeta.csv", rate)];
    of_tracks(&files, &TrackOptions::default());
}

/// Any first line as `--columns`, and what follows as the table.
pub fn columns(bytes: &[u8]) {
    let (columns, table) = bytes.split_at(bytes.iter().position(|byte| *byte == b'\n').unwrap_or(bytes.len()));
    let options = TrackOptions { columns: text(columns), frame_rate: Some(10.0), ..TrackOptions::default() };
    of_tracks(&[("00_tracks.csv", table.strip_prefix(b"\n").unwrap_or(table))], &options);
}

/// What is turned into SUMO's fcd-output is read as such: faults are found before, where their place is known.
fn of_tracks(files: &[(&str, &[u8])], options: &TrackOptions) {
    let folder = folder();
    files.iter().for_each(|(name, bytes)| fs::write(folder.path().join(name), bytes).unwrap());
    let path = folder.path().join(files[0].0);
    let _ = inspect(&path);
    for net in [None, Some(&a_net())] {
        let Ok(opened @ Opened::Converted(_)) = open(std::slice::from_ref(&path), options, net, &mut || false) else {
            return;
        };
        let mut recording = Recording::open(opened.recording()).unwrap();
        let mut step = RecordedStep::default();
        while recording.next_step(&mut step).unwrap() {}
        demand::parse(Path::new("types"), fs::read(opened.types().unwrap()).unwrap(), &a_net()).unwrap();
    }
}

/// Any bytes as the clips of a log, gzipped or not, give a picture and a scene or an error.
pub fn clips(bytes: &[u8]) {
    let folder = folder();
    let log: [(&str, &[u8]); 3] = [
        ("conflicts.csv", include_bytes!("../fuzz/log/conflicts.csv")),
        ("run.json", include_bytes!("../fuzz/run_json/run.json")),
        ("clips.jsonl.gz", bytes),
    ];
    log.iter().for_each(|(name, bytes)| fs::write(folder.path().join(name), bytes).unwrap());
    let net = folder.path().join("net.xml");
    fs::write(&net, NET).unwrap();
    if let Ok(playback) = Playback::find(folder.path(), ConflictSelector::Worst(1), Some(&net)) {
        assert!(!svg(&playback).contains("NaN"));
        serde_json::to_string(&playback.show()).unwrap();
    }
}

/// Any bytes as `conflicts.csv` give a file in each format of export, or an error.
pub fn exported(bytes: &[u8]) {
    let folder = folder();
    let log = folder.path().join("log");
    fs::create_dir(&log).unwrap();
    fs::write(log.join("conflicts.csv"), bytes).unwrap();
    fs::write(log.join("run.json"), include_bytes!("../fuzz/run_json/run.json")).unwrap();
    for format in [
        ExportFormat::GeoJson,
        ExportFormat::GeoParquet,
        ExportFormat::GeoPackage,
        ExportFormat::Poi,
        ExportFormat::Ssm,
    ] {
        let _ =
            export::write(&log, format, &ConflictFilter::default(), &folder.path().join("exported"), &mut |_, _| ());
    }
}

/// Any text as a place of `--where` is one, which is written as it is read, or not.
pub fn place(bytes: &[u8]) {
    if let Ok(place) = text(bytes).parse::<Place>() {
        assert_eq!(place.to_string().parse(), Ok(place));
    }
}

/// Any bytes as a recording, after a NUL those of a demand, give conflicts or an error.
pub fn replay(bytes: &[u8]) {
    let (recording, demand) = bytes.split_at(bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len()));
    let folder = folder();
    let [fcd, rou] = ["fcd", "rou.xml"].map(|name| folder.path().join(name));
    fs::write(&fcd, recording).unwrap();
    fs::write(&rou, demand.strip_prefix(&[0]).unwrap_or(b"<routes/>")).unwrap();
    let net = Arc::new(a_net());
    for path in ["lanes", "arc", "driven"] {
        let options = RunOptions::from_settings([("path", path.to_owned())]).unwrap();
        let Ok(mut replay) = Replay::open(&fcd, std::slice::from_ref(&rou), Some(&net), &options.model) else { return };
        let mut run = Run::new(&options, Some(net.clone())).unwrap();
        while let Ok(Some(_)) = replay.next(&mut run) {}
        let _ = run.finish();
    }
}
