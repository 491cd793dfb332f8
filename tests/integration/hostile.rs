//! Files and frames that no run and no road user makes: each is refused with its place, and nothing grows.

use std::fs;
use std::path::Path;

use closecall::{Options, Profile, State, SumoType};
use closecall_analysis::logged::ConflictReader;
use closecall_run::Run;
use closecall_run::input::replay::demand;
use closecall_run::input::replay::recorded_step::RecordedStep;
use closecall_run::input::replay::recording::Recording;
use closecall_run::input::tracks::{TrackOptions, open};

use crate::street::street;

const HEADER: &str = "timestep_time;vehicle_id;vehicle_x;vehicle_y;vehicle_angle;vehicle_speed\n";

/// The error that ends a recording.
fn refused(text: &str) -> String {
    let mut step = RecordedStep::default();
    let mut recording = match Recording::parse(Path::new("fcd"), text) {
        Ok(recording) => recording,
        Err(error) => return error.to_string(),
    };
    loop {
        match recording.next_step(&mut step) {
            Ok(true) => {}
            Ok(false) => return "none".to_owned(),
            Err(error) => return error.to_string(),
        }
    }
}

#[test]
fn values_that_nothing_has_are_refused_with_their_line() {
    let csv = |row: &str| refused(&format!("{HEADER}0;a;1;2;90;5\n{row}\n"));
    assert_eq!(
        csv("1;a;9223372036854775808;2;90;5"),
        "fcd, line 3: \"a\": x is 9.223372036854776e18, it must be -1e8 to 1e8 m"
    );
    assert_eq!(csv("1;a;1;2;90;1e6"), "fcd, line 3: \"a\": speed is 1000000, it must be 0 to 1000 m/s");
    assert_eq!(csv("1e12;a;1;2;90;5"), "fcd, line 3: time is 1e12, it must be -1e10 to 1e10 s");
    assert_eq!(csv("1;a;-1073741824;-1073741824;90;5"), "none", "SUMO's value for no place");
    let xml = refused(
        "<fcd-export>\n<timestep time=\"0\">\n<vehicle id=\"a\" x=\"1\" y=\"2\" z=\"1e9\" angle=\"0\" speed=\"0\"/>",
    );
    assert_eq!(xml, "fcd, line 3: \"a\": z is 1e9, it must be -100000 to 100000 m");
}

#[test]
fn a_row_or_tag_without_an_end_is_refused_by_its_line() {
    let rows = "1;a;1;2;90;5\n".repeat(20_000);
    let said = refused(&format!("{HEADER}0;a;1;2;90;5\n0;b\";1;2;90;5\n{rows}"));
    assert_eq!(said, "fcd, line 3: the row is longer than 65536 bytes: a quotation mark that is not closed?");
    let said = refused(&format!("<fcd-export>\n<timestep time=\"{}", "0".repeat(2 << 20)));
    assert_eq!(said, "fcd, line 2: a tag or comment is longer than 1048576 bytes");
    let said = refused(&format!("{HEADER}0;{};1;2;90;5\n", "a".repeat(2000)));
    assert!(said.starts_with("fcd, line 2: ") && said.ends_with("is longer than 1024 bytes"), "{said}");
}

/// The error that ends a recording of another tool, from the line on; a table if there are columns.
fn refused_tracks(columns: &str, text: &str) -> String {
    let file = tempfile::NamedTempFile::new().unwrap();
    fs::write(file.path(), text).unwrap();
    let options = TrackOptions { columns: columns.to_owned(), ..TrackOptions::default() };
    let error = open(&[file.path().to_owned()], &options, None, &mut || false).unwrap_err().to_string();
    error.trim_start_matches(&file.path().display().to_string()).trim_start_matches(", ").to_owned()
}

