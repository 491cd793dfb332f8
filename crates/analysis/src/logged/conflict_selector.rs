//! One conflict of a log: that with an `id`, or one by how bad it is.

use std::cmp::Reverse;
use std::path::Path;

use rustc_hash::FxHashSet;

use super::reader::ConflictReader;
use crate::{Error, Result};
use closecall::util::units::counted;
use closecall_run::output::rank::Rank;
use closecall_run::output::schema::LoggedConflict;
use closecall_run::output::summary::{SetAside, in_words};

/// Which conflict of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConflictSelector {
    /// That with this `id`.
    Id(u64),
    /// The worst, the second worst, … of those that are traffic's: 1, 2, …
    Worst(usize),
}

impl ConflictSelector {
    /// Finds it, with its snapshots.
    ///
    /// # Errors
    /// [`Error::NoConflict`] or [`Error::NoWorst`] where the log has none such; the errors of reading it.
    pub fn find(self, folder: &Path) -> Result<LoggedConflict> {
        let id = match self {
            Self::Id(id) => id,
            Self::Worst(place) => ranked(folder, place)?[place - 1],
        };
        Ok(with_ids(folder, &[id])?.remove(0))
    }
}

/// At most `most` conflicts of a log that are traffic's, the worst first, with their snapshots.
///
/// # Errors
/// [`Error::NoWorst`] where the log has none; the errors of reading it.
pub fn worst(folder: &Path, most: usize) -> Result<Vec<LoggedConflict>> {
    let mut ids = ranked(folder, 1)?;
    ids.truncate(most);
    with_ids(folder, &ids)
}

/// The conflicts of a log with these ids, in their order and each once, with their snapshots.
///
/// # Errors
/// [`Error::NoConflict`] where the log lacks one; the errors of reading it.
pub fn with_ids(folder: &Path, ids: &[u64]) -> Result<Vec<LoggedConflict>> {
    let mut missing = ids.iter().copied().collect::<FxHashSet<_>>();
    let mut found = Vec::with_capacity(missing.len());
    for conflict in ConflictReader::open(folder)?.with_snapshots() {
        let conflict = conflict?;
        if missing.remove(&conflict.id) {
            found.push(conflict);
        }
        if missing.is_empty() {
            break;
        }
    }
    let place = |wanted: u64| ids.iter().position(|id| *id == wanted);
    if let Some(id) = missing.into_iter().min_by_key(|id| place(*id)) {
        return Err(Error::NoConflict(folder.to_owned(), id));
    }
    found.sort_by_key(|conflict| place(conflict.id));
    Ok(found)
}

/// The `id` of each conflict of a log that is traffic's, the worst first.
///
/// # Errors
/// [`Error::NoWorst`] where there are fewer than `least`, or `least` is 0.
fn ranked(folder: &Path, least: usize) -> Result<Vec<u64>> {
    let (mut found, mut set_aside) = (Vec::new(), SetAside::new());
    for conflict in ConflictReader::open(folder)? {
        let conflict = conflict?;
        if conflict.artefact.is_empty() {
            found.push((Rank::from(&conflict), Reverse(conflict.id)));
        } else {
            *set_aside.entry(conflict.artefact.into()).or_default() += 1;
        }
    }
    if least == 0 || found.len() < least {
        let count = counted(found.len() as u64, "conflict");
        let aside = in_words(&set_aside).map(|words| format!(", and has {words}; name one by its id"));
        return Err(Error::NoWorst(folder.to_owned(), least, count + &aside.unwrap_or_default()));
    }
    found.sort_unstable_by(|a, b| b.cmp(a));
    Ok(found.into_iter().map(|(_, Reverse(id))| id).collect())
}
