//! Which runs of a set count: those with a result, each once.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rustc_hash::FxHashMap;
use serde::Serialize;

use super::together::in_order;
use crate::logged::LoggedRun;
use crate::variants::{Variants, repeated};
use crate::{Error, Result};

/// A log that is not counted or needs a warning, and why.
#[derive(Clone, Debug, Serialize)]
pub struct LeftOutLog {
    /// The log folder.
    pub folder: PathBuf,
    /// Why.
    pub why: String,
}

/// The runs that count.
pub(crate) struct Chosen {
    /// The log folder and the record of each.
    pub runs: Vec<(Arc<Path>, LoggedRun)>,
    /// Their variants.
    pub variants: Variants,
    /// The logs that do not count, or need a warning.
    pub left_out: Vec<LeftOutLog>,
}

/// Chooses among the runs in these log folders.
///
/// # Errors
/// Those of [`LoggedRun::read`], and [`Error::content`] if none of them has a result.
pub fn choose(folders: &[PathBuf]) -> Result<Chosen> {
    let mut runs = Vec::with_capacity(folders.len());
    let mut left_out = Vec::new();
    let read = |number: usize, _: &mut dyn FnMut(())| LoggedRun::read(&folders[number]);
    let take = |number: usize, run: Result<LoggedRun>| {
        let (run, folder) = (run?, &folders[number]);
        if run.summary.steps == 0 {
            let why = "the run has no result: it was killed, or is still running".to_owned();
            left_out.push(LeftOutLog { folder: folder.clone(), why });
        } else {
            runs.push((Arc::from(folder.as_path()), run));
        }
        Ok(())
    };
    in_order(folders.len(), read, take, |()| ())?;
    if let (true, Some(LeftOutLog { folder, why })) = (runs.is_empty(), left_out.first()) {
        return Err(Error::content(folder, why.clone()));
    }
    let mut variants = Variants::of(&records(&runs));
    let counts = without_repetitions(&runs, &variants, &mut left_out);
    if counts.contains(&false) {
        let mut counts = counts.into_iter();
        runs.retain(|_| counts.next().unwrap_or(true));
        variants = Variants::of(&records(&runs));
    }
    for (folder, _) in runs.iter().filter(|(_, run)| !run.complete) {
        let why = "counted in part: the run did not reach its end".to_owned();
        left_out.push(LeftOutLog { folder: folder.to_path_buf(), why });
    }
    Ok(Chosen { runs, variants, left_out })
}

fn records(runs: &[(Arc<Path>, LoggedRun)]) -> Vec<&LoggedRun> {
    runs.iter().map(|(_, run)| run).collect()
}

/// Whether each run counts. A run that repeats another's settings and seed does not: it found the same.
fn without_repetitions(
    runs: &[(Arc<Path>, LoggedRun)],
    variants: &Variants,
    left_out: &mut Vec<LeftOutLog>,
) -> Vec<bool> {
    let mut counts = vec![true; runs.len()];
    for variant in &variants.all {
        let mut known = FxHashMap::<String, usize>::default();
        for &run in &variant.runs {
            let Some(repetition) = repeated(&runs[run].1) else { continue };
            let Some(before) = known.insert(repetition.clone(), run) else { continue };
            let [(first, one), (second, other)] = [&runs[before], &runs[run]];
            let (out, of, why) = match (one.complete, other.complete) {
                (true, false) => (run, first, "left out: it did not reach its end, and is repeated by"),
                (false, true) => (before, second, "left out: it did not reach its end, and is repeated by"),
                _ if one.summary == other.summary => (run, first, "left out: it repeats"),
                _ => {
                    let what = "same settings and seed, but another result: what differs is not recorded";
                    let why = format!("counted, but compare {}: {what}", first.display());
                    left_out.push(LeftOutLog { folder: second.to_path_buf(), why });
                    continue;
                }
            };
            counts[out] = false;
            left_out.push(LeftOutLog { folder: runs[out].0.to_path_buf(), why: format!("{why} {}", of.display()) });
            known.insert(repetition, if out == run { before } else { run });
        }
    }
    counts
}
