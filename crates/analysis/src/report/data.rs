//! The page's data as JSON: columns instead of rows, numbers rounded, repeated words once.

use std::fmt::Write;
use std::path::PathBuf;

use rustc_hash::{FxHashMap, FxHashSet};
use serde_json::{Map, Value, json};

use super::contact::parts;
use super::movements::Movements;
use super::streets::Streets;
use super::tiles::TileUrl;
use super::{clips, faults, page_net, reading, remarks};
use crate::Result;
use crate::dataset::Conflicts;
use crate::dataset::kept::RunConflict;
use crate::filter::NamedPlaces;
use crate::statistics::Effects;
use closecall::detection::kind::{Kind, Severity};
use closecall::events::Cause;
use closecall::options::Options;
use closecall::traffic::net::{EdgeFunction, Net};
use closecall_run::output::schema::{COLUMNS, Column, ColumnType, LoggedConflict, Presence, Value as Cell};

/// For how many of the worst conflicts a page has more than a row of values.
#[derive(Clone, Copy, Debug)]
pub(super) struct Details {
    /// Conflicts with both rectangles and paths.
    drawn: usize,
    /// Conflicts with clips, as long as these take no more than `clip_bytes`.
    played: usize,
    clip_bytes: usize,
}

impl Details {
    /// Those of the report.
    pub const REPORT: Self = Self { drawn: 2_000, played: 100, clip_bytes: 2_000_000 };

    /// Those of a report with as many clips as were asked for, however long the page becomes.
    pub const fn with_clips(self, played: usize) -> Self {
        Self { played, clip_bytes: usize::MAX, ..self }
    }

    /// Those of the summary: the worst one's clip, which says when the two touched.
    pub const SUMMARY: Self = Self { drawn: 0, played: 1, clip_bytes: 2_000_000 };
}

/// The number column that nothing on the page shows.
const NOT_SHOWN: &str = "clearance";

/// All of the page's data. It contains no `<`, which could end the script around it. Each column becomes text at once, because
/// a JSON value takes four times the memory of a number.
///
/// # Errors
/// Those of reading the clips.
pub(super) fn json(
    found: Conflicts,
    before: Option<Value>,
    details: Details,
    tiles: Option<&TileUrl>,
) -> Result<String> {
    let Conflicts { logs, records, variants, mut ground, mut conflicts, seen, set_aside, filter, scope, named, .. } =
        found;
    let worst = &conflicts[..conflicts.len().min(details.played)];
    let mut played = clips::of_worst(worst, &logs, details.clip_bytes, &mut ground)?;
    let key = |one: &RunConflict| (one.run, one.conflict.id);
    let drawn = conflicts.iter().take(details.drawn).map(key).collect::<FxHashSet<_>>();
    conflicts.sort_unstable_by_key(key);
    let drawn = (0..).zip(&conflicts).filter(|(_, one)| drawn.contains(&key(one))).filter_map(drawing);
    let drawn = drawn.collect::<Vec<_>>();
    let net = ground.net.as_ref();
    let clip = |(row, one): (usize, &RunConflict)| Some(json!([row, played.remove(&key(one))?]));
    let played = (0..).zip(&conflicts).filter_map(clip).collect::<Vec<_>>();
    let data = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "seen": seen,
        "kinds": Kind::ALL.map(Kind::name),
        "severities": Severity::ALL.map(Severity::name),
        "clips": played,
        "reading": reading::json(&records),
        "remarks": remarks::json(&records),
        "scope": scope,
        "places": named.as_ref().map(|named| &*named.all),
        "tiles": tiles.map(|tiles| tiles.json(net)).transpose()?,
        "runs": runs(&logs, records),
        "variants": variants.iter().map(|variant| json!({ "name": variant.name, "runs": variant.runs })).collect::<Vec<_>>(),
        "defaults": Options::default(),
        "net": net.map(page_net::json),
        "net_faults": faults::json(&logs)?,
        "notes": ground.notes,
        "before": before,
        "filter": filter,
        "set_aside": set_aside,
    });
    let mut text = "{\"conflicts\":".to_owned();
    columns(&mut text, &conflicts, drawn, net, named.as_ref());
    drop(conflicts);
    text.push(',');
    push(&mut text, &data.to_string()[1..]);
    Ok(text)
}

