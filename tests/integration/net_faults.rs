//! The faults of the net: what is counted, and what a run says and writes of it.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use closecall::{Category, Net, Options, PathModel, Profile, State, SumoType};
use closecall_run::RunOptions;
use closecall_run::{Ending, Error, LogFolder, OutputFiles, RecordedRun, Result, Run, RunRecord};

use crate::why::{Drive, LEFT, ONCOMING, drive, net_of, run_of};

/// The rows of a log's file, by column.
fn rows(log: &Path) -> Vec<Vec<String>> {
    let text = fs::read_to_string(log.join("net_faults.csv")).unwrap();
    text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

/// Ends a run with a log in a folder; returns its lines on the net.
fn said(run: impl FnOnce(Run) -> Run, net: &Arc<Net>, log: &Path) -> Vec<String> {
    let options = RunOptions::from(Options { path: PathModel::Straight, ..Options::default() });
    let record = RunRecord::new(PathBuf::from("a.sumocfg"), options.clone());
    let new = Run::new(&options, Some(Arc::clone(net))).unwrap();
    let mut recorded = RecordedRun::open(new, record, LogFolder::claim(log).unwrap(), &OutputFiles::default()).unwrap();
    recorded.run = run(std::mem::replace(&mut recorded.run, Run::new(&options, None).unwrap()));
    let summary = recorded.close(Ending::default()).unwrap();
    let lines = summary.remarks.into_iter().map(|remark| remark.text);
    lines.filter(|line| line.starts_with("net faults") || line.starts_with("the worst")).collect()
}

/// A person stands, and each of `cars` cars drives over it.
fn pass(mut run: Run, cars: u32) -> Run {
    let options = Options::default();
    let car = run.roster.profile(Profile::vehicle(&SumoType::car("car"), &options)).unwrap();
    let person = run.roster.profile(Profile::person(&SumoType::car("person"), &options, 0.1)).unwrap();
    let stands = run.enter("person", person);
    let mut time = 0.0;
    for number in 0..cars {
        let passes = run.enter(&format!("car{number}"), car);
        for step in 0..60 {
            run.begin_step(time);
            run.frame.push(stands, State { x: 4.0, y: 0.0, z: 0.0, heading: 1.6, speed: 0.0 });
            run.frame.push(passes, State { x: f64::from(step) - 20.0, y: 0.3, z: 0.0, heading: 0.0, speed: 10.0 });
            let stepped: Result<()> = run.step(|_, _| Ok::<_, Error>(()));
            stepped.unwrap();
            time += 0.1;
        }
        run.leave(passes);
    }
    run
}

#[test]
fn one_that_stands_counts_once_however_many_pass() {
    let text = r#"<net><edge id=":j_w0" function="walkingarea">
        <lane id=":j_w0_0" allow="pedestrian" length="4" shape="0,-2 9,-2 9,2 0,2"/></edge>
        <edge id="a"><lane id="a_0" length="200" speed="30" shape="-100,0.3 100,0.3"/></edge></net>"#;
    let net = Arc::new(closecall_run::net::parse(Path::new("net"), text.to_owned()).unwrap());
    let log = tempfile::tempdir().unwrap();
    let lines = said(|run| pass(run, 7), &net, log.path());
    let rows = rows(log.path());
    assert_eq!(rows.len(), 2, "{rows:?}");
    assert_eq!(rows[1][..2], [":j_w0_0", "a_0"]);
    assert_eq!(rows[1][3..7], ["on_foot", "1", "7", "8"]);
    assert!(lines[0].starts_with("net faults: at 1 pair of lanes SUMO drives road users through each other, 1 time"));
    assert!(lines[0].contains("8 road users") && lines[0].ends_with("net_faults.csv"), "{}", lines[0]);
    assert!(lines[1].starts_with("the worst is :j_w0_0 and a_0, 1 time, "), "{}", lines[1]);
    // The next run has no faults, and leaves none of the earlier one's behind.
    assert!(said(|run| run, &net, log.path()).is_empty());
    assert!(!log.path().join("net_faults.csv").exists() && log.path().join("earlier/1/net_faults.csv").exists());
}

#[test]
fn a_vehicle_that_waits_inside_is_one_fault() {
    let net = net_of("left_turn");
    let length = |lane: &str| net.lanes[net.lane(lane).unwrap()].length;
    let waits = drive(&LEFT[1..], length(LEFT[1]) + 3.0, |_| 0.0);
    let passes = |number: u32| drive(&ONCOMING, length(ONCOMING[0]) - 30.0 - 25.0 * f64::from(number), |_| 12.0);
    let drives = [waits].into_iter().chain((0..7).map(passes)).collect::<Vec<Drive>>();
    assert!(drives.iter().all(|drive| drive.category == Category::Vehicle && drive.start > 0.0));
    let run = run_of(&net, &drives, &[], &[], 25.0);
    let summary = RecordedRun::in_memory(run).close(Ending::default()).unwrap();
    let lines = summary.remarks.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
    assert!(
        lines.contains("at 1 pair of lanes SUMO drives road users through each other, 1 time with 8 road users"),
        "{lines}"
    );
    assert!(lines.contains("the worst is :centre_1_0 and :centre_14_0, 1 time, "), "{lines}");
    assert!(lines.contains("contPos"), "{lines}");
}
