//! The command itself, as a user types it: usage, where logs go, statistics of runs that differ.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;

/// Runs closecall with these words in a folder.
fn closecall(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_closecall")).args(words).current_dir(folder).output().unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// A recording of a car that comes too close to another, in a file of its own folder.
fn record(folder: &Path) {
    fs::create_dir_all(folder).unwrap();
    let mut text = "<fcd-export>\n".to_owned();
    for step in 0..40 {
        let time = f64::from(step) / 10.0;
        text += &format!("<timestep time=\"{time}\">\n");
        for (id, from, speed) in [("follower", 78.0, 30.0), ("leader", 200.0, 10.0)] {
            let x = from + speed * time;
            text += &format!(
                "<vehicle id=\"{id}\" x=\"{x}\" y=\"0\" angle=\"90\" type=\"car\" speed=\"{speed}\" pos=\"{x}\" \
                 lane=\"road_0\"/>\n"
            );
        }
        text += "</timestep>\n";
    }
    fs::write(folder.join("fcd.xml"), text + "</fcd-export>\n").unwrap();
    let net = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../sumo_nets/rear_end/rear_end.net.xml");
    fs::copy(net, folder.join("net.xml")).unwrap();
}

/// The words that replay the recording in the folder `recorded`, with more.
fn replay<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&["replay", "recorded/fcd.xml", "--net", "recorded/net.xml"], more].concat()
}

#[test]
fn without_words_the_command_prints_its_help() {
    let folder = tempfile::tempdir().unwrap();
    let done = closecall(folder.path(), &[]);
    let said = stderr(&done);
    assert_eq!((done.status.code(), stdout(&done).as_str()), (Some(2), ""));
    assert!(said.contains("\nUsage: closecall <COMMAND>\n") && said.contains("\n  replay "), "{said}");
    let asked = closecall(folder.path(), &["--help"]);
    assert_eq!((asked.status.code(), stdout(&asked)), (Some(0), said));
}

#[test]
fn a_wrong_word_gets_clap_s_message_with_the_usage() {
    let folder = tempfile::tempdir().unwrap();
    let done = closecall(folder.path(), &["stats", "--modus", "x"]);
    let said = stderr(&done);
    assert_eq!(done.status.code(), Some(2));
    assert!(said.starts_with("closecall: unexpected argument '--modus' found\n"), "{said}");
    assert!(said.contains("\nUsage: closecall stats "), "{said}");
    assert!(said.ends_with("\nFor more information, try '--help'.\n"), "{said}");
}

#[test]
fn a_value_of_two_words_has_both_spellings() {
    let folder = tempfile::tempdir().unwrap();
    record(&folder.path().join("recorded"));
    for (out, words) in [("a", ["--mu", "at-rest"]), ("b", ["--mu", "at_rest"]), ("c", ["--config", "c.toml"])] {
        fs::write(folder.path().join("c.toml"), "mu = \"at_rest\"\n").unwrap();
        let done = closecall(folder.path(), &replay(&["--out", out, words[0], words[1]]));
        assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
        let run = fs::read_to_string(folder.path().join(out).join("run.json")).unwrap();
        assert!(run.contains("\"mu\": \"at-rest\""), "{run}");
    }
}

#[test]
fn an_earlier_log_is_kept_unless_it_is_to_be_replaced() {
    let folder = tempfile::tempdir().unwrap();
    record(&folder.path().join("recorded"));
    let log = |path: &str| fs::read_to_string(folder.path().join(path).join("conflicts.csv")).ok();
    let said = |more: &[&str]| {
        let done = closecall(folder.path(), &replay(more));
        assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
        stdout(&done)
    };
    assert!(!said(&[]).contains("earlier"));
    let first = log("recorded/closecall-out").unwrap();
    assert_eq!(first.lines().count(), 2);
    let kept = said(&["--epsilon", "0"]);
    assert!(kept.contains("\nthe earlier log is kept in recorded/closecall-out/earlier/1\n"), "{kept}");
    assert_eq!(log("recorded/closecall-out/earlier/1").as_ref(), Some(&first));
    assert_ne!(log("recorded/closecall-out").as_ref(), Some(&first));
    assert!(!said(&["--force"]).contains("earlier"));
    assert_eq!(log("recorded/closecall-out").as_ref(), Some(&first));
    assert_eq!(log("recorded/closecall-out/earlier/2"), None);
}