/// Appends JSON without a `<`.
fn push(text: &mut String, json: &str) {
    for (place, part) in json.split('<').enumerate() {
        text.push_str(if place > 0 { "\\u003c" } else { "" });
        text.push_str(part);
    }
}

/// The runs that the report compares with: how the rates differ, and where their conflicts are.
pub fn before(effects: &Effects, found: &Conflicts) -> Value {
    let conflicts = || found.conflicts.iter().map(|one| &one.conflict);
    // An artefact is not a danger, on either side.
    let of_traffic = |conflict: &LoggedConflict| conflict.crash_probability.filter(|_| conflict.artefact.is_empty());
    let probability = |conflict: &LoggedConflict| rounded(of_traffic(conflict).unwrap_or_default(), 5);
    json!({
        "effects": effects,
        "x": conflicts().map(|conflict| rounded(conflict.x, 1)).collect::<Vec<_>>(),
        "y": conflicts().map(|conflict| rounded(conflict.y, 1)).collect::<Vec<_>>(),
        "severity": conflicts().map(|conflict| rank(&Severity::ALL, conflict.severity)).collect::<Vec<_>>(),
        "crash_probability": conflicts().map(probability).collect::<Vec<_>>(),
    })
}

/// Each run's record, and where it was found.
fn runs(logs: &[PathBuf], records: Vec<Value>) -> Vec<Value> {
    let with_folder = |(record, log): (Value, &PathBuf)| {
        let mut record = if let Value::Object(record) = record { record } else { Map::new() };
        record.insert("folder".to_owned(), Value::from(log.display().to_string()));
        Value::Object(record)
    };
    records.into_iter().zip(logs).map(with_folder).collect()
}

/// Words that repeat: a column holds their places in the list.
#[derive(Default)]
struct Words<'a> {
    list: Vec<&'a str>,
    places: FxHashMap<&'a str, usize>,
}

impl<'a> Words<'a> {
    fn place(&mut self, word: &'a str) -> usize {
        *self.places.entry(word).or_insert_with(|| {
            self.list.push(word);
            self.list.len() - 1
        })
    }
}

/// Writes columns of values that are no texts.
struct ColumnWriter<'a> {
    text: &'a mut String,
}

impl ColumnWriter<'_> {
    /// Appends a column; one with the same value in every row becomes that value.
    fn add<T: Into<Value>>(&mut self, name: &str, values: impl Iterator<Item = T>) {
        let Self { text } = self;
        let comma = if text.ends_with('{') { "" } else { "," };
        text.extend([comma, "\"", name, "\":"]);
        let mut values = values.map(Into::into);
        let first = values.next().unwrap_or_else(|| Value::Array(Vec::new()));
        let mut same = 1;
        let other = values.find(|value| {
            let is_same = *value == first;
            same += usize::from(is_same);
            !is_same
        });
        let first = first.to_string();
        let Some(other) = other else { return text.push_str(&first) };
        text.push('[');
        text.extend(std::iter::repeat_n([&*first, ","], same).flatten());
        text.push_str(&other.to_string());
        for value in values {
            // Writing to a text cannot fail.
            let _ = write!(text, ",{value}");
        }
        text.push(']');
    }
}

