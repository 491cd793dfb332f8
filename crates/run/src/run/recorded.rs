//! The life cycle of a run with a log: open, step by step, close.
//!
//! `run.json` is written twice: incomplete when the run opens, so that a killed run is recognised as one, and with the
//! summary when it closes.

use std::path::Path;

use super::Run;
use super::writing::Writing;
use crate::output::earlier_log::EarlierLog;
use crate::output::folder::LogFolder;
use crate::output::formats::{OutputFiles, Outputs};
use crate::output::input_hash::Input;
use crate::output::log::{self, Log};
use crate::output::net_faults_csv;
use crate::output::record::RunRecord;
use crate::output::summary::Summary;
use crate::util::output_file::same_file;
use crate::util::panics;
use crate::{Error, Result};
use closecall::detection::detector::LeftOut;
use closecall::util::remark::{Remark, RemarkCode};

/// A run and the record of how it was made.
pub struct RecordedRun {
    /// The run to be stepped.
    pub run: Run,
    /// None without a log.
    record: Option<Box<RunRecord>>,
    earlier: Option<EarlierLog>,
    /// No other run writes to the log's folder.
    folder: Option<LogFolder>,
    /// The process that writes the log.
    process: u32,
}

/// How a run ended, and what its source adds to the summary.
#[derive(Debug, Default)]
pub struct Ending {
    /// Why the run did not reach its end; none where it did.
    pub error: Option<String>,
    /// What the source skipped.
    pub left_out: Vec<LeftOut>,
    /// Its remarks on the scenario or the recording.
    pub remarks: Vec<Remark>,
    /// Each part of the work and the seconds it took.
    pub spent: Vec<(&'static str, f64)>,
}

impl RecordedRun {
    /// Opens the log in a folder and the other files; from here on the run writes to them. An earlier log in the folder is
    /// kept, unless it is to be replaced.
    ///
    /// # Errors
    /// [`crate::Error::File`] that names what cannot be written, [`crate::Error::Value`] where the log would be written over
    /// an input, and the errors of `Outputs::create`.
    pub fn open(mut run: Run, record: RunRecord, folder: LogFolder, files: &OutputFiles) -> Result<Self> {
        let path = folder.path();
        check_keeps_inputs(path, &record.inputs)?;
        let outputs = Outputs::create(files, run.net(), &record.inputs, record.options.model.artefacts)?;
        let earlier = if files.force { None } else { EarlierLog::keep(path)? };
        let mut record = RunRecord { csv_safe: files.csv_safe, ..record };
        record.summary.remarks = run.opening_remarks(record.step_length);
        match begin_log(path, &record) {
            Ok(log) => run.set_log(log, record.options.log.log_clips),
            Err(error) => {
                earlier.into_iter().for_each(EarlierLog::restore);
                return Err(error);
            }
        }
        run.set_outputs(outputs);
        if let Some(length) = record.step_length {
            run.set_step_length(length);
        }
        Ok(Self { run, record: Some(Box::new(record)), earlier, folder: Some(folder), process: std::process::id() })
    }

    /// A run without a log, whose conflicts stay in memory.
    pub fn in_memory(run: Run) -> Self {
        Self { run, record: None, earlier: None, folder: None, process: std::process::id() }
    }

    /// Where the earlier log of the folder is now, if there was one, in a line for the user.
    pub fn earlier_log(&self) -> Option<Remark> {
        self.earlier.as_ref().map(|earlier| {
            let text = format!("the earlier log is kept in {}", earlier.kept.display());
            Remark::new(RemarkCode::EarlierLog, text)
        })
    }

    /// Leaves the log and the other files to the process that opened them, if this one is a copy that was forked from it:
    /// both would otherwise write what is in their buffers, release the folder and complete `run.json`.
    pub fn leave_if_forked(&mut self) {
        if self.process == std::process::id() {
            return;
        }
        self.process = std::process::id();
        let Writing { log, outputs, error } = std::mem::take(&mut self.run.writing);
        let had_log = self.record.take().is_some();
        let left = "this process is a fork: the one that opened the log writes it".to_owned();
        self.run.writing.error = error.or(had_log.then_some(left));
        // What is dropped would be written, released or removed.
        std::mem::forget((log, outputs, self.folder.take(), self.earlier.take()));
    }

