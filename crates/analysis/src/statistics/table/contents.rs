//! The contents of the tables.

use super::cells::{Cell, Table};
use super::two_sets::{measure_differences, planned, rate_differences, transferred};
use crate::statistics::{
    Extrapolation, GroupStatistics, HotSpot, IntervalMethod, Quantiles, RankedConflict, Rate, Ratio, Statistics,
    VariantStatistics,
};

/// A measure's name in the table, and its quantiles.
type QuantileRow = (&'static str, fn(&GroupStatistics) -> &Quantiles);
/// A rate's name in the table of places, and its value.
type SpotRate = (&'static str, fn(&HotSpot) -> Option<Rate>);

const MEASURES: [QuantileRow; 4] = [
    ("TTC s", |group| &group.ttc),
    ("PET s", |group| &group.pet),
    ("margin m", |group| &group.margin),
    ("delta-v m/s", |group| &group.delta_v),
];

/// All tables of the statistics, in reading order.
pub fn tables(statistics: &Statistics) -> Vec<Table> {
    let mut tables = vec![traffic(statistics), set_aside(statistics), rates(&statistics.groups), ratios(statistics)];
    tables.extend(statistics.risk_index_per_vehicle_kilometre.map(risk));
    tables.push(quantiles(&statistics.groups));
    tables.push(spots("edges", &statistics.edges));
    tables.push(spots("junctions", &statistics.junctions));
    if let [_, _, ..] = statistics.variants[..] {
        let spots = tables.iter_mut().filter(|table| ["edges", "junctions"].contains(&table.title));
        spots.for_each(|table| {
            table.notes.push("counts of all variants together, which have no common rate".to_owned())
        });
    }
    tables.push(worst(&statistics.worst));
    tables.push(extremes(&statistics.extremes));
    if let Some(comparison) = &statistics.comparison {
        tables.extend([rate_differences(comparison), measure_differences(comparison)]);
    }
    tables.extend(statistics.plan.as_ref().map(planned));
    tables.extend(statistics.transferred.as_ref().map(transferred));
    tables.retain(|table| !table.rows.is_empty() || (table.columns.is_empty() && !table.notes.is_empty()));
    tables
}

/// A column for the variant, where there are several.
fn variant_column<'a>(variants: impl IntoIterator<Item = &'a Option<String>>) -> Option<&'static str> {
    variants.into_iter().any(Option::is_some).then_some("variant")
}

fn variant_cell(variant: &Option<String>) -> Option<Cell> {
    variant.clone().map(Cell::Text)
}

/// The traffic of each variant.
pub(super) fn traffic(statistics: &Statistics) -> Table {
    let several = statistics.variants.len() > 1;
    let row = |of_variant: &VariantStatistics| {
        let traffic = &of_variant.traffic;
        let name = several.then(|| Cell::Text(of_variant.variant.name.clone()));
        // That of a part of the runs is not known.
        let known = |cell: Cell| if traffic.vehicle_hours > 0.0 { cell } else { Cell::None };
        let cells = [
            Cell::Count(of_variant.runs as u64),
            Cell::Number(traffic.hours),
            known(Cell::Count(traffic.vehicles)),
            known(Cell::Count(traffic.persons)),
            known(Cell::Number(traffic.vehicle_kilometres)),
            known(Cell::Number(traffic.vehicle_hours)),
        ];
        name.into_iter().chain(cells).collect()
    };
    let names = ["runs", "hours", "vehicles", "persons", "vehicle-km", "vehicle-hours"];
    let differ = format!("the runs differ in {}: each variant has rates of its own", statistics.varied.join(", "));
    let left_out = statistics.left_out.iter().map(|log| format!("{}: {}", log.folder.display(), log.why));
    Table {
        title: "traffic",
        columns: several.then_some("variant").into_iter().chain(names).collect(),
        rows: statistics.variants.iter().map(row).collect(),
        notes: several.then_some(differ).into_iter().chain(statistics.notes.clone()).chain(left_out).collect(),
    }
}

