//! The tables of two sets of runs: how they differ, how many runs that takes, and what observed crashes say.

use super::cells::{Cell, Table};
use crate::statistics::{Comparison, PerYear, PlannedGroup, Ratio, RunPlan, Significance, Test, Transferred};

fn significance(found: Option<Significance>) -> [Cell; 3] {
    let test = found.map_or(Cell::None, |found| match found.test {
        Test::ExactPermutation => "exact permutation".into(),
        Test::SampledPermutation => "sampled permutation".into(),
    });
    [Cell::maybe(found.map(|found| found.p)), Cell::maybe(found.map(|found| found.p_holm)), test]
}

pub(super) fn rate_differences(comparison: &Comparison) -> Table {
    let rows = comparison.rates.iter().map(|row| {
        let ratio = |get: fn(&Ratio) -> Option<f64>| Cell::maybe(row.ratio.as_ref().and_then(get));
        let values = [row.rate, row.against, row.difference].map(Cell::Number);
        let ratio = [ratio(|ratio| ratio.value), ratio(|ratio| Some(ratio.low)), ratio(|ratio| ratio.high)];
        std::iter::once(row.group.into())
            .chain(values)
            .chain(ratio)
            .chain(significance(row.significance))
            .chain([Cell::maybe(row.detectable)])
            .collect()
    });
    Table {
        title: "compared rates",
        columns: vec![
            "group",
            "rate",
            "against",
            "difference",
            "ratio",
            "low",
            "high",
            "p",
            "p (Holm)",
            "test",
            "found at 80 %",
        ],
        rows: rows.collect(),
        notes: [format!("rates per {}", comparison.rates_per), DETECTABLE.to_owned()]
            .into_iter()
            .chain(comparison.note.clone())
            .collect(),
    }
}

/// What the last column of compared rates is.
const DETECTABLE: &str =
    "found at 80 %: the ratio, or its inverse, that 80 of 100 comparisons of this size would find (one test at 5 %)";

/// The runs that a comparison needs.
pub(super) fn planned(plan: &RunPlan) -> Table {
    let count = |runs: Option<usize>| runs.map_or(Cell::None, |runs| Cell::Count(runs as u64));
    let row = |group: &PlannedGroup| {
        let needed = [group.runs, group.low, group.high].map(count);
        let head = [group.group.into(), Cell::Number(group.spread)];
        head.into_iter().chain(needed).chain([Cell::maybe(group.power)]).collect()
    };
    let mut notes = vec![format!(
        "to find a ratio of {} or {} in {:.0} of 100 comparisons, by one test at {:.0} %; Holm's correction for several needs more",
        plan.ratio,
        Cell::Number(1.0 / plan.ratio).rounded(),
        100.0 * plan.power,
        100.0 * plan.level
    )];
    notes.push(
        "spread: standard deviation of a run's rate / the rate; low, high: 95 %, as so few runs tell the spread"
            .to_owned(),
    );
    if plan.groups.iter().any(|group| group.is_poisson) {
        notes.push(
            "one run, or equal ones, tell no spread: taken as independent conflicts, which needs too few runs"
                .to_owned(),
        );
    }
    Table {
        title: "runs needed in each set",
        columns: vec!["group", "spread", "runs", "low", "high", "power now"],
        rows: plan.groups.iter().map(row).collect(),
        notes,
    }
}

/// The crashes to be expected, from observed ones.
pub(super) fn transferred(found: &Transferred) -> Table {
    let row = |name: &str, power: Cell, per_year: PerYear| {
        let ends = [per_year.value, per_year.low, per_year.high].map(Cell::Number);
        [name.into(), power].into_iter().chain(ends).collect()
    };
    let [answer, others @ ..] = &found.powers[..] else { return Table::default() };
    let mut rows = vec![
        row("against, as observed", Cell::None, found.against),
        row("first set", Cell::Number(answer.power), answer.per_year),
        row("if only the observed number were uncertain", Cell::Number(answer.power), found.by_observed),
        row("if only the ratio of conflicts were", Cell::Number(answer.power), found.by_ratio),
    ];
    rows.extend(others.iter().map(|one| row("first set, other power", Cell::Number(one.power), one.per_year)));
    let notes = vec![
        format!(
            "{} crashes in {} years, times the ratio of conflicts to the power; low, high: 95 %",
            found.observed, found.years
        ),
        "that crashes go with this power of conflicts is an assumption, and in no interval".to_owned(),
    ];
    Table {
        title: "crashes per year, from observed ones",
        columns: vec!["crashes", "power", "per year", "low", "high"],
        rows,
        notes,
    }
}

pub(super) fn measure_differences(comparison: &Comparison) -> Table {
    let rows = comparison.measures.iter().map(|row| {
        let values = [row.median, row.against, row.difference, row.cliffs_delta].map(Cell::maybe);
        std::iter::once(row.measure.into()).chain(values).chain(significance(row.significance)).collect()
    });
    Table {
        title: "compared medians",
        columns: vec!["measure", "median", "against", "difference", "Cliff's delta", "p", "p (Holm)", "test"],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}
