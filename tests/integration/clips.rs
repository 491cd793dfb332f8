//! Clips: what a log keeps of the seconds around a conflict, and the pictures made of them.

use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Output};

use flate2::read::GzDecoder;
use serde_json::Value;

const NET: &str =
    r#"<net><edge id="e" from="a" to="b"><lane id="e_0" index="0" length="90" shape="0,-50 0,40"/></edge></net>"#;

/// Two cars that meet at a right angle 10 s after the begin, at the place 0, 0; one waits behind, another is far away, one has
/// gone before, and one comes in its stead.
fn record(folder: &Path) {
    let mut text = "<fcd-export>\n".to_owned();
    for step in 0..200 {
        let time = f64::from(step) / 10.0;
        text += &format!("<timestep time=\"{time}\">\n");
        let to_go = 10.0 - time;
        let cars = [
            ("east\"&amp;<", -14.0 * to_go, 0.0, 90.0, 14.0, true),
            ("north", 0.0, -13.0 * to_go, 0.0, 13.0, true),
            ("waits", -30.0, 40.0, 90.0, 0.0, true),
            ("gone", 20.0, 30.0, 90.0, 0.0, time < 7.0),
            ("new", 25.0, -30.0, 90.0, 0.0, time > 7.55),
            ("far", 300.0, 300.0, 90.0, 0.0, true),
        ];
        for (id, x, y, angle, speed, is_there) in cars {
            let id = id.replace('"', "&quot;").replace('<', "&lt;");
            if is_there {
                text += &format!(
                    "<vehicle id=\"{id}\" x=\"{x}\" y=\"{y}\" angle=\"{angle}\" type=\"car\" speed=\"{speed}\"/>\n"
                );
            }
        }
        text += "</timestep>\n";
    }
    fs::write(folder.join("fcd.xml"), text + "</fcd-export>\n").unwrap();
    fs::write(folder.join("net.xml"), NET).unwrap();
}

fn closecall(folder: &Path, words: &str) -> Output {
    let words = words.split(' ');
    Command::new(env!("CARGO_BIN_EXE_closecall")).args(words).current_dir(folder).output().unwrap()
}

fn replayed(more: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path());
    let done = closecall(folder.path(), &format!("replay fcd.xml --net net.xml --quiet --align never --out log{more}"));
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    folder
}

fn clips(folder: &Path) -> Vec<Value> {
    let mut text = String::new();
    let file = fs::File::open(folder.join("log/clips.jsonl.gz")).unwrap();
    GzDecoder::new(file).read_to_string(&mut text).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn a_clip_has_all_within_50_m_from_5_s_before_to_3_after() {
    let folder = replayed("");
    let [clip] = &clips(folder.path())[..] else { panic!() };
    let record = fs::read_to_string(folder.path().join("log/run.json")).unwrap();
    assert!(record.contains("\"clips\": 1,"), "{record}");
    let table = fs::read_to_string(folder.path().join("log/conflicts.csv")).unwrap();
    let mut rows = csv::Reader::from_reader(table.as_bytes());
    let place = rows.headers().unwrap().iter().position(|name| name == "time").unwrap();
    let row = rows.records().next().unwrap().unwrap();
    let worst = row[place].parse::<f64>().unwrap();
    let times = clip["times"].as_array().unwrap().iter().filter_map(Value::as_f64).collect::<Vec<_>>();
    assert!(
        (times[0] - (worst - 5.0)).abs() < 0.11 && (times[times.len() - 1] - (worst + 3.0)).abs() < 0.11,
        "{times:?}"
    );
    let users = clip["users"].as_array().unwrap();
    let ids = users.iter().map(|user| user["id"].as_str().unwrap()).collect::<Vec<_>>();
    assert_eq!((ids[0], ids[1]), (&row[1], &row[2]), "the ego, the foe");
    assert!(users.iter().all(|user| user["class"] == "passenger"));
    assert!(ids.contains(&"waits") && ids.contains(&"gone") && !ids.contains(&"far"), "{ids:?}");
    let x_of = |id: &str| {
        let user = users.iter().find(|user| user["id"] == id).unwrap();
        user["x"].as_array().unwrap().iter().map(Value::as_f64).collect::<Vec<_>>()
    };
    // The second has the place of the first in the roster.
    let (gone, new, east) = (x_of("gone"), x_of("new"), x_of("east\"&<"));
    for (place, time) in times.iter().enumerate() {
        assert_eq!(gone[place], (*time < 6.99).then_some(20.0), "at {time}");
        assert_eq!(new[place], (*time > 7.55).then_some(25.0), "at {time}");
        assert!((east[place].unwrap() + 14.0 * (10.0 - time)).abs() < 0.01, "at {time}");
    }
}

#[test]
fn a_clip_becomes_a_picture_that_moves_without_a_script() {
    let folder = replayed("");
    let done = closecall(folder.path(), "clip log --worst 1 -o conflict.svg --quiet");
    assert!(done.status.success() && done.stdout.is_empty(), "{}", String::from_utf8_lossy(&done.stderr));
    let text = fs::read_to_string(folder.path().join("conflict.svg")).unwrap();
    let mut reader = quick_xml::Reader::from_str(&text);
    let mut names = Vec::new();
    loop {
        match reader.read_event().unwrap() {
            quick_xml::events::Event::Eof => break,
            quick_xml::events::Event::Start(tag) | quick_xml::events::Event::Empty(tag) => {
                names.push(tag.name().as_ref().to_owned());
            }
            _ => {}
        }
    }
    assert!(names.iter().filter(|name| *name == "animateTransform").count() == 4, "{names:?}");
    assert!(!names.iter().any(|name| ["script", "foreignObject", "a", "image"].contains(&&**name)));
    assert!(!text.contains("href"), "nothing from outside");
}

#[test]
fn a_conflict_without_a_clip_says_how_to_get_one() {
    let refused = |more: &str, words: &str| {
        let folder = replayed(more);
        let done = closecall(folder.path(), words);
        let said = String::from_utf8(done.stderr).unwrap();
        assert_eq!((done.status.code(), said.lines().count()), (Some(2), 1), "{said}");
        assert!(!folder.path().join("clip.svg").exists());
        said
    };
    assert!(refused(" --log-clips none", "clip log 1").contains("has no clip: its run kept none"));
    assert!(refused("", "clip log 7").contains("log has no conflict 7"));
    assert!(refused("", "clip log --worst 2").contains("log has 1 conflict"));
    assert!(refused("", "clip log --worst 0").contains("--worst 0"));
    assert!(refused("", "clip log 1 -o film.gif").contains("film.gif: a clip is a .svg"));
    assert!(refused("", "clip log 1 -o film.mp4").contains("without Python"));
    assert!(refused("", "clip elsewhere 1").contains("elsewhere"));
    assert!(refused("", "show log 1").contains("without Python"));
}

#[test]
fn a_clip_file_that_is_damaged_is_named() {
    let folder = replayed("");
    let path = folder.path().join("log/clips.jsonl.gz");
    for text in [
        "{\"conflict\":1,\"times\":[]",
        "{\"conflict\":1,\"times\":[0],\"severity\":[null],\"time_left\":[],\"users\":[]}",
    ] {
        fs::write(&path, text).unwrap();
        let done = closecall(folder.path(), "clip log 1");
        let said = String::from_utf8(done.stderr).unwrap();
        assert!(said.starts_with("closecall: log/clips.jsonl.gz, line 1: "), "{said}");
    }
}
