//! What the conflicts of one run add to the statistics of a set.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::counts::{ConflictGroup, Counts, MEASURES, Spot, measures};
use super::extremes::Tails;
use super::group::By;
use super::quantiles::select;
use super::weighted::WeightedEvents;
use super::worst::WorstOf;
use crate::filter::ConflictFilter;
use crate::logged::{ConflictReader, LoggedConflict, LostRows};
use crate::{Error, Result};
use closecall::detection::kind::{Kind, Severity};
use closecall_run::output::summary::SetAside;

/// After this many conflicts the reader reports how far it is.
const EVERY: u64 = 4096;

/// The columns that are counted, whatever the groups and the filter.
const COUNTED: [&str; 14] = [
    "id",
    "kind",
    "severity",
    "gap",
    "mu",
    "margin",
    "ttc",
    "pet",
    "ego_delta_v",
    "foe_delta_v",
    "lane",
    "collision",
    "crash_probability",
    "artefact",
];

/// What one run adds.
#[derive(Debug)]
pub(crate) struct OfRun {
    /// The file and its columns.
    pub path: PathBuf,
    /// The columns of the file.
    pub columns: Vec<String>,
    /// What is wrong with its rows as a whole.
    pub lost: Option<LostRows>,
    /// The conflicts of the log that are none of traffic's, and are not counted.
    pub set_aside: SetAside,
    /// How many others it has.
    pub read: u64,
    /// How many of them count.
    pub passed: u64,
    /// The conflicts by group.
    pub groups: FxHashMap<String, ConflictGroup>,
    /// Counts by kind and severity.
    pub tallies: [[Counts; 3]; 3],
    /// Conflicts by edge.
    pub edges: FxHashMap<String, Spot>,
    /// Conflicts by junction.
    pub junctions: FxHashMap<String, Spot>,
    /// All conflicts with their crash probabilities.
    pub risk: WeightedEvents,
    /// The median of each measure.
    pub medians: [Option<f64>; MEASURES.len()],
    /// The worst conflicts, of which only what is counted may be read.
    pub worst: WorstOf,
    /// The most severe values.
    pub tails: Tails,
}

impl OfRun {
    /// Reads the log, in this folder, of the run with this number; reports to `progress` how many conflicts more it has read.
    ///
    /// # Errors
    /// An error that names the file and its line: missing, not a log, empty, cut short, without a column that `by` needs.
    pub fn read(
        (run, folder, log): (usize, &Arc<Path>, ConflictReader),
        by: By,
        filter: &ConflictFilter,
        worst: usize,
        progress: &mut dyn FnMut(u64),
    ) -> Result<Self> {
        let counted = [&COUNTED[..], by.columns(), &filter.columns()].concat();
        let mut reader = log.only(&counted);
        let columns = reader.columns();
        if let Some(needed) = by.columns().iter().find(|needed| !columns.iter().any(|column| column == *needed)) {
            let message = format!("the column \"{needed}\" is missing: logs of earlier versions do not have it");
            return Err(Error::line(reader.path(), 1, message));
        }
        let mut found = Self {
            path: reader.path().to_owned(),
            columns,
            lost: None,
            set_aside: SetAside::new(),
            read: 0,
            passed: 0,
            groups: FxHashMap::default(),
            tallies: Default::default(),
            edges: FxHashMap::default(),
            junctions: FxHashMap::default(),
            risk: WeightedEvents::default(),
            medians: Default::default(),
            worst: WorstOf::new(worst),
            tails: Tails::default(),
        };
        let mut rows = 0_u64;
        while let Some(conflict) = reader.next_row()? {
            rows += 1;
            if rows.is_multiple_of(EVERY) {
                progress(EVERY);
            }
            if filter.sets_aside(conflict, &mut found.set_aside) {
                continue;
            }
            found.read += 1;
            if filter.passes(conflict) {
                found.add(run, conflict, &by.group(conflict, filter.named.as_ref()));
                if found.worst.takes(run, conflict) {
                    found.worst.add(run, folder, conflict.clone());
                }
            }
        }
        progress(rows % EVERY);
        found.lost = reader.lost();
        found.medians = std::array::from_fn(|measure| {
            let values = found.groups.values().flat_map(|group| &group.columns[measure]);
            select(&mut values.copied().collect::<Vec<_>>(), 0.5)
        });
        Ok(found)
    }

    fn add(&mut self, run: usize, conflict: &LoggedConflict, group: &str) {
        self.passed += 1;
        update(&mut self.groups, group, |group| {
            group.counts.add(run);
            group.collisions += u64::from(conflict.collision);
            for (column, value) in group.columns.iter_mut().zip(measures(conflict)) {
                column.extend(value);
            }
        });
        let kind = rank(&Kind::ALL, conflict.kind);
        let severity = rank(&Severity::ALL, conflict.severity);
        self.tallies[kind][severity].add(run);
        let probability = conflict.crash_probability.unwrap_or_default();
        self.risk.add(run, probability);
        for (spots, name) in [(&mut self.edges, conflict.edge()), (&mut self.junctions, conflict.junction())] {
            if !name.is_empty() {
                update(spots, name, |spot: &mut Spot| {
                    spot.counts.add(run);
                    spot.severities[severity] += 1;
                    spot.crashes.add(run, probability);
                });
            }
        }
        self.tails.take(conflict);
    }
}