#[test]
fn an_earlier_log_is_where_it_was_if_no_new_one_can_begin() {
    let folder = tempfile::tempdir().unwrap();
    record(&folder.path().join("recorded"));
    assert_eq!(closecall(folder.path(), &replay(&["--out", "out"])).status.code(), Some(0));
    let log = || ["conflicts.csv", "run.json"].map(|name| fs::read(folder.path().join("out").join(name)).unwrap());
    let first = log();
    fs::create_dir(folder.path().join("out/series.csv")).unwrap();
    let done = closecall(folder.path(), &replay(&["--out", "out", "--log-series"]));
    assert_eq!(done.status.code(), Some(2), "{}", stdout(&done));
    assert!(stderr(&done).starts_with("closecall: out/series.csv: "), "{}", stderr(&done));
    assert_eq!(log(), first);
    assert!(!folder.path().join("out/earlier").exists());
}

#[test]
fn a_series_in_parquet_equals_the_one_in_csv() {
    let folder = tempfile::tempdir().unwrap();
    record(&folder.path().join("recorded"));
    for (out, series) in [("csv", "--log-series"), ("parquet", "--log-series=parquet")] {
        let done = closecall(folder.path(), &replay(&["--out", out, "--measures", "all", series]));
        assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    }
    assert!(!folder.path().join("parquet/series.csv").exists());
    let text = fs::read_to_string(folder.path().join("csv/series.csv")).unwrap();
    let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    let names = cells(text.lines().next().unwrap());
    let file = fs::File::open(folder.path().join("parquet/series.parquet")).unwrap();
    let read = SerializedFileReader::new(file).unwrap();
    let mut rows = 0;
    for (line, row) in text.lines().skip(1).zip(read.get_row_iter(None).unwrap()) {
        let row = row.unwrap();
        assert!(names.iter().eq(row.get_column_iter().map(|(name, _)| name)));
        for (cell, (name, value)) in cells(line).iter().zip(row.get_column_iter()) {
            let same = match value {
                Field::Null => cell.is_empty(),
                // The text has six decimals.
                Field::Double(number) => (cell.parse::<f64>().unwrap() - number).abs() < 5.01e-7,
                Field::Long(count) => cell.parse() == Ok(*count),
                Field::Bool(flag) => cell.parse() == Ok(*flag),
                Field::Str(text) => cell == text,
                _ => false,
            };
            assert!(same, "{name}: {cell} and {value}");
        }
        rows += 1;
    }
    assert!(rows > 10 && rows == text.lines().count() - 1, "{rows}");
}

#[test]
fn a_folder_that_another_run_writes_to_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    record(&folder.path().join("recorded"));
    let other = closecall_run::LogFolder::claim(&folder.path().join("out")).unwrap();
    let done = closecall(folder.path(), &replay(&["--out", "out"]));
    assert_eq!((done.status.code(), stdout(&done).as_str()), (Some(2), ""));
    let told = format!("closecall: out: another run writes its log there (process {}, begun ", std::process::id());
    assert!(stderr(&done).starts_with(&told), "{}", stderr(&done));
    drop(other);
    assert_eq!(closecall(folder.path(), &replay(&["--out", "out"])).status.code(), Some(0));
}

#[test]
fn a_new_folder_is_made_where_it_is_wanted() {
    let folder = tempfile::tempdir().unwrap();
    record(&folder.path().join("recorded"));
    for number in 1..=2 {
        let done = closecall(folder.path(), &replay(&["--out", "auto"]));
        let made = format!("recorded/closecall-out-{number}");
        assert!(stdout(&done).contains(&made), "{}{}", stdout(&done), stderr(&done));
        assert!(folder.path().join(made).join("conflicts.csv").is_file());
    }
    assert!(!folder.path().join("auto").exists());
}

#[test]
fn the_default_folder_is_here_where_it_cannot_be_there() {
    let folder = tempfile::tempdir().unwrap();
    record(&folder.path().join("recorded"));
    // Even root cannot make a folder where a file is.
    fs::write(folder.path().join("recorded/closecall-out"), "").unwrap();
    let done = closecall(folder.path(), &replay(&[]));
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    let said = stdout(&done);
    assert!(said.contains("recorded/closecall-out cannot be written, so the results are in the working directory\n"));
    assert!(said.contains("log in closecall-out;"), "{said}");
    assert!(folder.path().join("closecall-out/conflicts.csv").is_file());
}

#[test]
fn an_output_makes_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    record(&folder.path().join("recorded"));
    let done = closecall(folder.path(), &replay(&["--trj-output", "x/y/t.trj", "--ssm-output", "z/ssm.xml"]));
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    assert!(folder.path().join("x/y/t.trj").is_file() && folder.path().join("z/ssm.xml").is_file());
}

