//! The conflicts in the page's data: columns instead of rows, numbers rounded, repeated words once. Each column is written as
//! soon as it is text.

use rustc_hash::FxHashMap;
use serde::Serialize;
use serde_json::Value;

use super::contact::parts;
use super::movements::Movements;
use super::sink::{Sink, escaped, rank, rounded};
use super::streets::Streets;
use crate::dataset::conflict_table::ConflictTable;
use crate::dataset::kept::RunConflict;
use crate::filter::NamedPlaces;
use crate::{Error, Result};
use closecall::detection::kind::{Kind, Severity};
use closecall::events::Cause;
use closecall::traffic::net::{EdgeFunction, Net};
use closecall_run::output::schema::{COLUMNS, Column, ColumnType, Presence};

/// The number column that nothing on the page shows.
const NOT_SHOWN: &str = "clearance";

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

/// Writes columns of numbers, flags and places in lists of words.
struct ColumnWriter<'a, 'b> {
    to: &'a mut Sink<'b>,
    /// The column that is being made.
    text: Vec<u8>,
    is_first: bool,
}

impl ColumnWriter<'_, '_> {
    /// Writes a column; one with the same value in every row becomes that value.
    fn add<T: PartialEq + Serialize>(&mut self, name: &str, values: impl Iterator<Item = T>) -> Result<()> {
        let Self { to, text, is_first } = self;
        let comma = if std::mem::take(is_first) { "" } else { "," };
        text.clear();
        text.extend_from_slice(format!("{comma}\"{name}\":").as_bytes());
        let mut values = values.peekable();
        let first = values.next();
        let mut same = 1;
        while values.next_if(|value| Some(value) == first.as_ref()).is_some() {
            same += 1;
        }
        match first {
            Some(first) if values.peek().is_none() => json(text, &first)?,
            first => {
                text.push(b'[');
                let mut first = first.iter().flat_map(|first| std::iter::repeat_n(first, same));
                first.try_for_each(|value| separated(text, value))?;
                values.try_for_each(|value| separated(text, &value))?;
                text.pop_if(|last| *last == b',');
                text.push(b']');
            }
        }
        to(text)
    }
}

/// Appends a value of an array.
fn separated(text: &mut Vec<u8>, value: &impl Serialize) -> Result<()> {
    json(text, value)?;
    text.push(b',');
    Ok(())
}

fn json(text: &mut Vec<u8>, value: &impl Serialize) -> Result<()> {
    serde_json::to_writer(text, value).map_err(|error| Error::Value(error.to_string()))
}

/// The lists of what repeats, besides the columns.
#[derive(Serialize)]
struct Lists<'a> {
    areas: Vec<&'a str>,
    artefacts: Vec<&'a str>,
    causes: Vec<&'a str>,
    consequences: Vec<&'a str>,
    count: usize,
    drawn: &'a [Value],
    ids: Vec<&'a str>,
    lanes: Vec<&'a str>,
    manoeuvres: Vec<&'a str>,
    movements: Value,
    nearnesses: Vec<&'a str>,
    spot_of_lane: Vec<usize>,
    spots: Vec<&'a str>,
    streets: Vec<Option<&'a str>>,
    types: Vec<&'a str>,
}

