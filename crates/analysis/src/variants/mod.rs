//! The variants of a set of runs: runs that were made alike but for SUMO's seed.
//!
//! Rates of runs that differ in an option, such as those of `closecall sweep --vary`, are not repetitions of one another.
//! Options, SUMO's own options, versions and step lengths tell variants apart wherever they differ. An input file does so
//! where two runs of one seed differ in it; where every seed has a file of its own, that is the seed's demand. Where a
//! file lies, and what SUMO writes or prints, does not matter.

mod run_settings;

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use rustc_hash::FxHashMap;
use serde::Serialize;

use super::logged::LoggedRun;
use run_settings::{NONE, Values, settings};

/// The name of the setting that stands for all varied input files.
const INPUTS: &str = "inputs";

/// The variants of a set of runs.
#[derive(Clone, Debug, Default)]
pub struct Variants {
    /// The settings that differ, by name.
    pub varied: Vec<String>,
    /// The variants, in the order of their settings; one if nothing differs.
    pub all: Vec<Variant>,
    /// What the reader of their statistics should know.
    pub notes: Vec<String>,
}

/// Runs that were made alike but for the seed.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Variant {
    /// What tells it from the others, such as `epsilon=0.5, sumo:scale=1.2`; empty if there is only one.
    pub name: String,
    /// The same, by setting.
    pub settings: BTreeMap<String, String>,
    /// The places of its runs in the set, in ascending order.
    #[serde(skip)]
    pub runs: Vec<usize>,
}

impl Variants {
    /// Sorts runs into variants.
    pub fn of(runs: &[&LoggedRun]) -> Self {
        let settings = runs.iter().map(|run| settings(run)).collect::<Vec<_>>();
        let files = runs.iter().map(|run| files(run)).collect::<Vec<_>>();
        let varied = differing(settings.iter());
        let chosen = |values: &Values, names: &BTreeSet<String>| -> Vec<Option<String>> {
            names.iter().map(|name| values.get(name).cloned()).collect()
        };
        let mut of_seed = FxHashMap::<_, Vec<&Values>>::default();
        for ((run, settings), files) in runs.iter().zip(&settings).zip(&files) {
            if let Some(seed) = &run.seed {
                of_seed.entry((seed, chosen(settings, &varied))).or_default().push(files);
            }
        }
        let varied_files =
            of_seed.into_values().flat_map(|files| differing(files.into_iter())).collect::<BTreeSet<_>>();
        let mut members = FxHashMap::<_, Vec<usize>>::default();
        for (run, (settings, files)) in settings.iter().zip(&files).enumerate() {
            members.entry((chosen(settings, &varied), chosen(files, &varied_files))).or_default().push(run);
        }
        let mut members = members.into_iter().collect::<Vec<_>>();
        members.sort_by(|((a, a_files), a_runs), ((b, b_files), b_runs)| {
            let values = a.iter().zip(b).map(|(a, b)| order(a.as_deref(), b.as_deref()));
            let of_values = values.fold(Ordering::Equal, Ordering::then);
            of_values.then_with(|| if a_files == b_files { Ordering::Equal } else { a_runs.cmp(b_runs) })
        });
        let inputs = input_names(&members.iter().map(|(_, own)| runs[own[0]]).collect::<Vec<_>>(), &varied_files);
        let mut found = Self { varied: varied.iter().cloned().collect(), ..Self::default() };
        if !varied_files.is_empty() {
            found.varied.push(INPUTS.to_owned());
        }
        let mut own_files = BTreeSet::new();
        for (((values, _), own), inputs) in members.into_iter().zip(inputs) {
            own_files.extend(differing(own.iter().map(|run| &files[*run])));
            let values = values.into_iter().map(|value| value.unwrap_or_else(|| NONE.to_owned())).chain([inputs]);
            let settings = found.varied.iter().cloned().zip(values).collect::<BTreeMap<_, _>>();
            let name = settings.iter().map(|(name, value)| format!("{name}={value}")).collect::<Vec<_>>().join(", ");
            found.all.push(Variant { name, settings, runs: own });
        }
        // Of recordings each is an input of its own.
        if !own_files.is_empty() && runs.iter().any(|run| run.versions.sumo.is_some()) {
            found.notes.push(format!(
                "runs of different seeds have input files of their own ({}): taken for the demand of that seed",
                a_few(&own_files)
            ));
        }
        found
    }

