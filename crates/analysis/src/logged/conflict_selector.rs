//! One conflict of a log: that with an `id`, or one by how bad it is.

use std::cmp::Reverse;
use std::path::Path;

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
            Self::Worst(place) => worst(folder, place)?,
        };
        let mut conflicts = ConflictReader::open(folder)?.with_snapshots();
        let found = conflicts.find(|conflict| conflict.as_ref().map_or(true, |conflict| conflict.id == id));
        found.transpose()?.ok_or_else(|| Error::NoConflict(folder.to_owned(), id))
    }
}

/// The `id` of the worst conflict of a log, the second worst, … of those that are traffic's.
fn worst(folder: &Path, place: usize) -> Result<u64> {
    let (mut found, mut set_aside) = (Vec::new(), SetAside::new());
    for conflict in ConflictReader::open(folder)? {
        let conflict = conflict?;
        if conflict.artefact.is_empty() {
            found.push((Rank::from(&conflict), Reverse(conflict.id)));
        } else {
            *set_aside.entry(conflict.artefact.into()).or_default() += 1;
        }
    }
    found.sort_unstable_by(|a, b| b.cmp(a));
    let count = found.len();
    let Some((_, Reverse(id))) = place.checked_sub(1).and_then(|place| found.get(place)) else {
        let count = counted(count as u64, "conflict");
        let aside = in_words(&set_aside).map(|words| format!(", and has {words}; name one by its id"));
        return Err(Error::NoWorst(folder.to_owned(), place, count + &aside.unwrap_or_default()));
    };
    Ok(*id)
}