/// Writes the conflicts, a column after the other, and the lists of the words that repeat.
///
/// # Errors
/// Those of `to`.
pub(super) fn write(
    (rows, table): (&[RunConflict], &ConflictTable),
    drawn: &[Value],
    net: Option<&Net>,
    named: Option<&NamedPlaces>,
    to: &mut Sink,
) -> Result<()> {
    to(b"{\"columns\":{")?;
    let mut columns = ColumnWriter { to, text: Vec::new(), is_first: true };
    let texts = |name| {
        let text = table.texts(name);
        rows.iter().map(move |one| text(one.row))
    };
    let flags = |name| {
        let flag = table.flags(name);
        rows.iter().map(move |one| u8::from(flag(one.row) == Some(true)))
    };
    let [mut ids, mut types, mut lanes] = <[Words; 3]>::default();
    columns.add("ego", texts("ego").map(|id| ids.place(id)))?;
    columns.add("foe", texts("foe").map(|id| ids.place(id)))?;
    columns.add("ego_type", texts("ego_type").map(|name| types.place(name)))?;
    columns.add("foe_type", texts("foe_type").map(|name| types.place(name)))?;
    let mut words = <[Words; 5]>::default();
    for (name, words) in ["nearness", "consequence", "artefact", "manoeuvre", "cause"].into_iter().zip(&mut words) {
        columns.add(name, texts(name).map(|word| words.place(word)))?;
    }
    let [nearnesses, consequences, artefacts, manoeuvres, causes] = words.map(|words| words.list);
    let mut movements = Movements::of(net);
    let mut areas = Words::default();
    let (mut touching, mut moves, mut area_of) = (Vec::new(), Vec::new(), Vec::new());
    for one in rows {
        let conflict = table.conflict(one.row)?;
        touching.push(parts(&conflict));
        moves.push(movements.of_both(&conflict));
        area_of.push(areas.place(named.and_then(|named| named.of(&conflict)).map_or("", |place| &place.name)));
    }
    columns.add("area", area_of.into_iter())?;
    columns.add("lane", texts("lane").map(|lane| lanes.place(lane)))?;
    columns.add("id", rows.iter().map(|one| one.id))?;
    columns.add("run", rows.iter().map(|one| one.run))?;
    columns.add("kind", rows.iter().map(|one| rank(&Kind::ALL, one.kind)))?;
    columns.add("severity", rows.iter().map(|one| rank(&Severity::ALL, one.severity)))?;
    columns.add("collision", flags("collision"))?;
    columns.add("unavoidable", flags("unavoidable"))?;
    for (place, name) in ["ego_part", "foe_part"].into_iter().enumerate() {
        columns.add(name, touching.iter().map(|parts| parts.map(|parts| parts[place] as u8)))?;
    }
    for (place, name) in ["ego_movement", "foe_movement"].into_iter().enumerate() {
        columns.add(name, moves.iter().map(|both| both.map(|both| both.movements[place])))?;
    }
    let did_not_yield = |causes: &str| causes.split(' ').any(|cause| cause == Cause::DidNotYield.name());
    let yields = moves.iter().zip(texts("cause")).map(|(both, causes)| both.filter(|_| did_not_yield(causes))?.yields);
    columns.add("yields", yields)?;
    for column in COLUMNS.iter().filter(|column| is_shown_number(column)) {
        let number = table.numbers(column.name);
        let numbers = || rows.iter().map(|one| number(one.row));
        if column.presence != Presence::Chosen || numbers().any(|number| number.is_some()) {
            let decimals = decimals(column);
            columns.add(column.name, numbers().map(|number| Some(rounded(number?, decimals))))?;
        }
    }
    let mut spots = Words::default();
    let spot_names = lanes.list.iter().map(|lane| spot(lane, net)).collect::<Vec<_>>();
    let spot_of_lane = spot_names.iter().map(|spot| spots.place(spot)).collect();
    let streets = net.map(Streets::of).unwrap_or_default();
    let lists = serde_json::to_string(&Lists {
        areas: areas.list,
        artefacts,
        causes,
        consequences,
        count: rows.len(),
        drawn,
        ids: ids.list,
        lanes: lanes.list,
        manoeuvres,
        movements: movements.json(),
        nearnesses,
        spot_of_lane,
        streets: spots.list.iter().map(|spot| streets.name(spot)).collect(),
        spots: spots.list,
        types: types.list,
    });
    let lists = lists.map_err(|error| Error::Value(error.to_string()))?;
    to(b"},")?;
    to(escaped(&lists[1..]).as_bytes())
}

fn is_shown_number(column: &Column) -> bool {
    column.column_type == ColumnType::Number && column.presence != Presence::Snapshot && column.name != NOT_SHOWN
}

/// How many decimals the page has: more for an angle, as it turns a whole length.
fn decimals(column: &Column) -> i32 {
    if column.unit() == "rad" { 3 } else { 2 }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_net_a_lane_is_where_its_id_says() {
        assert_eq!(spot("a_b_0", None), "edge a_b");
        assert_eq!(spot(":J_1_3_0", None), "junction J_1");
        assert_eq!(spot("", None), "");
    }
}