/// Appends the conflicts, a column after the other, and the lists of the words that repeat.
fn columns(text: &mut String, rows: &[RunConflict], drawn: Vec<Value>, net: Option<&Net>, named: Option<&NamedPlaces>) {
    text.push_str("{\"columns\":{");
    let mut columns = ColumnWriter { text };
    let conflicts = || rows.iter().map(|row| &row.conflict);
    let mut ids = Words::default();
    columns.add("ego", conflicts().map(|conflict| ids.place(&conflict.ego)));
    columns.add("foe", conflicts().map(|conflict| ids.place(&conflict.foe)));
    let mut types = Words::default();
    columns.add("ego_type", conflicts().map(|conflict| types.place(&conflict.ego_type)));
    columns.add("foe_type", conflicts().map(|conflict| types.place(&conflict.foe_type)));
    let [mut nearness, mut consequences, mut artefacts] = <[Words; 3]>::default();
    columns.add("nearness", conflicts().map(|conflict| nearness.place(&conflict.nearness)));
    columns.add("consequence", conflicts().map(|conflict| consequences.place(&conflict.consequence)));
    columns.add("artefact", conflicts().map(|conflict| artefacts.place(&conflict.artefact)));
    let [mut manoeuvres, mut causes] = <[Words; 2]>::default();
    columns.add("manoeuvre", conflicts().map(|conflict| manoeuvres.place(&conflict.manoeuvre)));
    columns.add("cause", conflicts().map(|conflict| causes.place(&conflict.cause)));
    let [mut lanes, mut areas] = <[Words; 2]>::default();
    let area = |conflict| named.and_then(|named| named.of(conflict)).map_or("", |place| &place.name);
    columns.add("area", conflicts().map(|conflict| areas.place(area(conflict))));
    columns.add("lane", conflicts().map(|conflict| lanes.place(&conflict.lane)));
    columns.add("id", conflicts().map(|conflict| conflict.id));
    columns.add("run", rows.iter().map(|row| row.run));
    columns.add("kind", conflicts().map(|conflict| rank(&Kind::ALL, conflict.kind)));
    columns.add("severity", conflicts().map(|conflict| rank(&Severity::ALL, conflict.severity)));
    columns.add("collision", conflicts().map(|conflict| u8::from(conflict.collision)));
    columns.add("unavoidable", conflicts().map(|conflict| u8::from(conflict.unavoidable == Some(true))));
    let touching = conflicts().map(parts).collect::<Vec<_>>();
    for (place, name) in ["ego_part", "foe_part"].into_iter().enumerate() {
        columns.add(name, touching.iter().map(|parts| parts.map(|parts| parts[place] as u8)));
    }
    let mut movements = Movements::of(net);
    let moves = conflicts().map(|conflict| movements.of_both(conflict)).collect::<Vec<_>>();
    for (place, name) in ["ego_movement", "foe_movement"].into_iter().enumerate() {
        columns.add(name, moves.iter().map(|both| both.map(|both| both.movements[place])));
    }
    let did_not_yield =
        |conflict: &LoggedConflict| conflict.cause.split(' ').any(|cause| cause == Cause::DidNotYield.name());
    let yields = moves.iter().zip(conflicts()).map(|(both, conflict)| both.filter(|_| did_not_yield(conflict))?.yields);
    columns.add("yields", yields);
    let is_there = |column: &&Column| {
        column.presence != Presence::Chosen || conflicts().any(|conflict| (column.get)(conflict) != Cell::Missing)
    };
    for column in COLUMNS.iter().filter(|column| is_shown_number(column)).filter(is_there) {
        let number = |conflict| match (column.get)(conflict) {
            Cell::Number(number) => Some(rounded(number, decimals(column))),
            _ => None,
        };
        columns.add(column.name, conflicts().map(number));
    }
    let mut places = Words::default();
    let spots = lanes.list.iter().map(|lane| spot(lane, net)).collect::<Vec<_>>();
    let spot_of_lane = spots.iter().map(|spot| places.place(spot)).collect::<Vec<_>>();
    let streets = net.map(Streets::of).unwrap_or_default();
    let lists = json!({
        "count": rows.len(),
        "ids": ids.list,
        "types": types.list,
        "nearnesses": nearness.list,
        "consequences": consequences.list,
        "artefacts": artefacts.list,
        "manoeuvres": manoeuvres.list,
        "causes": causes.list,
        "areas": areas.list,
        "lanes": lanes.list,
        "spots": places.list,
        "streets": places.list.iter().map(|spot| streets.name(spot)).collect::<Vec<_>>(),
        "spot_of_lane": spot_of_lane,
        "drawn": drawn,
        "movements": movements.json(),
    });
    text.push_str("},");
    push(text, &lists.to_string()[1..]);
}

