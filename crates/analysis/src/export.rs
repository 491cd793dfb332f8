//! A log in the formats of other tools: maps (QGIS), sumo-gui and netedit, SUMO's SSM device. Memory does not grow with it.

use std::path::{Path, PathBuf};

use super::filter::{ConflictFilter, set_aside_in_words};
use super::logged::{ConflictReader, LostRows, Progress, Reading, check_keeps_logs, log_folders};
use crate::{Error, Result};
use closecall_run::output::formats::{ExportFormat, Exported};
use closecall_run::output::summary::SetAside;

/// What was written.
#[derive(Debug)]
pub struct Made {
    /// The number of conflicts that passed the filter.
    pub conflicts: u64,
    /// The number of conflicts in the log that are traffic's, or count all the same.
    pub all: u64,
    /// How many others there are, and why, in words.
    pub set_aside: Option<String>,
    /// What the log lacks.
    pub lost: Option<LostRows>,
}

/// Writes the conflicts of the log in a folder, or in one below it, that pass the filter to `out`, whole or not at all.
///
/// # Errors
/// That of [`ConflictFilter::check`]; those of reading the log; [`Error::content`] where the folder holds several; [`Error::Value`] where the format cannot
/// hold it or it would be written over the log; those of writing `out`.
pub fn write(
    folder: &Path,
    format: ExportFormat,
    filter: &ConflictFilter,
    out: &Path,
    progress: &mut Progress,
) -> Result<Made> {
    filter.check()?;
    let named = [PathBuf::from(folder)];
    check_keeps_logs(out, &named, None)?;
    let logs = log_folders(&named)?;
    let [log] = &logs[..] else {
        let first = logs.first().map(|log| log.display().to_string()).unwrap_or_default();
        return Err(Error::content(
            folder,
            format!("{} logs are in it; name one of them, such as {first}", logs.len()),
        ));
    };
    let mut conflicts = ConflictReader::open(log)?.with_snapshots();
    let mut reading = Reading::new(0, progress);
    // The log's first, whether it passes or not: it tells in what its places are.
    let first = conflicts.next().transpose()?;
    let mut file = Exported::create(out, format, conflicts.columns_of_schema(), first.as_ref())?;
    let (mut written, mut all, mut set_aside) = (0, 0, SetAside::new());
    for conflict in first.map(Ok).into_iter().chain(conflicts.by_ref()) {
        let conflict = conflict?;
        reading.count(1);
        if filter.sets_aside(&conflict, &mut set_aside) {
            continue;
        }
        all += 1;
        if filter.passes(&conflict) {
            file.write(conflict)?;
            written += 1;
        }
    }
    file.finish()?;
    Ok(Made { conflicts: written, all, set_aside: set_aside_in_words(&set_aside), lost: conflicts.lost() })
}