/// The conflicts that are not counted.
fn set_aside(statistics: &Statistics) -> Table {
    let row = |(artefact, count): (&String, &u64)| vec![Cell::Text(artefact.clone()), Cell::Count(*count)];
    Table {
        title: "set aside",
        columns: vec!["artefact", "conflicts"],
        rows: statistics.set_aside.iter().map(row).collect(),
        notes: Vec::new(),
    }
}

/// The rates of the variants beside those of the first.
fn ratios(statistics: &Statistics) -> Table {
    let row = |group: &GroupStatistics| {
        let Ratio { value, low, high, method } = group.ratio.as_ref()?.ratio;
        let method = match method {
            IntervalMethod::TOverPairs => "t over pairs",
            IntervalMethod::TOverRuns => "t over runs",
            IntervalMethod::PoissonExact => "counts",
            IntervalMethod::WeightedEvents => "weighted events",
        };
        let ends = [value, Some(low), high].map(Cell::maybe);
        let head = [variant_cell(&group.variant)?, Cell::Text(group.group.clone())];
        Some(head.into_iter().chain(ends).chain([method.into()]).collect())
    };
    let first = statistics.variants.first().map(|first| format!("rates / those of {}", first.variant.name));
    let pairs = "low, high: 95 % interval; t over pairs: of runs with the same seed".to_owned();
    Table {
        title: "compared variants",
        columns: vec!["variant", "group", "ratio", "low", "high", "interval"],
        rows: statistics.groups.iter().filter_map(row).collect(),
        notes: first.into_iter().chain([pairs]).collect(),
    }
}

fn with_interval(rate: Option<Rate>) -> [Cell; 3] {
    [rate.map(|rate| rate.value), rate.map(|rate| rate.low), rate.map(|rate| rate.high)].map(Cell::maybe)
}

pub(super) fn rates(groups: &[GroupStatistics]) -> Table {
    let rows = groups.iter().map(|group| {
        let head = [Cell::Text(group.group.clone()), Cell::Count(group.count), Cell::Count(group.collisions)];
        let head = variant_cell(&group.variant).into_iter().chain(head);
        let rates = [group.rates.per_hour, group.rates.per_vehicle_kilometre, group.rates.per_1000_vehicles];
        head.chain(rates.into_iter().flat_map(with_interval)).collect()
    });
    let rows = rows.collect();
    let names = [
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
    ];
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
        columns: variant_column(groups.iter().map(|group| &group.variant)).into_iter().chain(names).collect(),
        rows,
        notes: vec![note.to_owned()],
    }
}

fn risk(rate: Rate) -> Table {
    Table {
        title: "risk index",
        columns: vec!["per", "risk index", "low", "high"],
        rows: vec![std::iter::once("vehicle-km".into()).chain(with_interval(Some(rate))).collect()],
        notes: vec![
            "the sum of crash probabilities: compares plans with the same steps; not a number of crashes".to_owned(),
        ],
    }
}

pub(super) fn quantiles(groups: &[GroupStatistics]) -> Table {
    let names = ["group", "measure", "conflicts", "5 %", "25 %", "50 %", "75 %", "95 %"];
    let rows = groups.iter().flat_map(|group| {
        MEASURES.iter().map(|(name, of)| {
            let found = of(group);
            let shares = [found.q05, found.q25, found.q50, found.q75, found.q95].map(Cell::maybe);
            let head = [Cell::Text(group.group.clone()), (*name).into(), Cell::Count(found.count)];
            variant_cell(&group.variant).into_iter().chain(head).chain(shares).collect()
        })
    });
    Table {
        title: "quantiles",
        columns: variant_column(groups.iter().map(|group| &group.variant)).into_iter().chain(names).collect(),
        rows: rows.collect(),
        notes: Vec::new(),
    }
}