    /// Whether the runs differ in more than the seed.
    pub(crate) fn are_several(&self) -> bool {
        self.all.len() > 1
    }
}

/// What makes two runs of one variant repetitions of the same run; none where no two are.
pub fn repeated(run: &LoggedRun) -> Option<String> {
    match &run.seed {
        Some(seed) => Some(format!("seed {seed}")),
        // SUMO chose a seed and did not report it.
        None if run.versions.sumo.is_some() => None,
        None if run.inputs.is_empty() => None,
        None => Some(run.inputs.iter().map(|input| input.sha256.as_str()).collect()),
    }
}

/// The names whose values are not the same in all.
fn differing<'a>(all: impl Iterator<Item = &'a Values> + Clone) -> BTreeSet<String> {
    let Some(first) = all.clone().next() else { return BTreeSet::new() };
    let mut names = BTreeSet::new();
    for values in all {
        names.extend(values.iter().filter(|(name, value)| first.get(*name) != Some(value)).map(|(name, _)| name));
        names.extend(first.keys().filter(|name| !values.contains_key(*name)));
    }
    names.into_iter().cloned().collect()
}

/// Numbers by their value, before texts.
fn order(a: Option<&str>, b: Option<&str>) -> Ordering {
    let number = |text: Option<&str>| text.and_then(|text| text.parse::<f64>().ok());
    match (number(a), number(b)) {
        (Some(a), Some(b)) => a.total_cmp(&b),
        (Some(_), None) => Ordering::Less,
        (None, Some(_)) => Ordering::Greater,
        (None, None) => a.cmp(&b),
    }
}

