//! The statistics that fit a screen of 80 columns and 40 lines, and the commands that show more.

use super::cells::{Cell, Table};
use super::contents::{quantiles, rates, spots, traffic, worst};
use super::text::text;
use crate::statistics::{Crashes, Extrapolation, Statistics};

/// The columns of a screen.
const WIDTH: usize = 80;
/// The rows of the lists of worst conflicts and of hot spots.
const ROWS: usize = 3;
/// The rows of the table of rates: all, and the three kinds.
const RATES: usize = 4;
/// Longer ids are cut to this many letters.
const ID: usize = 14;

/// The columns of each table: the name, and how many of those after it belong to it.
const TRAFFIC: &[(&str, usize)] = &[("runs", 5)];
const PER_KILOMETRE: &[(&str, usize)] = &[("group", 2), ("per vehicle-km", 2)];
const QUANTILES: &[(&str, usize)] = &[("group", 7)];
const SPOTS: &[(&str, usize)] = &[("id", 3), ("risk index", 2)];
const WORST: &[(&str, usize)] = &[("rank", 0), ("time s", 4), ("TTC s", 0), ("margin m", 0)];

/// The statistics of one variant in short; `logs` are the words that name the logs on a command line.
pub fn brief(statistics: &Statistics, logs: &str) -> String {
    let Statistics { groups, edges, junctions, .. } = statistics;
    let (title, places) = if junctions.is_empty() { ("edges", edges) } else { ("junctions", junctions) };
    let mut rates = picked(rates(&groups[..groups.len().min(RATES)]), PER_KILOMETRE);
    rates.notes.extend(statistics.risk_index_per_vehicle_kilometre.map(|rate| {
        let [value, low, high] = [rate.value, rate.low, rate.high].map(|it| Cell::Number(it).rounded());
        format!("risk index per vehicle-km {value} ({low} to {high}); not a number of crashes")
    }));
    let mut worst = picked(worst(&statistics.worst[..statistics.worst.len().min(ROWS)]), WORST);
    worst.notes.clear();
    let mut tables = vec![
        picked(traffic(statistics), TRAFFIC),
        rates,
        picked(quantiles(&groups[..groups.len().min(1)]), QUANTILES),
        picked(spots(title, &places[..places.len().min(ROWS)]), SPOTS),
        worst,
        crashes(&statistics.extremes),
    ];
    tables.retain(|table| !table.rows.is_empty() || (table.columns.is_empty() && !table.notes.is_empty()));
    tables.iter_mut().for_each(|table| table.notes = table.notes.iter().map(|note| wrapped(note)).collect());
    let show = statistics.worst.first().and_then(|worst| worst.command.as_ref());
    let show = show.map(|command| format!("the worst: {command}\n")).unwrap_or_default();
    format!("{}{show}all tables: closecall stats {logs} --all\non a map: closecall report {logs}\n", text(&tables))
}

/// The table with these columns alone, and with short ids.
fn picked(table: Table, columns: &[(&str, usize)]) -> Table {
    let place = |name: &str| table.columns.iter().position(|column| *column == name);
    let places = columns.iter().filter_map(|(name, more)| place(name).map(|first| first..=first + more));
    let places = places.flatten().filter(|place| *place < table.columns.len()).collect::<Vec<_>>();
    let row = |row: &Vec<Cell>| places.iter().filter_map(|place| row.get(*place)).map(short).collect();
    Table {
        title: table.title,
        columns: places.iter().map(|place| table.columns[*place]).collect(),
        rows: table.rows.iter().map(row).collect(),
        notes: table.notes,
    }
}

/// The frequencies, and those that are refused, in a sentence.
fn crashes(extremes: &[Extrapolation]) -> Table {
    let told = |found: &Extrapolation| {
        let Crashes { per_hour, low, high, .. } = found.crashes?;
        let [value, low, high] = [per_hour, low, high].map(|it| Cell::Number(it).rounded());
        Some(format!("{value} ({low} to {high}) from {}", found.quantity))
    };
    let told = extremes.iter().filter_map(told).collect::<Vec<_>>().join(", ");
    let told = (!told.is_empty()).then(|| format!("crashes per hour, extrapolated: {told}"));
    let refused = extremes.iter().filter(|found| found.refused.is_some()).map(|found| found.quantity);
    let refused = refused.collect::<Vec<_>>().join(", ");
    let refused = (!refused.is_empty()).then(|| format!("no crashes extrapolated from {refused} (--all says why)"));
    let sentence = told.into_iter().chain(refused).collect::<Vec<_>>().join("; ");
    Table { notes: Some(sentence).filter(|it| !it.is_empty()).into_iter().collect(), ..Table::default() }
}

fn short(cell: &Cell) -> Cell {
    match cell {
        Cell::Text(text) if text.chars().count() > ID => Cell::Text(text.chars().take(ID - 1).chain(['…']).collect()),
        other => other.clone(),
    }
}

/// A note in lines of the screen's width.
fn wrapped(note: &str) -> String {
    let mut lines = vec![String::new()];
    for word in note.split(' ') {
        let line = lines.len() - 1;
        if lines[line].is_empty() {
            lines[line].push_str(word);
        } else if lines[line].chars().count() + 1 + word.chars().count() <= WIDTH {
            lines[line] += &format!(" {word}");
        } else {
            lines.push(format!("  {word}"));
        }
    }
    lines.join("\n")
}
