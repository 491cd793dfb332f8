//! Regression tests on fixed nets: run each scenario, compare it with its blessed outcome, and report what changed.
//!
//! [`scenario`] → [`running`] (a process per scenario and seed) → [`outcome`] → [`exact`] or [`statistics`] → [`Report`],
//! printed by its `Display` and by [`junit`].

pub mod exact;
mod fingerprint;
pub mod joint_permutation;
pub mod junit;
mod matching;
pub mod outcome;
mod provenance;
mod report;
pub mod running;
pub mod scenario;
pub mod statistics;
mod verdict;

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::{Error, Result};
use joint_permutation::{fewest_seeds, smallest_p};
use outcome::{Outcome, SeedSummary};
use running::Job;
use statistics::comparisons;

pub use report::{Report, Verdict, summary};
pub use running::Runner;
pub use scenario::{Level, Scenario};
pub use verdict::Compared;

/// Runs the scenarios and compares each with its expected outcome, or blesses the new one.
///
/// The reports are in the order of the scenarios and do not depend on the number of processes.
///
/// # Errors
/// [`closecall_run::Error::Stopped`] if the user interrupted it, and [`Error::file`] if the temporary folder cannot be created. Errors of
/// a single scenario are in its report.
pub fn regress(scenarios: &[Scenario], runner: &mut Runner, bless: bool) -> Result<Vec<Report>> {
    let temporary = tempfile::Builder::new().prefix("closecall-regress-").tempdir();
    let temporary = temporary.map_err(|source| Error::file(&std::env::temp_dir(), source))?;
    let root = runner.out.clone().unwrap_or_else(|| temporary.path().to_owned());
    let mut jobs = Vec::new();
    for (number, scenario) in scenarios.iter().enumerate() {
        // Two scenarios may have the same name.
        let twin = scenarios[..number].iter().filter(|other| other.name == scenario.name).count();
        let name = if twin == 0 { scenario.name.clone() } else { format!("{}-{}", scenario.name, twin + 1) };
        for &seed in &scenario.settings.seeds {
            jobs.push(Job { scenario, number, seed, log: root.join(&name).join(format!("seed-{seed}")) });
        }
    }
    let mut failures = BTreeMap::new();
    for (job, result) in jobs.iter().zip(runner.run(&jobs)?) {
        if let Err(error) = result {
            failures.entry(job.number).or_insert((job.seed, error));
        }
    }
    let mut reports = Vec::new();
    for (number, scenario) in scenarios.iter().enumerate() {
        let verdict = match failures.remove(&number) {
            Some((seed, message)) => Err(Error::Seed(seed, message)),
            None => {
                let logs = jobs.iter().filter(|job| job.number == number).map(|job| (job.seed, job.log.clone()));
                judge(scenario, &logs.collect::<Vec<_>>(), bless)
            }
        };
        reports.push(Report::new(scenario, verdict));
    }
    Ok(reports)
}

fn judge(scenario: &Scenario, logs: &[(u32, PathBuf)], bless: bool) -> Result<Verdict> {
    let found = Outcome::collect(&scenario.folder, logs)?;
    let expected = match Outcome::read(&scenario.expected()) {
        // Blessing replaces an expected outcome that cannot be read.
        Err(_) if bless => None,
        read => read?,
    };
    let conflicts = found.summary.seeds.iter().map(SeedSummary::counted).sum();
    let Some(expected) = expected else {
        if !bless {
            return Err(Error::content(&scenario.expected(), "nothing is blessed yet; use --bless"));
        }
        found.write(&scenario.expected())?;
        return Ok(Verdict { blessed: true, conflicts, compared: None, changes: Vec::new() });
    };
    let compared = if bless {
        found.write(&scenario.expected())?;
        Compared::Exactly(exact::differences(&expected, &found))
    } else {
        compare(scenario, &expected, &found)?
    };
    let changes = provenance::changes(&expected.summary, &found.summary);
    Ok(Verdict { blessed: bless, conflicts, compared: Some(compared), changes })
}

/// Compares at the scenario's level, or by statistics if an exact comparison is impossible.
fn compare(scenario: &Scenario, expected: &Outcome, found: &Outcome) -> Result<Compared> {
    let differences = exact::differences(expected, found);
    let old = &expected.summary;
    let new = &found.summary;
    let instead = if old.sumo != new.sumo {
        Some(format!("{} instead of {}", new.sumo, old.sumo))
    } else if old.platform != new.platform {
        Some(format!("{} instead of {}", new.platform, old.platform))
    } else if expected.seeds() != found.seeds() {
        Some("different seeds from those blessed".to_owned())
    } else {
        None
    };
    let is_exact = scenario.settings.level == Level::Exact;
    // Equal bytes need no test.
    if differences.is_empty() || is_exact && instead.is_none() {
        return Ok(Compared::Exactly(differences));
    }
    let before = old.seeds.len();
    let now = new.seeds.len();
    let alpha = scenario.settings.false_alarm;
    if smallest_p(before, now) > alpha {
        let why = instead.map(|instead| format!("{instead}, and ")).unwrap_or_default();
        return Err(Error::Value(format!(
            "{why}{now} seeds against {before} blessed can never tell a difference at a false-alarm rate of {alpha}: \
             {} on both sides can",
            fewest_seeds(alpha)
        )));
    }
    Ok(Compared::Statistically(comparisons(expected, found, &scenario.settings), instead.filter(|_| is_exact)))
}
