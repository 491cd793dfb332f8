//! How the rates of two sets of runs differ, row by row of a forest plot, and in the one sentence that a report needs: all
//! conflicts by severity and kind, the risk index, collisions, and by manoeuvre and place those that matter most of what there
//! is. What neither set has is named too: an empty table would say nothing.

use std::collections::BTreeSet;
use std::path::PathBuf;

use serde::Serialize;

use super::collect::Collection;
use super::counts::{Counts, Spot};
use super::group::By;
use super::pairs::{Unit, pairs, ratio};
use super::rate::{IntervalMethod, Ratio, rate_ratio};
use crate::Result;
use crate::filter::ConflictFilter;
use crate::logged::{LoggedRun, LostRows, Progress};
use closecall::detection::kind::{Kind, Severity};
use closecall::util::units::counted;

/// Below this many conflicts in both sets together, the spread of the runs says little, and the interval is that of the
/// counts.
const FEW: f64 = 20.0;
/// Of manoeuvres and of places, this many with the most conflicts have a row.
const MOST: usize = 12;

/// How the rates of two sets of runs differ.
#[derive(Clone, Debug, Serialize)]
pub struct Effects {
    /// The number of runs after and before.
    pub runs: [usize; 2],
    /// The unit of traffic: `vehicle_kilometre`, or `hour` if the runs have no kilometres.
    pub rates_per: &'static str,
    /// The traffic after and before, in this unit.
    pub traffic: [f64; 2],
    /// The conflicts that the sentence, the manoeuvres and the places are about: the serious and critical ones where there
    /// are any.
    pub what: &'static str,
    /// The rows, those conflicts first.
    pub rows: Vec<Effect>,
    /// The difference in a sentence.
    pub sentence: String,
    /// What neither set has, in a sentence; empty where both have some of everything.
    pub none_of: String,
}

/// How the rate of a group of conflicts differs.
#[derive(Clone, Debug, Serialize)]
pub struct Effect {
    /// What it is a group by; `all` for what is counted together.
    pub by: &'static str,
    /// Its name.
    pub group: String,
    /// The number of conflicts after and before.
    pub counts: [f64; 2],
    /// The rate after / the rate before; none where neither set has a conflict.
    pub ratio: Option<Ratio>,
}

impl Effects {
    /// Compares the runs in the folders `after` with those in `before`. Returns the logs that lack rows too.
    ///
    /// # Errors
    /// Those of [`Collection::read`] and `Collection::check_alike`.
    pub fn of(
        after: &[PathBuf],
        before: &[PathBuf],
        filter: &ConflictFilter,
        progress: &mut Progress,
    ) -> Result<(Self, Vec<LostRows>)> {
        let mut read = |filter: &ConflictFilter| {
            let mut of = |folders| {
                let set = Collection::read(folders, By::Manoeuvre, filter, 0, progress)?;
                set.check_alike(folders)?;
                Ok::<_, crate::Error>(set)
            };
            Ok::<_, crate::Error>([of(after)?, of(before)?])
        };
        let mut all = read(filter)?;
        let lost = all.iter_mut().flat_map(|set| std::mem::take(&mut set.lost)).collect();
        // Cautions are mostly ordinary following: where there is more, that is what matters.
        let has = |severity| all.iter().any(|set| set.counts(None, Some(severity)).iter().any(|count| *count > 0.0));
        let [has_cautions, has_serious, has_critical] = Severity::ALL.map(has);
        let has_severe = has_serious || has_critical;
        let severe = if has_cautions && has_severe {
            Some(read(&ConflictFilter { severities: vec![Severity::Serious, Severity::Critical], ..filter.clone() })?)
        } else {
            None
        };
        let what = if has_severe { SEVERE } else { ALL };
        // Of collisions only those of a whole run are known, run by run.
        Ok((Self::between(&all, severe.as_ref().unwrap_or(&all), what, filter.is_empty()), lost))
    }