fn is_shown_number(column: &Column) -> bool {
    column.column_type == ColumnType::Number && column.presence != Presence::Snapshot && column.name != NOT_SHOWN
}

/// How many decimals the page has: more for an angle, as it turns a whole length.
fn decimals(column: &Column) -> i32 {
    if column.unit() == "rad" { 3 } else { 2 }
}

fn rank<T: PartialEq>(all: &[T], one: T) -> usize {
    all.iter().position(|known| *known == one).unwrap_or_default()
}

/// The edge or junction of a lane, in words; without a net, guessed from the lane's id.
fn spot(lane: &str, net: Option<&Net>) -> String {
    let known = net.and_then(|net| {
        let edge = &net.edges[net.lanes[net.lane(lane)?].edge];
        let within = edge.function != EdgeFunction::Normal && !edge.junction.is_empty();
        Some(if within { format!("junction {}", edge.junction) } else { format!("edge {}", edge.id) })
    });
    // SUMO's own scheme: the lane e_0 of the edge e; :J_0_0 of the internal edge :J_0 of the junction J.
    let guess = |id: &str| id.rsplit_once('_').map_or(id, |(before, _)| before).to_owned();
    known.unwrap_or_else(|| match lane.strip_prefix(':') {
        _ if lane.is_empty() => String::new(),
        Some(within) => format!("junction {}", guess(&guess(within))),
        None => format!("edge {}", guess(lane)),
    })
}

/// The row of a conflict, and both of its snapshots: x, y, heading, length, width and the numbers of the path. None where
/// the log has no snapshots.
fn drawing((row, RunConflict { conflict, .. }): (usize, &RunConflict)) -> Option<Value> {
    let LoggedConflict { ego_x, ego_y, ego_heading, ego_length, ego_width, ego_path, .. } = conflict;
    let LoggedConflict { foe_x, foe_y, foe_heading, foe_length, foe_width, foe_path, .. } = conflict;
    let ego = snapshot([ego_x, ego_y, ego_heading, ego_length, ego_width], ego_path)?;
    let foe = snapshot([foe_x, foe_y, foe_heading, foe_length, foe_width], foe_path)?;
    Some(json!([row, ego, foe]))
}

fn snapshot(numbers: [&Option<f64>; 5], path: &str) -> Option<Vec<f64>> {
    let mut snapshot = numbers.into_iter().map(|number| Some(rounded((*number)?, 3))).collect::<Option<Vec<_>>>()?;
    snapshot.extend(path.split(' ').filter_map(|number| number.parse::<f64>().ok()));
    Some(snapshot)
}

fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10_f64.powi(decimals);
    // Adding 0 turns -0 into 0.
    (value * scale).round() / scale + 0.0
}

#[cfg(test)]
mod tests {
    use crate::report::data::*;
    use closecall_run::output::sample_conflict::sample;

    #[test]
    fn without_a_net_a_lane_is_where_its_id_says() {
        assert_eq!(spot("a_b_0", None), "edge a_b");
        assert_eq!(spot(":J_1_3_0", None), "junction J_1");
        assert_eq!(spot("", None), "");
    }

    #[test]
    fn a_script_in_an_id_cannot_end_the_data() {
        let conflict = sample(&[("ego", "</script><script>")]).unwrap();
        let conflicts = vec![RunConflict { run: 0, conflict }];
        let text = json(
            Conflicts {
                lost: Vec::new(),
                logs: Vec::new(),
                records: Vec::new(),
                variants: Vec::new(),
                ground: Default::default(),
                conflicts,
                seen: 1,
                set_aside: None,
                filter: None,
                scope: Default::default(),
                named: None,
            },
            None,
            Details::REPORT,
            None,
        )
        .unwrap();
        assert!(!text.contains('<'));
        let read: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(read["conflicts"]["ids"][0], "</script><script>");
    }
}
