//! The result of a scenario for people: one line, and the differences below it.

use std::fmt;

use super::exact::Differences;
use super::scenario::{Level, Scenario};
use super::verdict::Compared;
use crate::{Error, Result};
use closecall::util::units::counted;

/// The number of differences of one sort that are shown.
const SHOWN: usize = 10;

/// The result of a scenario.
#[derive(Debug)]
pub struct Report {
    /// The scenario's name.
    pub name: String,
    /// The level of the comparison.
    pub level: Level,
    /// The seeds of its runs.
    pub seeds: Vec<u32>,
    /// The verdict, or why it could not be run.
    pub verdict: Result<Verdict>,
    /// Whether to show every difference.
    pub shows_all: bool,
}

/// The comparison of a scenario's runs with its expected outcome.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Whether this outcome has become the expected one.
    pub blessed: bool,
    /// The number of conflicts over all seeds; without those that are set aside.
    pub conflicts: u64,
    /// The differences; none if nothing was expected yet.
    pub compared: Option<Compared>,
    /// Changes in versions, options and input files.
    pub changes: Vec<String>,
}

impl Verdict {
    /// Whether it is as expected, or has just been blessed.
    pub fn passes(&self) -> bool {
        self.blessed || self.compared.as_ref().is_some_and(Compared::is_same)
    }
}

impl Report {
    pub(super) fn new(scenario: &Scenario, verdict: Result<Verdict>) -> Self {
        let name = scenario.name.clone();
        let settings = &scenario.settings;
        Self { name, level: settings.level, seeds: settings.seeds.clone(), verdict, shows_all: false }
    }

    /// The report of a folder whose scenario cannot be run.
    pub fn unreadable(name: String, level: Level, error: Error) -> Self {
        Self { name, level, seeds: Vec::new(), verdict: Err(error), shows_all: false }
    }

    /// The exit status of this scenario alone: 0 as expected, 1 different, 2 could not be run.
    pub fn exit_status(&self) -> u8 {
        match &self.verdict {
            Ok(verdict) => u8::from(!verdict.passes()),
            Err(_) => 2,
        }
    }

    /// One word: `pass`, `FAIL`, `ERROR` or `blessed`.
    pub fn word(&self) -> &'static str {
        match &self.verdict {
            Ok(verdict) if verdict.blessed => "blessed",
            Ok(verdict) if verdict.passes() => "pass",
            Ok(_) => "FAIL",
            Err(_) => "ERROR",
        }
    }

    /// The result in one line.
    pub(crate) fn headline(&self) -> String {
        let verdict = match &self.verdict {
            Ok(verdict) => verdict,
            Err(error) => return error.to_string(),
        };
        let seeds = if self.seeds.len() == 1 { "1 seed".to_owned() } else { format!("{} seeds", self.seeds.len()) };
        let found = format!("{seeds}, {} conflicts", verdict.conflicts);
        match &verdict.compared {
            None => format!("{found}: nothing was expected yet"),
            Some(Compared::Exactly(differences)) if differences.is_empty() => {
                format!("{found}: byte for byte the same")
            }
            Some(Compared::Exactly(differences)) => format!("{found}: {}", differences.counts()),
            Some(Compared::Statistically(comparisons, instead)) => {
                let count = comparisons.iter().filter(|comparison| comparison.differs).count();
                let how = match instead {
                    Some(instead) => format!("compared by statistics, not exactly ({instead})"),
                    None => "compared by statistics".to_owned(),
                };
                format!("{found}, {how}: {count} of {} measures differ", comparisons.len())
            }
        }
    }

    /// The differences, one line each.
    pub(crate) fn details(&self) -> Vec<String> {
        let Ok(verdict) = &self.verdict else { return Vec::new() };
        let mut lines = Vec::new();
        if !verdict.changes.is_empty() {
            lines.extend(self.shown("changed since blessed: ", &verdict.changes));
        }
        match &verdict.compared {
            Some(Compared::Exactly(Differences { new, gone, changed, other })) => {
                lines.extend(self.shown("", other));
                lines.extend(self.shown("new: ", new));
                lines.extend(self.shown("gone: ", gone));
                lines.extend(self.shown("changed: ", changed));
            }
            Some(Compared::Statistically(comparisons, _)) => {
                let differing = comparisons.iter().filter(|comparison| comparison.differs);
                lines.extend(self.shown("", &differing.map(ToString::to_string).collect::<Vec<_>>()));
            }
            None => {}
        }
        if !verdict.passes() && verdict.changes.is_empty() {
            lines.push("versions, options and input files are those blessed".to_owned());
        }
        lines
    }

    fn shown(&self, sort: &str, lines: &[String]) -> Vec<String> {
        let count = if self.shows_all { lines.len() } else { SHOWN };
        let mut shown = lines.iter().take(count).map(|line| format!("{sort}{line}")).collect::<Vec<_>>();
        if lines.len() > count {
            shown.push(format!("{sort}… and {} more (--all shows them)", lines.len() - count));
        }
        shown
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "{:<7} {} ({}): {}", self.word(), self.name, self.level, self.headline())?;
        for line in self.details() {
            writeln!(f, "        {line}")?;
        }
        Ok(())
    }
}

/// All reports in one line.
pub fn summary(reports: &[Report]) -> String {
    let count = |word: &str| reports.iter().filter(|report| report.word() == word).count();
    let words = ["pass", "blessed", "FAIL", "ERROR"].map(|word| (count(word), word));
    let told = words.iter().filter(|(count, _)| *count > 0).map(|(count, word)| format!("{count} {word}"));
    format!("{}: {}", counted(reports.len() as u64, "scenario"), told.collect::<Vec<_>>().join(", "))
}