    /// Closes the open conflicts and completes the log; returns the summary.
    ///
    /// # Errors
    /// [`crate::Error::File`] that names what cannot be written; `run.json` then says so too, if it can be written itself.
    pub fn close(&mut self, ending: Ending) -> Result<Summary> {
        self.leave_if_forked();
        let Ending { error, left_out, remarks, spent } = ending;
        let finished = self.run.finish();
        let error = self.run.log_error().map(str::to_owned).or(error);
        let (faults, road_users) = self.run.net_faults();
        let log = self.run.writing.log.as_ref();
        let faults_written = log.map_or(Ok(()), |log| log.write_net_faults(&faults));
        let said = net_faults_csv::in_words(&faults, road_users, log.map(Log::folder));
        // `run.json` has one remark for both lines, which names no place that may change.
        let lines = net_faults_csv::in_words(&faults, road_users, None);
        let faults = lines.into_iter().reduce(|one, other| Remark { text: format!("{one}; {other}"), ..one });
        let mut summary = self.run.summary.clone();
        summary.left_out.extend(left_out);
        summary.spent = spent;
        // What is known before the first step is asked for where there is a log: it takes time with a large net.
        let opening =
            self.record.as_ref().map(|_| self.run.opening_remarks(self.run.step_length())).unwrap_or_default();
        let mut recorded_summary = summary.clone();
        recorded_summary.remarks = [opening, summary.remarks.clone(), Vec::from_iter(faults), remarks.clone()].concat();
        summary.remarks.extend(said.into_iter().chain(remarks).chain(self.earlier_log()));
        self.run.summary.clone_from(&summary);
        let recorded = match (self.run.writing.log.take(), self.record.take()) {
            (Some(log), Some(record)) => log.write_record(&RunRecord {
                step_length: self.run.step_length(),
                summary: recorded_summary,
                complete: error.is_none(),
                error,
                conflicts_sha256: Some(log.digest()),
                clips: Some(log.clips()),
                ..*record
            }),
            _ => Ok(()),
        };
        self.folder = None;
        finished.and(faults_written).and(recorded).map(|()| summary)
    }

    /// Removes the log and the other files: the input could not be used after all.
    pub fn discard(mut self) {
        self.leave_if_forked();
        self.run.writing.outputs = Outputs::default();
        if let Some(log) = self.run.writing.log.take() {
            log.discard();
        }
        if let Some(earlier) = self.earlier.take() {
            earlier.restore();
        }
    }

    /// Records that closecall itself failed within a step, which nothing can close any more; the rows so far stay.
    pub fn abandon(&mut self, error: String) {
        self.leave_if_forked();
        if let (Some(mut log), Some(record)) = (self.run.writing.log.take(), self.record.take()) {
            let (step_length, summary) = (self.run.step_length(), self.run.summary.clone());
            let conflicts_sha256 = Some(log.digest());
            // The error to report is the one that led here.
            let _ = log.finish();
            let _ =
                log.write_record(&RunRecord { step_length, summary, error: Some(error), conflicts_sha256, ..*record });
        }
        self.folder = None;
    }
}

fn begin_log(folder: &Path, record: &RunRecord) -> Result<Log> {
    let mut log = Log::create(folder, &record.options)?;
    if record.csv_safe {
        log.set_csv_safe();
    }
    if let Err(error) = log.write_record(record) {
        log.discard();
        return Err(error);
    }
    Ok(log)
}

/// Checks that none of the log's files is one that the run reads.
fn check_keeps_inputs(folder: &Path, inputs: &[Input]) -> Result<()> {
    let files = log::files(folder).collect::<Vec<_>>();
    let over = inputs.iter().find(|input| same_file(&input.path, files.iter().map(|file| &**file)).is_some());
    over.map_or(Ok(()), |input| Err(Error::Value(format!("the log would be written over {}", input.path.display()))))
}

impl Drop for RecordedRun {
    fn drop(&mut self) {
        self.leave_if_forked();
        if std::thread::panicking() {
            self.abandon(Error::Internal(panics::last()).to_string());
        }
    }
}