#[test]
fn tracks_that_replay_cannot_read_are_refused_with_their_own_line() {
    let table = |rows: &str| refused_tracks("id=id,time=t,x=x,y=y,heading=h,speed=v", &format!("id,t,x,y,h,v\n{rows}"));
    let open = format!("a,0,1,2,0,5\n\"b,0,1,2,0,5\n{}", "a,1,1,2,0,5\n".repeat(20_000));
    assert_eq!(table(&open), "line 3: the row is longer than 65536 bytes: a quotation mark that is not closed?");
    assert_eq!(table("a,0,1,2,1e9,5\n"), ": \"a\" at 0 s: heading is 1e9, it must be -1000000 to 1000000 rad or °");
    let twice = "a,0,1,2,0,5\n".repeat(2);
    assert_eq!(table(&twice), ": \"a\" at 0 s: it is there twice");
    let fzp = |rows: &str| refused_tracks("", &format!("$VEHICLE:SIMSEC;NO;COORDFRONT;COORDREAR;SPEED\n{rows}"));
    assert_eq!(fzp(&"1;".repeat(40_000)), "line 2: the line is longer than 65536 bytes");
    assert_eq!(fzp(&"0;7;5 0 0;1 0 0;9\n".repeat(2)), "line 3: it is there twice");
    assert_eq!(fzp("0;;5 0 0;1 0 0;9\n"), "line 2: it has no id");
    let name = "n".repeat(2000);
    assert_eq!(fzp(&format!("0;{name};5 0 0;1 0 0;9\n")), "line 2: its id is longer than 1024 bytes");
}

#[test]
fn a_type_beyond_all_vehicles_is_refused_with_its_line() {
    for (attribute, said) in [
        ("width=\"1e15\"", "width is 1e15, it must be above 0 and at most 200 m"),
        ("length=\"1e9\"", "length is 1e9, it must be above 0 and at most 10000 m"),
        ("decel=\"NaN\"", "decel is NaN, it must be 0.01 to 1000 m/s²"),
    ] {
        let text = format!("<routes>\n<vType id=\"t\" {attribute}/></routes>");
        let error = demand::parse(Path::new("rou"), text, &street()).unwrap_err();
        assert_eq!(error.to_string(), format!("rou, line 2: type \"t\": {said}"));
    }
}

/// A run with `count` cars on the same spot.
fn crowd(count: usize, state: State) -> closecall_run::Result<()> {
    let mut run = Run::new(&closecall_run::RunOptions::default(), None).unwrap();
    let car = run.roster.profile(Profile::vehicle(&SumoType::car("car"), &Options::default())).unwrap();
    run.begin_step(3.0);
    for number in 0..count {
        let user = run.enter(&format!("car{number}"), car);
        run.frame.push(user, state);
    }
    run.step(|_, _| Ok(()))
}

#[test]
fn a_road_user_where_none_can_be_ends_the_step() {
    let at = State { x: 5.0, speed: 9.0, ..State::default() };
    assert!(crowd(1, at).is_ok());
    let said = crowd(1, State { y: 1e300, ..at }).unwrap_err().to_string();
    assert_eq!(said, "at 3 s: \"car0\": y is 1e300, it must be -1e8 to 1e8 m");
    assert!(crowd(1, State { y: f64::NAN, ..at }).is_ok(), "it is absent");
}

#[test]
fn too_many_in_one_place_are_refused_with_where() {
    let said = crowd(2500, State { x: 5.0, y: 7.0, speed: 9.0, ..State::default() }).unwrap_err().to_string();
    assert!(said.starts_with("at 3 s: too many road users in one place: \"car"), "{said}");
    assert!(said.contains("at (5.0, 7.0)"), "{said}");
}

/// The rows of a log that could be read, and what is wrong with them as a whole, after a change of conflicts.csv.
fn after(change: impl Fn(String) -> String, digest: &str) -> (usize, Option<String>) {
    let folder = tempfile::tempdir().unwrap();
    let example = |name: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fuzz").join(name);
        fs::read_to_string(path).unwrap()
    };
    let record = example("run_json/run.json").replacen('{', &format!("{{\"conflicts_sha256\": {digest},"), 1);
    fs::write(folder.path().join("run.json"), record).unwrap();
    fs::write(folder.path().join("conflicts.csv"), change(example("log/conflicts.csv"))).unwrap();
    let mut rows = ConflictReader::open(folder.path()).unwrap();
    let read = rows.by_ref().map(Result::unwrap).count();
    (read, rows.lost().map(|lost| lost.to_string().split(": ").last().unwrap().to_owned()))
}

#[test]
fn rows_that_are_gone_or_changed_are_missed() {
    let (all, lost) = after(|text| text, "null");
    assert_eq!(lost, None);
    let without_one = |text: String| text.lines().take(all).map(|line| line.to_owned() + "\n").collect();
    let said = format!("it has {} rows, but its run counted {all} conflicts", all - 1);
    assert_eq!(after(without_one, "null"), (all - 1, Some(said)));
    let said = "it was changed since its run wrote it (its SHA-256 differs)".to_owned();
    assert_eq!(after(|text| text, "\"0\""), (all, Some(said)));
}