pub(super) fn spots(title: &'static str, spots: &[HotSpot]) -> Table {
    let is_entered = spots.iter().any(|spot| spot.risk_index_per_1000_entering.is_some());
    let rates: [SpotRate; 4] = [
        ("risk index", |spot| spot.risk_index),
        ("risk per 1000 entering", |spot| spot.risk_index_per_1000_entering),
        ("per hour", |spot| spot.per_hour),
        ("per 1000 vehicles", |spot| spot.per_1000_vehicles),
    ];
    let rates =
        rates.into_iter().filter(|(name, _)| is_entered || *name != "risk per 1000 entering").collect::<Vec<_>>();
    let row = |spot: &HotSpot| {
        let counts = [spot.count, spot.serious, spot.critical].map(Cell::Count);
        let rates = rates.iter().flat_map(|(_, rate)| with_interval(rate(spot)));
        std::iter::once(Cell::Text(spot.id.clone())).chain(counts).chain(rates).collect()
    };
    Table {
        title,
        rows: spots.iter().map(row).collect(),
        columns: ["id", "conflicts", "serious", "critical"]
            .into_iter()
            .chain(rates.iter().flat_map(|(name, _)| [*name, "low", "high"]))
            .collect(),
        notes: Vec::new(),
    }
}

pub(super) fn worst(worst: &[RankedConflict]) -> Table {
    let row = |(rank, found): (usize, &RankedConflict)| {
        let conflict = &found.conflict;
        let cells = [
            Cell::Count(rank as u64 + 1),
            Cell::Text(found.seed.clone().unwrap_or_default()),
            Cell::Number(conflict.time),
            conflict.kind.name().into(),
            if conflict.collision { "collision" } else { conflict.severity.name() }.into(),
            Cell::Text(conflict.ego.to_string()),
            Cell::Text(conflict.foe.to_string()),
            Cell::Text(conflict.lane.to_string()),
            Cell::Number(conflict.x),
            Cell::Number(conflict.y),
            Cell::maybe(conflict.ttc),
            Cell::maybe(conflict.pet),
            Cell::Number(conflict.margin),
        ];
        cells.into_iter().chain(variant_cell(&found.variant)).collect()
    };
    let names = [
        "rank", "seed", "time s", "kind", "severity", "ego", "foe", "lane", "x m", "y m", "TTC s", "PET s", "margin m",
    ];
    let notes = worst
        .iter()
        .enumerate()
        .filter_map(|(rank, found)| found.command.as_ref().map(|command| format!("{}: {command}", rank + 1)));
    Table {
        title: "worst",
        columns: names.into_iter().chain(variant_column(worst.iter().map(|found| &found.variant))).collect(),
        rows: worst.iter().enumerate().map(row).collect(),
        notes: notes.collect(),
    }
}

fn extremes(extremes: &[Extrapolation]) -> Table {
    let row = |found: &Extrapolation| {
        let of = |get: fn(&crate::statistics::Crashes) -> f64| Cell::maybe(found.crashes.as_ref().map(get));
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
    let refused = refusals(extremes);
    let found = extremes.iter().filter(|found| found.crashes.is_some()).map(row).collect::<Vec<_>>();
    if found.is_empty() {
        return Table { title: "crashes, extrapolated", notes: refused.into_iter().collect(), ..Table::default() };
    }
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
        rows: found,
        notes: refused.into_iter().collect(),
    }
}

/// The frequencies that cannot be computed, and why, in a line.
fn refusals(extremes: &[Extrapolation]) -> Option<String> {
    let mut whys: Vec<(&str, Vec<&str>)> = Vec::new();
    for found in extremes {
        let Some(why) = &found.refused else { continue };
        match whys.iter_mut().find(|(known, _)| known == why) {
            Some((_, quantities)) => quantities.push(found.quantity),
            None => whys.push((why, vec![found.quantity])),
        }
    }
    let whys = whys.iter().map(|(why, quantities)| format!("from {}: {why}", quantities.join(", ")));
    let whys = whys.collect::<Vec<_>>().join("; ");
    (!whys.is_empty()).then(|| format!("no crashes extrapolated {whys}"))
}