    fn between(all: &[Collection; 2], sets: &[Collection; 2], what: &'static str, has_collisions: bool) -> Self {
        let runs = sets.each_ref().map(|set| set.runs.iter().collect::<Vec<_>>());
        let unit = Unit::of(&[&runs[0], &runs[1]]);
        let traffic = runs.each_ref().map(|runs| unit.of_each(runs));
        let paired = pairs(&runs[0], &runs[1]);
        let all_traffic = traffic.each_ref().map(|traffic| traffic.iter().sum::<f64>());
        let row = |by: &'static str, group: &str, per_run: [Vec<f64>; 2]| {
            let counts = per_run.each_ref().map(|counts| counts.iter().sum::<f64>());
            let ratio = if counts[0] + counts[1] < FEW {
                rate_ratio((&counts[..1], &all_traffic[..1]), (&counts[1..], &all_traffic[1..]))
            } else {
                ratio((&per_run[0], &traffic[0]), (&per_run[1], &traffic[1]), paired.as_deref())
            };
            Effect { by, group: group.to_owned(), counts, ratio }
        };
        let of = |sets: &[Collection; 2], kind, severity| sets.each_ref().map(|set| set.counts(kind, severity));
        let counts = |kind, severity| of(all, kind, severity);
        let mut rows = vec![row("all", what, of(sets, None, None))];
        if what != ALL {
            rows.push(row("all", ALL, counts(None, None)));
        }
        if has_collisions {
            let collisions = |run: &&LoggedRun| run.summary.collisions as f64;
            rows.push(row("all", "collisions", runs.each_ref().map(|runs| runs.iter().map(collisions).collect())));
        }
        let risk = row("all", RISK, all.each_ref().map(|set| set.risk.per_run(set.runs.len())));
        // It is not a count, so a count's interval does not apply to it.
        let is_counted = risk.ratio.is_some_and(|ratio| ratio.method == IntervalMethod::PoissonExact);
        rows.push(if is_counted { Effect { ratio: None, ..risk } } else { risk });
        rows.extend(Severity::ALL.map(|severity| row("severity", severity.name(), counts(None, Some(severity)))));
        rows.extend(Kind::ALL.map(|kind| row("kind", kind.name(), counts(Some(kind), None))));
        let none_of = none_of(&rows);
        let per_run = |counts: [Option<&Counts>; 2]| {
            let of =
                |set: usize| counts[set].map_or_else(|| vec![0.0; runs[set].len()], |of| of.per_run(runs[set].len()));
            [of(0), of(1)]
        };
        let groups = |set: &'_ Collection, name: &str| {
            set.groups.first().and_then(|groups| groups.get(name)).map(|group| group.counts.clone())
        };
        let names =
            sets.iter().flat_map(|set| set.groups.iter().flat_map(|groups| groups.keys())).collect::<BTreeSet<_>>();
        let of_manoeuvre = |name: &&String| {
            let found = sets.each_ref().map(|set| groups(set, name));
            row("manoeuvre", name, per_run(found.each_ref().map(Option::as_ref)))
        };
        rows.extend(most(names.iter().map(of_manoeuvre).collect()));
        let spots = |get: fn(&Collection) -> &rustc_hash::FxHashMap<String, Spot>, what: &'static str| {
            // The edges within a junction are part of it.
            let names = sets.iter().flat_map(|set| get(set).keys()).filter(|name| !name.starts_with(':'));
            let names = names.collect::<BTreeSet<_>>();
            let of = |name: &String| {
                let found = sets.each_ref().map(|set| get(set).get(name).map(|spot| &spot.counts));
                row("place", &format!("{what} {name}"), per_run(found))
            };
            names.into_iter().map(of).collect::<Vec<_>>()
        };
        let mut places = spots(|set| &set.junctions, "junction");
        places.extend(spots(|set| &set.edges, "edge"));
        rows.extend(most(places));
        rows.retain(|row| row.by == "all" || row.counts.iter().any(|count| *count > 0.0));
        let runs = runs.map(|runs| runs.len());
        let sentence = sentence(&rows[0], what, unit.name, runs);
        Self { runs, rates_per: unit.name, traffic: all_traffic, what, rows, sentence, none_of }
    }
}

/// The conflicts that are compared, in words.
const SEVERE: &str = "serious and critical conflicts";
const ALL: &str = "conflicts";
const RISK: &str = "risk index";

/// What neither set has, in a sentence.
fn none_of(rows: &[Effect]) -> String {
    let name = |row: &Effect| match row.by {
        "all" => row.group.clone(),
        _ => format!("{} conflicts", row.group.replace('_', "-")),
    };
    let absent = rows.iter().filter(|row| row.group != RISK && row.counts == [0.0; 2]).map(name).collect::<Vec<_>>();
    match &absent[..] {
        [] => String::new(),
        [_, ..] if rows[0].counts == [0.0; 2] && rows[0].group == ALL => {
            "Neither set of runs has conflicts.".to_owned()
        }
        [one] => format!("Neither set of runs has {one}."),
        [first @ .., last] => format!("Neither set of runs has {} or {last}.", first.join(", ")),
    }
}

/// The rows with the most conflicts, the most first.
fn most(mut rows: Vec<Effect>) -> Vec<Effect> {
    rows.sort_by(|a, b| b.counts.iter().sum::<f64>().total_cmp(&a.counts.iter().sum()).then(a.group.cmp(&b.group)));
    rows.truncate(MOST);
    rows
}