fn rank<T: PartialEq>(all: &[T], one: T) -> usize {
    all.iter().position(|known| *known == one).unwrap_or_default()
}

/// Changes the entry of a name; copies the name only if it is new.
fn update<T: Default>(map: &mut FxHashMap<String, T>, name: &str, change: impl FnOnce(&mut T)) {
    if let Some(known) = map.get_mut(name) {
        change(known);
    } else {
        let mut new = T::default();
        change(&mut new);
        map.insert(name.to_owned(), new);
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use clap::{Parser, ValueEnum};

    use crate::logged::{PARQUET, pack_in_place};
    use crate::statistics::of_run::*;
    use closecall_run::output::log::{CONFLICTS, RUN};
    use closecall_run::output::sample_conflict::sample;
    use closecall_run::output::schema::COLUMNS;

    #[derive(Parser)]
    struct Args {
        #[command(flatten)]
        filter: ConflictFilter,
    }

    /// The texts of a row: each column that is counted, grouped by or filtered by differs from row to row.
    fn row(id: usize, random: &mut fastrand::Rng) -> String {
        let mut one_of = |texts: &[&str]| texts[random.usize(..texts.len())].to_owned();
        let values = [
            ("id", id.to_string()),
            ("kind", one_of(&["side", "frontal", "rear_end"])),
            ("severity", one_of(&["caution", "serious", "critical"])),
            ("time", one_of(&["1", "4000"])),
            ("end", "5000".to_owned()),
            ("gap", one_of(&["1", "2"])),
            ("mu", one_of(&["3", "4"])),
            ("margin", one_of(&["-1", "-2", "-3"])),
            ("ttc", one_of(&["", "0.5", "1.5"])),
            ("pet", one_of(&["", "0.25", "2"])),
            ("ego_delta_v", one_of(&["1", "5"])),
            ("foe_delta_v", one_of(&["", "4"])),
            ("lane", one_of(&["", "a_0", ":J_1_0"])),
            ("collision", one_of(&["true", "false"])),
            ("crash_probability", one_of(&["", "0.125", "0.5"])),
            ("x", one_of(&["0", "100"])),
            ("ego_type", one_of(&["car", "bus"])),
            ("manoeuvre", one_of(&["", "crossing", "merge"])),
            ("cause", one_of(&["", "ran_red too_fast", "too_close"])),
            ("ego_path", String::new()),
            ("foe_path", String::new()),
        ];
        let conflict = sample(&values.each_ref().map(|(name, text)| (*name, text.as_str()))).unwrap();
        let cells = COLUMNS.map(|column| (column.get)(&conflict).text(&mut String::new()).to_owned());
        cells.join(",") + "\n"
    }

    #[test]
    fn parquet_counts_as_csv_by_every_group_and_filter() {
        let folder = tempfile::tempdir().unwrap();
        let [csv, packed]: [Arc<Path>; 2] = ["csv", "packed"].map(|name| folder.path().join(name).into());
        let mut random = fastrand::Rng::with_seed(1);
        let rows = (1..=700).map(|id| row(id, &mut random)).collect::<String>();
        for log in [&csv, &packed] {
            fs::create_dir(log).unwrap();
            fs::write(log.join(CONFLICTS), COLUMNS.map(|column| column.name).join(",") + "\n" + &rows).unwrap();
            fs::write(log.join(RUN), "{}\n").unwrap();
        }
        pack_in_place(&packed).unwrap();
        let count = |log: &Arc<Path>, by: By, args: &str| {
            let filter = Args::parse_from(["closecall"].into_iter().chain(args.split_whitespace())).filter;
            let mut of_run =
                OfRun::read((0, log, ConflictReader::open(log).unwrap()), by, &filter, 5, &mut |_| ()).unwrap();
            of_run.worst.complete().unwrap();
            assert!(of_run.passed > 0, "{args}");
            format!("{of_run:?}").replace(&*log.to_string_lossy(), "log").replace(CONFLICTS, PARQUET)
        };
        let filters = ["", "--from 100", "--to 100", "--kind side", "--severity serious", "--manoeuvre merge"];
        let others = ["--cause too_fast", "--type bus", "--where J", "--where 0,0,50"];
        for args in filters.into_iter().chain(others) {
            for by in By::value_variants() {
                assert_eq!(count(&csv, *by, args), count(&packed, *by, args), "{by:?} {args}");
            }
        }
    }
}
