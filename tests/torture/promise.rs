//! What must hold after a fault.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::Output;

use closecall_analysis::logged::{ConflictReader, LoggedRun};

use crate::{Fault, NO_FAULT};

/// Files that grow: rows that are there are right.
const ROWS: [&str; 2] = ["log/conflicts.csv", "log/series.csv"];
/// Files that are written whole or not at all.
const WHOLE: [&str; 6] = ["report.html", "stats.json", "ssm.xml", "all.trj", "clip.svg", "exported"];
/// What replaces the first of [`ROWS`] in a log in Parquet, whole: `run.json` is in it.
const PACKED: &str = "log/conflicts.parquet";
/// A file of the log that is written whole; a run that fails may have moved that of before aside.
const CLIPS: &str = "log/clips.jsonl.gz";
/// Where a second run keeps the log that it finds.
const EARLIER: &str = "log/earlier/1/conflicts.csv";

const SIGKILL: i32 = 9;
const SIGABRT: i32 = 6;
/// A fault of closecall itself (docs/log.md), and a panic.
const OWN_FAULTS: [i32; 2] = [70, 101];
/// A log that lacks rows (docs/log.md).
const LOST: i32 = 3;

/// The files of a folder, but for `run.json`, whose times differ between runs; and what the command printed.
#[derive(Default)]
pub struct Content {
    files: BTreeMap<&'static str, Vec<u8>>,
    printed: Vec<u8>,
    /// The conflicts in the log.
    conflicts: usize,
}

impl Content {
    pub fn of(folder: &Path) -> Self {
        let names = ROWS.into_iter().chain(WHOLE).chain([CLIPS, EARLIER]);
        let files = names.filter_map(|name| Some((name, fs::read(folder.join(name)).ok()?)));
        let conflicts = ConflictReader::open(&folder.join("log")).map_or(0, Iterator::count);
        Self { files: files.collect(), printed: Vec::new(), conflicts }
    }

    pub fn with_printed(self, printed: Vec<u8>) -> Self {
        Self { printed, ..self }
    }
}

/// What a command did that a fault disturbed.
pub struct Disturbed<'a> {
    pub words: &'a str,
    pub folder: &'a Path,
    pub fault: Fault,
    pub done: &'a Output,
    /// What the command found.
    pub before: &'a Content,
    /// What it makes of that where nothing fails.
    pub reference: &'a Content,
}

impl Disturbed<'_> {
    /// What is broken, if anything.
    pub fn check(&self) -> Result<(), String> {
        self.check_end()?;
        let after = Content::of(self.folder);
        self.check_files(&after)?;
        self.check_log(&after)?;
        let again = crate::closecall(self.words, self.folder, NO_FAULT);
        let same = |name: &&str| Content::of(self.folder).files.get(*name) == self.reference.files.get(*name);
        if !again.status.success() || !ROWS.iter().chain(&WHOLE).chain([&CLIPS]).all(same) {
            return Err(format!("the same command does not repair it: {}", String::from_utf8_lossy(&again.stderr)));
        }
        Ok(())
    }

    fn check_end(&self) -> Result<(), String> {
        let Output { status, stdout, stderr } = self.done;
        let said = String::from_utf8_lossy(stderr);
        let is_killed = match (status.code(), status.signal()) {
            (Some(code), _) if OWN_FAULTS.contains(&code) => return Err(format!("closecall itself failed: {said}")),
            (None, signal) if signal == Some(SIGKILL) || signal == Some(SIGABRT) && self.fault.name == "memory" => true,
            (None, signal) => return Err(format!("it crashed by signal {signal:?}: {said}")),
            _ => false,
        };
        let is_one_line = said.starts_with("closecall: ") && said.trim_end().lines().count() == 1;
        if !is_killed && !status.success() && !is_one_line {
            return Err(format!("it does not say in one line why it failed: {said}"));
        }
        let is_right = *stdout == self.reference.printed || stdout.is_empty() && !status.success();
        if is_right { Ok(()) } else { Err("it printed something else".to_owned()) }
    }

    fn check_files(&self, after: &Content) -> Result<(), String> {
        for name in ROWS.into_iter().chain(WHOLE).chain([CLIPS]) {
            let [found, before, wanted] = [after, self.before, self.reference].map(|content| content.files.get(name));
            let is_prefix = |found: &Vec<u8>| wanted.is_some_and(|wanted| wanted.starts_with(found));
            let is_right = found == wanted
                || !self.done.status.success()
                    && (found == before
                        || ROWS.contains(&name) && (wanted.is_none() || found.is_none_or(is_prefix))
                        || name == CLIPS && found.is_none());
            if !is_right {
                let length = |content: Option<&Vec<u8>>| content.map(Vec::len);
                let [found, before, wanted] = [found, before, wanted].map(length);
                return Err(format!("{name} has {found:?} bytes, before {before:?}, if undisturbed {wanted:?}"));
            }
        }
        let before = self.before.files.get(ROWS[0]);
        let is_kept = [EARLIER, ROWS[0]].iter().any(|name| after.files.get(name) == before);
        if self.words.contains("--force") || before.is_none() || is_kept {
            Ok(())
        } else {
            Err("the earlier log is lost".to_owned())
        }
    }

    /// All rows of the log can be read, and its statistics count them, unless they say that the run has no result.
    fn check_log(&self, after: &Content) -> Result<(), String> {
        let is_packed = self.folder.join(PACKED).exists();
        let rows = match after.files.get(ROWS[0]) {
            _ if is_packed => self.reference.conflicts,
            Some(text) => text.iter().filter(|sign| **sign == b'\n').count().saturating_sub(1),
            None => return Ok(()),
        };
        let log = self.folder.join("log");
        let has_record = is_packed || log.join("run.json").exists();
        let run = has_record.then(|| LoggedRun::read(&log)).transpose().map_err(|error| error.to_string())?;
        let is_complete = run.is_some_and(|run| run.complete);
        if rows > 0 {
            let read = ConflictReader::open(&log).and_then(Iterator::collect::<Result<Vec<_>, _>>);
            let read = read.map_err(|error| format!("its rows cannot be read: {error}"))?.len();
            if read != rows {
                return Err(format!("{read} conflicts are read from {rows} rows"));
            }
        }
        let stats = crate::closecall("stats log --format json", self.folder, NO_FAULT);
        let said = String::from_utf8_lossy(&stats.stderr);
        match stats.status.code() {
            Some(0) => {}
            Some(LOST) if !is_complete && !self.done.status.success() => {}
            Some(2) if !is_complete && said.trim_end().lines().count() == 1 => return Ok(()),
            _ => return Err(format!("no statistics of {rows} rows: {said}")),
        }
        let found = serde_json::from_slice::<serde_json::Value>(&stats.stdout).map_err(|error| error.to_string())?;
        let groups = found["groups"].as_array().into_iter().flatten();
        let counted = groups.filter(|group| group["group"] == "all").filter_map(|group| group["count"].as_u64());
        let counted = counted.sum::<u64>();
        if counted == rows as u64 { Ok(()) } else { Err(format!("{counted} conflicts are counted of {rows} rows")) }
    }
}
