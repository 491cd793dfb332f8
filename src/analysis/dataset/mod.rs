//! The conflicts of several logs, with the net under them: what a page or a picture is made of.

mod logs;
pub(crate) mod nets;
pub(crate) mod rows;

use std::path::{Path, PathBuf};

use logs as log_files;
use serde_json::Value;

use super::logged::log_folders;
use crate::Result;
use crate::detection::kind::{Kind, Severity};
use crate::geometry::Point;
use crate::options::Options;
use crate::traffic::net::Net;
use crate::util::units::Second;
use nets::Ground;
use rows::{NUMBERS, Row, Worst};

/// The conflicts of several logs; of very many the worst (300,000).
#[derive(Debug)]
pub struct Conflicts {
    /// The folders of the logs.
    pub(super) logs: Vec<PathBuf>,
    /// Their `run.json`; null where there is none.
    pub(super) records: Vec<Value>,
    /// The net, and what there is to say about it.
    pub(super) ground: Ground,
    /// The conflicts, worst first.
    pub(super) rows: Vec<Row>,
    /// How many there are in the logs.
    pub(super) seen: u64,
}

/// Reads the logs in `folders`, each a log itself or a folder of logs; the net from `net`, or from where the first log
/// says it was.
///
/// # Errors
/// [`crate::Error::File`] where a folder cannot be read, [`crate::Error::Content`] where a folder holds no log,
/// [`crate::Error::Line`] where a row of `conflicts.csv` is not as `docs/log.md` has it.
pub fn read(folders: &[PathBuf], net: Option<&Path>) -> Result<Conflicts> {
    let logs = log_folders(folders)?;
    let mut worst = Worst::default();
    for (run, log) in (0..).zip(&logs) {
        log_files::rows(log, |mut row| {
            row.run = run;
            worst.push(row);
        })?;
    }
    let records = logs.iter().map(|log| log_files::record(log)).collect::<Result<Vec<_>>>()?;
    let mut ground = nets::find(net, &logs, &records)?;
    // As it is written when a run begins; null where there is none at all.
    let without = records.iter().filter(|record| record["summary"]["steps"].as_u64().is_none_or(|steps| steps == 0));
    let without = without.count();
    if without > 0 {
        ground.notes.push(format!(
            "{without} of {} runs have no result, killed or not at their end yet: their conflicts count, their traffic is \
             not known.",
            logs.len()
        ));
    }
    let seen = worst.seen();
    Ok(Conflicts { logs, records, ground, rows: worst.into_rows(), seen })
}

impl Conflicts {
    /// The net; none where it is gone.
    pub fn net(&self) -> Option<&Net> {
        self.ground.net.as_ref()
    }

    /// Kind, severity and meeting place of each.
    pub fn places(&self) -> impl Iterator<Item = (Kind, Severity, Point)> {
        let (x, y) = (column("x"), column("y"));
        self.rows.iter().filter_map(move |row| {
            Some((Kind::ALL[usize::from(row.kind)], severity(row), Point::new(row.number(x)?, row.number(y)?)))
        })
    }

    /// The values of a number column of `conflicts.csv`, where there is one, each with the conflict's severity.
    pub fn numbers(&self, name: &str) -> impl Iterator<Item = (Severity, f64)> {
        let place = column(name);
        self.rows.iter().filter_map(move |row| Some((severity(row), row.number(place)?)))
    }

    /// First and last second of all runs.
    pub fn period(&self) -> (Second, Second) {
        let of_run = |key| self.records.iter().filter_map(move |record| record.get("summary")?.get(key)?.as_f64());
        let times = self.numbers("time").map(|(_, time)| time).chain(of_run("begin")).chain(of_run("end"));
        let (begin, end) = times.fold((f64::INFINITY, 0.0), |(begin, end), time| (time.min(begin), time.max(end)));
        (begin.min(end), end)
    }

    /// From where on a measure makes a conflict serious, by the first run's options; none where it does not.
    pub fn threshold(&self, name: &str) -> Option<f64> {
        let options = Options::default();
        let (key, default) = match name {
            "ttc" => ("serious_ttc", options.serious_ttc),
            "drac" => ("serious_drac", options.serious_drac),
            _ => return None,
        };
        let set = self.records.iter().find_map(|record| record.get("options")?.get(key)?.as_f64());
        Some(set.unwrap_or(default)).filter(|threshold| *threshold > 0.0)
    }
}

fn severity(row: &Row) -> Severity {
    Severity::ALL[usize::from(row.severity)]
}

fn column(name: &str) -> usize {
    NUMBERS.iter().position(|(known, _)| *known == name).unwrap_or(NUMBERS.len())
}
