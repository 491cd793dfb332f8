//! The baseline of a conflict: whether it happens there, how the crash probability goes, and how far it is from the run.

use std::path::Path;

use super::scenario::Subject;
use crate::batch::sweep::Task;
use crate::logged::{ConflictReader, LoggedConflict};
use crate::{Error, Result};
use closecall::util::units::{Metre, Probability, SAME_MOMENT, Second};
use closecall_run::options::SERIES_FILES;
use closecall_run::run::roll_out::{Outcome, PathStep, ROLL_OUT};

/// A conflict that opens at most this much sooner or later in the baseline is the same, in s.
const SAME_CONFLICT: Second = 2.0;

/// A baseline in which the conflict happens.
#[derive(Clone, Debug, Default)]
pub(super) struct Baseline {
    /// The ids of those of the two that are persons.
    pub persons: Vec<String>,
    /// The number of its start.
    pub start: usize,
    /// The largest distance of the two from where they were in the run at the same time, in m.
    pub drift: Metre,
    /// The crash probability in the step in which the conflict opens.
    pub at_opening: Option<Probability>,
    /// The largest, and when it is that.
    pub largest: Option<Probability>,
    pub worst: Option<Second>,
    /// Whether the two strike each other without any error.
    pub collides: bool,
}

/// The baseline of a conflict, the one of several that is nearest to the run, or why there is none.
pub(super) fn nearest<'a>(
    subject: &Subject,
    original: &Task,
    tasks: impl Iterator<Item = &'a Task>,
    is_exact: bool,
) -> Result<std::result::Result<Baseline, String>> {
    let mut best = Err("its baselines failed".to_owned());
    for (start, task) in tasks.enumerate() {
        match (baseline(subject, start, original, task, is_exact)?, &best) {
            (Ok(found), Ok(Baseline { drift, .. })) if found.drift >= *drift => {}
            (Ok(found), _) => best = Ok(found),
            (Err(why), Err(_)) => best = Err(why),
            (Err(_), Ok(_)) => {}
        }
    }
    Ok(best)
}

/// The baseline from one start, or why the conflict does not happen in it.
fn baseline(
    subject: &Subject,
    start: usize,
    original: &Task,
    task: &Task,
    is_exact: bool,
) -> Result<std::result::Result<Baseline, String>> {
    if !original.file().exists() || !task.file().exists() {
        return Ok(Err("its baselines failed".to_owned()));
    }
    let wanted = &subject.conflict;
    let Some(there) = find(&original.log(), wanted, SAME_MOMENT)? else {
        return Ok(Err("it does not come back when SUMO runs again: what the run read has changed".to_owned()));
    };
    let [of_run, own] = [original, task].map(|task| Outcome::read(&task.beside().join(ROLL_OUT)));
    let (of_run, own) = (of_run?, own?);
    let drift = [&there.ego, &there.foe].into_iter().map(|id| distance(of_run.paths.get(&**id), own.paths.get(&**id)));
    let drift = drift.fold(0.0, f64::max);
    let Some(found) = find(&task.log(), wanted, SAME_CONFLICT)? else {
        return Ok(Err(match () {
            () if is_exact => "it does not happen unless SUMO removes vehicles that have collided".to_owned(),
            () if drift.is_finite() => {
                format!("it does not happen in runs from SUMO's saved states, which drift by {drift:.1} m; try --exact")
            }
            () => "one of the two is missing in runs from SUMO's saved states; try --exact".to_owned(),
        }));
    };
    let series = task.beside().join(SERIES_FILES[0]);
    let steps = probabilities(&series, found.id)?;
    let largest = steps.iter().copied().reduce(|best, next| if next.1 > best.1 { next } else { best });
    Ok(Ok(Baseline {
        collides: own.contact.is_some(),
        persons: own.persons,
        start,
        drift,
        at_opening: steps.first().map(|step| step.1),
        largest: largest.map(|step| step.1),
        worst: largest.map(|step| step.0),
    }))
}

/// The conflict of the same two in a log that opens nearest to the same time.
fn find(log: &Path, wanted: &LoggedConflict, within: Second) -> Result<Option<LoggedConflict>> {
    let off = |found: &LoggedConflict| (found.begin - wanted.begin).abs();
    let mut nearest = None::<LoggedConflict>;
    for found in ConflictReader::open(log)? {
        let found = found?;
        let is_pair = found.is_between(&wanted.ego, &wanted.foe);
        if is_pair && off(&found) < within && nearest.as_ref().is_none_or(|nearest| off(&found) < off(nearest)) {
            nearest = Some(found);
        }
    }
    Ok(nearest)
}

/// The largest distance between two paths at the same times; infinite where one is missing.
fn distance(a: Option<&Vec<PathStep>>, b: Option<&Vec<PathStep>>) -> Metre {
    let (Some(a), Some(b)) = (a, b) else { return f64::INFINITY };
    let mut others = b.iter().peekable();
    let mut largest = 0.0_f64;
    for step in a {
        while others.next_if(|other| other.0 < step.0 - SAME_MOMENT).is_some() {}
        if let Some(other) = others.peek().filter(|other| other.0 < step.0 + SAME_MOMENT) {
            largest = largest.max((step.1 - other.1).hypot(step.2 - other.2));
        }
    }
    largest
}

/// Times and crash probabilities of a conflict's steps, from its log's series.
fn probabilities(series: &Path, conflict: u64) -> Result<Vec<(Second, Probability)>> {
    let failed = |error: csv::Error| Error::content(series, error.to_string());
    let mut reader = csv::Reader::from_path(series).map_err(failed)?;
    let header = reader.headers().map_err(failed)?.clone();
    let place = |name: &str| header.iter().position(|column| column == name);
    let [Some(number), Some(time), Some(probability)] = ["conflict", "time", "crash_probability"].map(place) else {
        return Err(Error::content(series, "it lacks a column of a series"));
    };
    let mut steps = Vec::new();
    for row in reader.records() {
        let row = row.map_err(failed)?;
        let value = |place: usize| row.get(place).and_then(|cell| cell.parse::<f64>().ok());
        if row.get(number).is_some_and(|cell| cell == conflict.to_string()) {
            steps.extend(value(time).map(|time| (time, value(probability).unwrap_or_default())));
        }
    }
    Ok(steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_compared_at_the_same_times() {
        let path = |shift: f64, from: u32| -> Vec<PathStep> {
            (from..10).map(|step| (f64::from(step) * 0.1, f64::from(step) + shift, 0.0, 0.0, 10.0)).collect()
        };
        assert_eq!(distance(Some(&path(0.0, 0)), Some(&path(0.5, 3))), 0.5);
        assert_eq!(distance(Some(&path(0.0, 0)), Some(&path(0.0, 0))), 0.0);
        assert_eq!(distance(Some(&path(0.0, 0)), None), f64::INFINITY);
    }
}