/// A run's input files: their hashes by name.
fn files(run: &LoggedRun) -> Values {
    run.inputs.iter().map(|input| (name_of(&input.path), input.sha256.clone())).collect()
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The varied input files of each variant, by the first of its runs: their names where those tell the variants apart, or
/// else their paths with the beginning of their hashes.
fn input_names(firsts: &[&LoggedRun], varied: &BTreeSet<String>) -> Vec<String> {
    let listed = |show: fn(&Path, &str) -> String| -> Vec<String> {
        let of = |run: &&LoggedRun| {
            let own = run.inputs.iter().filter(|input| varied.contains(&name_of(&input.path)));
            own.map(|input| show(&input.path, &input.sha256)).collect::<Vec<_>>().join(" ")
        };
        firsts.iter().map(of).collect()
    };
    let names = listed(|path, _| name_of(path));
    let hashes = listed(|_, hash| hash.to_owned());
    let count = |texts: &[String]| texts.iter().collect::<BTreeSet<_>>().len();
    if count(&names) == count(&hashes) {
        names
    } else {
        listed(|path, hash| format!("{} ({})", path.display(), hash.get(..6).unwrap_or(hash)))
    }
}

/// Some of the names, and how many more there are.
fn a_few(names: &BTreeSet<String>) -> String {
    const SHOWN: usize = 3;
    let shown = names.iter().take(SHOWN).cloned().collect::<Vec<_>>().join(", ");
    if names.len() > SHOWN { format!("{shown} and {} more", names.len() - SHOWN) } else { shown }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run with this seed, option ε, SUMO's words, and input files with their contents.
    fn run(seed: u32, epsilon: f64, words: &str, inputs: &[(&str, &str)]) -> LoggedRun {
        let inputs = inputs.iter().map(|(path, sha256)| serde_json::json!({ "path": path, "sha256": sha256 }));
        let record = serde_json::json!({
            "versions": { "closecall": "1", "sumo": "SUMO 1" },
            "scenario": "plan.sumocfg",
            "seed": seed.to_string(),
            "step_length": 0.5,
            "sumo_words": words.split(' ').collect::<Vec<_>>(),
            "inputs": inputs.collect::<Vec<_>>(),
            "options": { "epsilon": epsilon, "types": {} },
            "complete": true,
            "summary": { "begin": 0.0, "end": 1.0, "steps": 3, "conflicts": [], "collisions": 0,
                "exposure": { "vehicles": 0, "persons": 0, "vehicle_kilometres": 0.0, "vehicle_hours": 0.0 } },
        });
        serde_json::from_value(record).unwrap()
    }

    fn names(runs: &[LoggedRun]) -> Vec<(String, Vec<usize>)> {
        let found = Variants::of(&runs.iter().collect::<Vec<_>>());
        found.all.into_iter().map(|variant| (variant.name, variant.runs)).collect()
    }

    #[test]
    fn runs_that_differ_only_in_seed_and_outputs_are_one_variant() {
        let runs = [
            run(1, 0.5, "-c a/plan.sumocfg --seed 1 --scale 1.0 --fcd-output 1.xml", &[("a/plan.net.xml", "x")]),
            run(2, 0.5, "-c b/plan.sumocfg --seed=2 --scale=1 --no-warnings", &[("b/plan.net.xml", "x")]),
        ];
        assert_eq!(names(&runs), [(String::new(), vec![0, 1])]);
    }

    #[test]
    fn every_varied_option_tells_variants_apart() {
        let runs = [
            run(1, 10.0, "--scale=1", &[]),
            run(1, 2.0, "--scale=1.5", &[]),
            run(2, 2.0, "--scale 1.5", &[]),
            run(3, 2.0, "--time-to-teleport -1 --scale 1.5", &[]),
        ];
        assert_eq!(
            names(&runs),
            [
                ("epsilon=2, sumo:scale=1.5, sumo:time-to-teleport=-1".to_owned(), vec![3]),
                ("epsilon=2, sumo:scale=1.5, sumo:time-to-teleport=–".to_owned(), vec![1, 2]),
                ("epsilon=10, sumo:scale=1, sumo:time-to-teleport=–".to_owned(), vec![0]),
            ]
        );
    }

    #[test]
    fn inputs_that_differ_for_one_seed_tell_variants_apart() {
        let plan = |seed, net, path| run(seed, 0.5, "", &[(path, net), ("demand.rou.xml", &format!("d{seed}")[..])]);
        let runs = [plan(1, "x", "a/n.xml"), plan(2, "x", "a/n.xml"), plan(1, "y", "b/n.xml"), plan(2, "y", "b/n.xml")];
        let found = names(&runs);
        assert_eq!(
            found,
            [("inputs=a/n.xml (x)".to_owned(), vec![0, 1]), ("inputs=b/n.xml (y)".to_owned(), vec![2, 3])]
        );
        let files = |name| run(1, 0.5, "", &[(name, name)]);
        let of_names = names(&[files("left.sumocfg"), files("right.sumocfg")]);
        assert_eq!(
            of_names.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
            ["inputs=left.sumocfg", "inputs=right.sumocfg"]
        );
    }

    #[test]
    fn a_demand_for_every_seed_is_one_variant_and_noted() {
        let runs = [1, 2].map(|seed| run(seed, 0.5, "", &[(&format!("d{seed}.rou.xml")[..], &seed.to_string()[..])]));
        let found = Variants::of(&runs.iter().collect::<Vec<_>>());
        assert_eq!((found.all.len(), found.varied.len()), (1, 0));
        assert!(found.notes[0].contains("(d1.rou.xml, d2.rou.xml)"), "{:?}", found.notes);
    }
}
