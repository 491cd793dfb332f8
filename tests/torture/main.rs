//! Crash tests, as SQLite has them: closecall is killed, its disk fails or fills up, the power goes, or memory runs out, at
//! every operation on files in turn. Whatever happens, no number is wrong, no log is unreadable, and nothing is lost
//! beyond what docs/reliability.md says.
//!
//! `make torture` tries every fault, then random recordings, for ten minutes; a plain `cargo test` tries a sample.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may")]

mod promise;
mod subject;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use promise::{Content, Disturbed};
use rayon::prelude::*;
use subject::{Subject, subjects};

/// The faults of faults.c that happen at operations on files.
const ON_DISK: [&str; 6] = ["kill", "half", "error", "full", "room", "power"];
/// Allocations that fail, of each subject of a round: there are hundreds of thousands.
const ALLOCATIONS: usize = 40;

/// A fault at a moment.
#[derive(Clone, Copy, Debug)]
pub struct Fault {
    /// Its name in faults.c.
    pub name: &'static str,
    /// The number of the operation.
    pub at: u64,
}

/// Nothing fails.
pub const NO_FAULT: Fault = Fault { name: "none", at: 0 };

/// How often a command does what may fail.
#[derive(Clone, Copy, Debug)]
struct Counts {
    operations: u64,
    reads: u64,
    allocations: u64,
}

/// The command that is tested, with the faults preloaded.
pub fn closecall(words: &str, folder: &Path, fault: Fault) -> Output {
    static SHIM: LazyLock<PathBuf> = LazyLock::new(|| {
        let [source, shim] = [
            concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/torture/faults.c"),
            concat!(env!("CARGO_TARGET_TMPDIR"), "/faults.so"),
        ];
        let own = format!("{shim}.{}", std::process::id());
        let words = ["-O1", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", source, "-o", &own, "-ldl"];
        assert!(Command::new("cc").args(words).status().unwrap().success());
        std::fs::rename(own, shim).unwrap();
        shim.into()
    });
    Command::new(env!("CARGO_BIN_EXE_closecall"))
        .args(words.split(' '))
        .current_dir(folder)
        .env("LD_PRELOAD", &*SHIM)
        .env("FAULT", fault.name)
        .env("FAULT_AT", fault.at.to_string())
        .env("FAULT_IN", folder)
        .env("FAULT_LOG", folder.with_extension("counts"))
        .env("RUST_BACKTRACE", "0")
        .output()
        .unwrap()
}

/// The command without a fault, which must succeed.
pub fn undisturbed(words: &str, folder: &Path) -> Output {
    let done = closecall(words, folder, NO_FAULT);
    assert!(done.status.success(), "{words}: {done:?}");
    done
}

/// A subject with a recording of its own: what it writes where nothing fails, and how often it does what may fail.
struct Trial<'a> {
    subject: &'a Subject,
    recording: u64,
    reference: Content,
    counts: Counts,
}

impl<'a> Trial<'a> {
    fn new(subject: &'a Subject, recording: u64) -> Self {
        let (_kept, folder) = place(subject, recording);
        let done = undisturbed(&subject.words, &folder);
        let counts = std::fs::read_to_string(folder.with_extension("counts")).unwrap();
        let [operations, reads, allocations] =
            counts.split(' ').map(|count| count.parse().unwrap()).collect::<Vec<_>>()[..]
        else {
            panic!("{counts}");
        };
        let reference = Content::of(&folder).with_printed(done.stdout);
        Self { subject, recording, reference, counts: Counts { operations, reads, allocations } }
    }

    /// Every fault on disk, and some in memory.
    fn faults(&self) -> Vec<Fault> {
        let Counts { operations, reads, allocations } = self.counts;
        // After the last operation: what is forced to disk by then must be all.
        let on_disk = ON_DISK.iter().flat_map(|name| (1..=operations + 1).map(move |at| Fault { name, at }));
        let reading = (1..=reads).map(|at| Fault { name: "read", at });
        let mut random = fastrand::Rng::with_seed(self.recording);
        let memory = (0..ALLOCATIONS).map(|_| Fault { name: "memory", at: random.u64(1..=allocations) });
        on_disk.chain(reading).chain(memory).collect()
    }

    /// What does not hold after a fault, if anything.
    fn broken(&self, fault: Fault) -> Option<String> {
        let (_kept, folder) = place(self.subject, self.recording);
        let before = Content::of(&folder);
        let Subject { name, words, .. } = self.subject;
        let done = closecall(words, &folder, fault);
        let reference = &self.reference;
        let disturbed = Disturbed { words, folder: &folder, fault, done: &done, before: &before, reference };
        let broken = disturbed.check().err()?;
        Some(format!("{name}, recording {}, {} at {}: {broken}", self.recording, fault.name, fault.at))
    }
}

fn place(subject: &Subject, recording: u64) -> (tempfile::TempDir, PathBuf) {
    let kept = tempfile::tempdir().unwrap();
    let folder = kept.path().canonicalize().unwrap().join("here");
    std::fs::create_dir(&folder).unwrap();
    subject.prepare(&folder, recording);
    (kept, folder)
}

/// Tries the faults, each if it is to be tried once its turn comes; returns their names. None may break a promise.
fn try_all(trials: &[Trial], is_tried: impl Fn(usize) -> bool + Sync) -> Vec<&'static str> {
    let faults = trials.iter().flat_map(|trial| trial.faults().into_iter().map(move |fault| (trial, fault)));
    let faults = faults.enumerate().collect::<Vec<_>>();
    let tried = faults.par_iter().filter(|(place, _)| is_tried(*place));
    let tried = tried.map(|(_, (trial, fault))| (fault.name, trial.broken(*fault))).collect::<Vec<_>>();
    let broken = tried.iter().filter_map(|(_, broken)| broken.as_deref()).collect::<Vec<_>>();
    assert!(broken.is_empty(), "{} of {} faults:\n{}", broken.len(), tried.len(), broken.join("\n"));
    tried.iter().map(|(name, _)| *name).collect()
}

#[test]
fn a_sample_of_faults_makes_no_number_wrong_and_no_log_unreadable() {
    let subjects = subjects();
    let trials = subjects.par_iter().map(|subject| Trial::new(subject, 0)).collect::<Vec<_>>();
    let tried = try_all(&trials, |place| place % 23 == 0);
    for name in ON_DISK.iter().chain(&["read", "memory"]) {
        assert!(tried.contains(name), "{name}");
    }
}

#[test]
#[ignore = "takes ten minutes: make torture"]
fn no_fault_makes_a_number_wrong_or_a_log_unreadable() {
    let minutes = std::env::var("MINUTES").map_or(10, |minutes| minutes.parse().unwrap());
    let end = Instant::now() + Duration::from_secs(60 * minutes);
    let mut tried = std::collections::BTreeMap::<&str, usize>::new();
    let subjects = subjects();
    for recording in 0.. {
        let trials = subjects.par_iter().map(|subject| Trial::new(subject, recording)).collect::<Vec<_>>();
        try_all(&trials, |_| Instant::now() < end).into_iter().for_each(|name| *tried.entry(name).or_default() += 1);
        if Instant::now() > end {
            println!("{} recordings, {} faults, all held: {tried:?}", recording + 1, tried.values().sum::<usize>());
            return;
        }
    }
}
