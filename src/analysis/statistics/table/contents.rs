//! The contents of the tables.

use super::cells::{Cell, Table};
use crate::analysis::statistics::{
    Comparison, Extrapolation, GroupStatistics, HotSpot, IntervalMethod, Quantiles, RankedConflict, Rate, Significance,
    Statistics, Test, Traffic,
};

/// A measure's name in the table, and its quantiles.
type QuantileRow = (&'static str, fn(&GroupStatistics) -> &Quantiles);

const MEASURES: [QuantileRow; 4] = [
    ("TTC s", |group| &group.ttc),
    ("PET s", |group| &group.pet),
    ("margin m", |group| &group.margin),
    ("delta-v m/s", |group| &group.delta_v),
];

/// All tables of the statistics, in reading order.
pub fn tables(statistics: &Statistics) -> Vec<Table> {
    let mut tables = vec![traffic(statistics.runs, &statistics.traffic), rates(&statistics.groups)];
    tables[0].notes = statistics.left_out.iter().map(|log| format!("{}: {}", log.folder.display(), log.why)).collect();
    tables.push(quantiles(&statistics.groups));
    tables.push(spots("edges", &statistics.edges));
    tables.push(spots("junctions", &statistics.junctions));
    tables.push(worst(&statistics.worst));
    tables.push(extremes(&statistics.extremes));
    if let Some(comparison) = &statistics.comparison {
        tables.extend([rate_differences(comparison), measure_differences(comparison)]);
    }
    tables.retain(|table| !table.rows.is_empty());
    tables
}

fn traffic(runs: usize, traffic: &Traffic) -> Table {
    Table {
        title: "traffic",
        columns: vec!["runs", "hours", "vehicles", "persons", "vehicle-km", "vehicle-hours"],
        rows: vec![vec![
            Cell::Count(runs as u64),
            Cell::Number(traffic.hours),
            Cell::Count(traffic.vehicles),
            Cell::Count(traffic.persons),
            Cell::Number(traffic.vehicle_kilometres),
            Cell::Number(traffic.vehicle_hours),
        ]],
        notes: Vec::new(),
    }
}

fn with_interval(rate: Option<Rate>) -> [Cell; 3] {
    [rate.map(|rate| rate.value), rate.map(|rate| rate.low), rate.map(|rate| rate.high)].map(Cell::maybe)
}

fn rates(groups: &[GroupStatistics]) -> Table {
    let rows = groups.iter().map(|group| {
        let head = [Cell::Text(group.group.clone()), Cell::Count(group.count), Cell::Count(group.collisions)];
        let rates = [group.rates.per_hour, group.rates.per_vehicle_kilometre, group.rates.per_1000_vehicles];
        head.into_iter().chain(rates.into_iter().flat_map(with_interval)).collect()
    });
    let rows = rows.collect();
    let all = groups.iter().filter_map(|group| group.rates.per_hour);
    let one = all.clone().any(|rate| rate.method == IntervalMethod::PoissonExact);
    let several = all.clone().any(|rate| rate.method == IntervalMethod::TOverRuns);
    let note = match (several, one) {
        (true, false) => "low, high: 95 % interval, t over runs",
        (true, true) => "low, high: 95 % interval, t over runs; where the runs do not differ, Poisson's exact",
        _ => "low, high: 95 % interval, Poisson's exact, which assumes independent conflicts",
    };
    Table {
        title: "rates",
        columns: vec![
            "group",
            "conflicts",
            "collisions",
            "per hour",
            "low",
            "high",
            "per vehicle-km",
            "low",
            "high",
            "per 1000 vehicles",
            "low",
            "high",
        ],
        rows,
        notes: vec![note.to_owned()],
    }
}

fn quantiles(groups: &[GroupStatistics]) -> Table {
    let rows = groups.iter().flat_map(|group| {
        MEASURES.iter().map(|(name, of)| {
            let found = of(group);
            let shares = [found.q05, found.q25, found.q50, found.q75, found.q95].map(Cell::maybe);
            let head = [Cell::Text(group.group.clone()), (*name).into(), Cell::Count(found.count)];
            head.into_iter().chain(shares).collect()
        })
    });
    Table {
        title: "quantiles",
        columns: vec!["group", "measure", "conflicts", "5 %", "25 %", "50 %", "75 %", "95 %"],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}

fn spots(title: &'static str, spots: &[HotSpot]) -> Table {
    let rows = spots.iter().map(|spot| {
        let counts = [spot.count, spot.serious, spot.critical].map(Cell::Count);
        let rates = [spot.per_hour, spot.per_1000_vehicles].into_iter().flat_map(with_interval);
        std::iter::once(Cell::Text(spot.id.clone())).chain(counts).chain(rates).collect()
    });
    Table {
        title,
        columns: vec![
            "id",
            "conflicts",
            "serious",
            "critical",
            "per hour",
            "low",
            "high",
            "per 1000 vehicles",
            "low",
            "high",
        ],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}

fn worst(worst: &[RankedConflict]) -> Table {
    let row = |(rank, found): (usize, &RankedConflict)| {
        let conflict = &found.conflict;
        vec![
            Cell::Count(rank as u64 + 1),
            Cell::Text(found.seed.clone().unwrap_or_default()),
            Cell::Number(conflict.time),
            conflict.kind.name().into(),
            if conflict.collision { "collision" } else { conflict.severity.name() }.into(),
            Cell::Text(conflict.ego.clone()),
            Cell::Text(conflict.foe.clone()),
            Cell::Text(conflict.lane.clone()),
            Cell::Number(conflict.x),
            Cell::Number(conflict.y),
            Cell::maybe(conflict.ttc),
            Cell::maybe(conflict.pet),
            Cell::Number(conflict.margin),
        ]
    };
    let notes = worst
        .iter()
        .enumerate()
        .filter_map(|(rank, found)| found.command.as_ref().map(|command| format!("{}: {command}", rank + 1)));
    Table {
        title: "worst",
        columns: vec![
            "rank", "seed", "time s", "kind", "severity", "ego", "foe", "lane", "x m", "y m", "TTC s", "PET s",
            "margin m",
        ],
        rows: worst.iter().enumerate().map(row).collect(),
        notes: notes.collect(),
    }
}

fn extremes(extremes: &[Extrapolation]) -> Table {
    let row = |found: &Extrapolation| {
        let of = |get: fn(&crate::analysis::statistics::Crashes) -> f64| Cell::maybe(found.crashes.as_ref().map(get));
        vec![
            found.quantity.into(),
            Cell::Count(found.conflicts),
            of(|crashes| crashes.per_hour),
            of(|crashes| crashes.low),
            of(|crashes| crashes.high),
            of(|crashes| crashes.threshold),
            found.crashes.map_or(Cell::None, |crashes| Cell::Count(crashes.below)),
            of(|crashes| crashes.shape),
            of(|crashes| crashes.scale),
            of(|crashes| crashes.anderson_darling),
            of(|crashes| crashes.p_value),
        ]
    };
    let refused =
        extremes.iter().filter_map(|found| Some(format!("{}: refused: {}", found.quantity, found.refused.as_ref()?)));
    Table {
        title: "crashes, extrapolated",
        columns: vec![
            "from",
            "conflicts",
            "per hour",
            "low",
            "high",
            "threshold",
            "below",
            "shape",
            "scale",
            "A2",
            "p of fit",
        ],
        rows: extremes.iter().map(row).collect(),
        notes: refused.collect(),
    }
}

fn significance(found: Option<Significance>) -> [Cell; 3] {
    let test = found.map_or(Cell::None, |found| match found.test {
        Test::ExactPermutation => "exact permutation".into(),
        Test::SampledPermutation => "sampled permutation".into(),
    });
    [Cell::maybe(found.map(|found| found.p)), Cell::maybe(found.map(|found| found.p_holm)), test]
}

fn rate_differences(comparison: &Comparison) -> Table {
    let rows = comparison.rates.iter().map(|row| {
        let ratio =
            |get: fn(&crate::analysis::statistics::Ratio) -> Option<f64>| Cell::maybe(row.ratio.as_ref().and_then(get));
        let values = [row.rate, row.against, row.difference].map(Cell::Number);
        let ratio = [ratio(|ratio| ratio.value), ratio(|ratio| Some(ratio.low)), ratio(|ratio| ratio.high)];
        std::iter::once(row.group.into()).chain(values).chain(ratio).chain(significance(row.significance)).collect()
    });
    Table {
        title: "compared rates",
        columns: vec!["group", "rate", "against", "difference", "ratio", "low", "high", "p", "p (Holm)", "test"],
        rows: rows.collect(),
        notes: std::iter::once(format!("rates per {}", comparison.rates_per)).chain(comparison.note.clone()).collect(),
    }
}

fn measure_differences(comparison: &Comparison) -> Table {
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