/// A difference that rounds to nothing.
const AS_MANY: &str = "as many";
/// From this ratio on, the sentence counts in times, not in per cent.
const MANY_TIMES: f64 = 3.0;

/// The difference in a sentence: how many more or fewer, whether that may be chance, from how many runs.
fn sentence(all: &Effect, what: &str, unit: &str, [after, before]: [usize; 2]) -> String {
    let runs = format!("{} after, {before} before", counted(after as u64, "run"));
    let per = unit.replace("vehicle_kilometre", "vehicle-kilometre");
    let counts = format!("{} and {} conflicts in {runs}", all.counts[0], all.counts[1]);
    let Some(Ratio { value, low, high, .. }) = all.ratio else {
        return format!("There is nothing to compare: {runs}, without {what}.");
    };
    let change = |ratio: f64| match (ratio - 1.0) * 100.0 {
        percent if percent.round() == 0.0 => AS_MANY.to_owned(),
        percent if percent < 0.0 => format!("{:.0} % fewer", -percent),
        percent if ratio < MANY_TIMES => format!("{percent:.0} % more"),
        _ => format!("{ratio:.0} times as many"),
    };
    let end = |high: Option<f64>| high.map_or("without a bound above".to_owned(), change);
    let interval = format!("95 % interval: {} to {}", change(low), end(high));
    let is_sure = low > 1.0 || high.is_some_and(|high| high < 1.0);
    let head = match value {
        Some(value) if !is_sure && change(value) == AS_MANY => {
            format!("Per {per} there were as many {what} after the change as before")
        }
        Some(value) if is_sure => format!("Per {per} there were {} {what} after the change", change(value)),
        Some(value) => format!(
            "Per {per} there were {} {what} after the change, but chance alone may explain the difference",
            change(value)
        ),
        None => format!("There were {what} only after the change"),
    };
    format!("{head} ({interval}; {counts}).")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(value: Option<f64>, low: f64, high: Option<f64>) -> String {
        let ratio = Some(Ratio { value, low, high, method: IntervalMethod::TOverRuns });
        let all = Effect { by: "all", group: "all".to_owned(), counts: [66.0, 100.0], ratio };
        sentence(&all, "serious and critical conflicts", "vehicle_kilometre", [4, 5])
    }

    #[test]
    fn a_difference_is_called_one_only_if_the_interval_excludes_none() {
        assert_eq!(
            said(Some(0.66), 0.5, Some(0.88)),
            "Per vehicle-kilometre there were 34 % fewer serious and critical conflicts after the change (95 % interval: \
             50 % fewer to 12 % fewer; 66 and 100 conflicts in 4 runs after, 5 before)."
        );
        assert!(said(Some(0.66), 0.5, Some(1.1)).contains("chance alone may explain"));
        assert!(said(Some(1.3), 1.1, Some(1.6)).contains("30 % more serious"));
        assert!(
            said(Some(1.001), 0.05, Some(21.6))
                .contains("many serious and critical conflicts after the change as before (95 %")
        );
        assert!(said(Some(1.001), 0.05, Some(21.6)).contains("interval: 95 % fewer to 22 times as many;"));
        assert!(said(None, 1.5, None).starts_with("There were serious and critical conflicts only after"));
    }

    #[test]
    fn what_neither_set_has_is_named() {
        let row = |by, group: &str, counts| Effect { by, group: group.to_owned(), counts, ratio: None };
        let some = [row("all", ALL, [3.0, 0.0]), row("all", RISK, [0.0, 0.0]), row("severity", "serious", [1.0, 0.0])];
        assert_eq!(none_of(&some), "");
        let serious = row("severity", "serious", [0.0, 0.0]);
        let one = [row("all", ALL, [3.0, 0.0]), serious.clone()];
        assert_eq!(none_of(&one), "Neither set of runs has serious conflicts.");
        let kinds = ["rear_end", "side"].map(|kind| row("kind", kind, [0.0, 0.0]));
        let several =
            [row("all", ALL, [3.0, 0.0]), row("all", "collisions", [0.0, 0.0]), serious].into_iter().chain(kinds);
        assert_eq!(
            none_of(&several.collect::<Vec<_>>()),
            "Neither set of runs has collisions, serious conflicts, rear-end conflicts or side conflicts."
        );
        assert_eq!(none_of(&[row("all", ALL, [0.0, 0.0])]), "Neither set of runs has conflicts.");
    }

    #[test]
    fn the_rows_with_the_most_conflicts_come_first() {
        let row = |group: usize| Effect {
            by: "place",
            group: format!("{group:02}"),
            counts: [group as f64, 1.0],
            ratio: None,
        };
        let rows = most((0..20).map(row).collect());
        assert_eq!((rows.len(), rows[0].group.as_str(), rows[11].group.as_str()), (MOST, "19", "08"));
    }
}