#[test]
fn runs_that_differ_in_an_option_have_rates_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    record(&folder.path().join("recorded"));
    for epsilon in ["0.5", "0.25"] {
        for out in ["a", "b"] {
            let out = format!("runs/{epsilon}/{out}");
            let done = closecall(folder.path(), &replay(&["--quiet", "--epsilon", epsilon, "--out", &out]));
            assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
        }
    }
    let done = closecall(folder.path(), &["stats", "runs", "--format", "json"]);
    let found: serde_json::Value = serde_json::from_str(&stdout(&done)).unwrap();
    assert_eq!((found["runs"].as_u64(), &found["varied"]), (Some(2), &serde_json::json!(["epsilon"])));
    let names = found["variants"].as_array().unwrap().iter().map(|variant| variant["name"].as_str().unwrap());
    assert_eq!(names.collect::<Vec<_>>(), ["epsilon=0.25", "epsilon=0.5"]);
    // Each repeats another.
    assert_eq!(stderr(&done).matches("left out: it repeats runs/").count(), 2, "{}", stderr(&done));
    // 40 steps of 0.1 s with one conflict.
    for group in found["groups"].as_array().unwrap().iter().filter(|group| group["group"] == "all") {
        let rate = group["per_hour"]["value"].as_f64().unwrap();
        assert!((rate - 3600.0 / 4.0).abs() < 1e-6, "{rate}");
    }
    let refused = closecall(folder.path(), &["stats", "runs", "--against", "runs/0.5"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).ends_with("runs: the runs differ in epsilon: for --against name those of one variant\n"));
}

#[test]
fn an_old_name_is_accepted_and_said_once() {
    let folder = tempfile::tempdir().unwrap();
    record(&folder.path().join("recorded"));
    fs::write(folder.path().join("new.toml"), "no_shortcuts = true\nseverity_rule = \"fhwa\"\n").unwrap();
    fs::write(folder.path().join("old.toml"), "keep_all = true\nseverity = \"fhwa\"\n").unwrap();
    let options = |out: &str, more: &[&str]| {
        let done = closecall(folder.path(), &replay(&[&["--out", out], more].concat()));
        assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
        let run = fs::read_to_string(folder.path().join(out).join("run.json")).unwrap();
        let run: serde_json::Value = serde_json::from_str(&run).unwrap();
        (run["options"].clone(), stderr(&done).lines().filter(|line| line.contains(" is now ")).collect::<String>())
    };
    let (present, said) = options("a", &["--config", "new.toml"]);
    assert_eq!((present["keep_all"].as_bool(), said.as_str()), (Some(true), ""));
    let words = ["--keep-all", "--severity=fhwa", "--severity", "fhwa"];
    let (of_words, said) = options("b", &words);
    assert_eq!(of_words, present);
    let line = |old: &str, new: &str| format!("closecall: {old} is now {new}; the old name still works");
    assert_eq!(said, line("--keep-all", "--no-shortcuts") + &line("--severity", "--severity-rule"));
    let (of_file, said) = options("c", &["--config", "old.toml"]);
    assert_eq!(of_file, present);
    let of = |number, old, new| line(&format!("old.toml, line {number}: {old}"), new);
    assert_eq!(said, of(1, "keep_all", "no_shortcuts") + &of(2, "severity", "severity_rule"));
    assert_eq!(options("d", &[&words[..], &["--quiet"]].concat()).1, "");
}

#[test]
fn help_has_its_options_in_groups() {
    let folder = tempfile::tempdir().unwrap();
    let checks = ["Run", "Model", "Severity", "Log", "Output"];
    let replays = ["Run", "Recording", "Model", "Severity", "Log", "Output"];
    let filter = "Filter: which conflicts count (several values: a,b)";
    for (command, groups) in [
        ("run", &checks[..]),
        ("sweep", &checks),
        ("study", &checks),
        ("replay", &replays),
        ("stats", &["Output", "Comparison", filter]),
    ] {
        let help = stdout(&closecall(folder.path(), &[command, "--help"]));
        let found = help.lines().filter_map(|line| line.strip_suffix(':')).filter(|line| !line.starts_with(' '));
        let found = found.collect::<Vec<_>>();
        assert_eq!(found, [&["Arguments", "Options"], groups].concat(), "{help}");
    }
    let sweep = stdout(&closecall(folder.path(), &["sweep", "-h"]));
    let default = |option: &str| sweep.lines().find(|line| line.contains(option)).unwrap().to_owned();
    assert!(default("--threads <N>").ends_with(" at most, SUMO's own included [default: 1]"), "{sweep}");
    assert!(default("--log-clips <SEVERITY>").contains("[default: none]"), "{sweep}");
}
