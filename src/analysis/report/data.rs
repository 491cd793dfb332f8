//! What the page draws, as JSON: columns instead of rows, numbers rounded, repeated words once.

use std::path::PathBuf;

use rustc_hash::FxHashMap;
use serde_json::{Map, Value, json};

use super::roads;
use crate::analysis::dataset::Conflicts;
use crate::analysis::dataset::rows::{NUMBERS, Row, Snapshot};
use crate::detection::kind::{Kind, Severity};
use crate::options::Options;
use crate::traffic::net::{EdgeFunction, Net};

/// So many of the worst conflicts can be drawn, with both rectangles and paths.
const DRAWN: usize = 2_000;

/// All of the page's data. No `<` is in it: what stands in a page's script must not end it.
pub fn json(found: Conflicts) -> String {
    let Conflicts { logs, records, ground, mut rows, seen } = found;
    for row in rows.iter_mut().skip(DRAWN) {
        row.snapshots = None;
    }
    rows.sort_unstable_by_key(|row| (row.run, row.id));
    let data = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "seen": seen,
        "kinds": Kind::ALL.map(Kind::name),
        "severities": Severity::ALL.map(Severity::name),
        "conflicts": columns(&rows, ground.net.as_ref()),
        "runs": runs(&logs, records),
        "defaults": Options::default(),
        "net": ground.net.as_ref().map(roads::json),
        "notes": ground.notes,
    });
    data.to_string().replace('<', "\\u003c")
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

/// Words that repeat: a column has their places in the list.
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

fn columns(rows: &[Row], net: Option<&Net>) -> Value {
    let mut columns = Map::new();
    let mut add = |name: &str, column: Value| drop(columns.insert(name.to_owned(), once(column)));
    let (mut ids, mut types, mut lanes) = (Words::default(), Words::default(), Words::default());
    for (who, name) in ["ego", "foe"].into_iter().enumerate() {
        add(name, rows.iter().map(|row| ids.place(&row.ids[who])).collect());
        add(&format!("{name}_type"), rows.iter().map(|row| types.place(&row.types[who])).collect());
    }
    add("lane", rows.iter().map(|row| lanes.place(&row.lane)).collect());
    add("id", rows.iter().map(|row| row.id).collect());
    add("run", rows.iter().map(|row| row.run).collect());
    add("kind", rows.iter().map(|row| row.kind).collect());
    add("severity", rows.iter().map(|row| row.severity).collect());
    add("collision", rows.iter().map(|row| u8::from(row.collision)).collect());
    for (place, (name, decimals)) in NUMBERS.into_iter().enumerate() {
        add(name, rows.iter().map(|row| row.numbers[place].map(|value| rounded(value, decimals))).collect());
    }
    let mut places = Words::default();
    let spots = lanes.list.iter().map(|lane| spot(lane, net)).collect::<Vec<_>>();
    let spot_of_lane = spots.iter().map(|spot| places.place(spot)).collect::<Vec<_>>();
    let drawn = (0..).zip(rows).filter_map(|(row, kept)| Some((row, kept.snapshots.as_deref()?)));
    let drawn = drawn.map(|(row, [ego, foe]): (usize, _)| json!([row, stance(ego), stance(foe)])).collect::<Vec<_>>();
    json!({
        "count": rows.len(),
        "columns": columns,
        "ids": ids.list,
        "types": types.list,
        "lanes": lanes.list,
        "spots": places.list,
        "spot_of_lane": spot_of_lane,
        "drawn": drawn,
    })
}

/// A column that is the same in every row as that one value.
fn once(column: Value) -> Value {
    match column {
        Value::Array(mut values) if values.windows(2).all(|pair| pair[0] == pair[1]) => {
            values.pop().unwrap_or_else(|| Value::Array(Vec::new()))
        }
        other => other,
    }
}

/// The edge or junction that a lane belongs to, in words; as its id says where there is no net.
fn spot(lane: &str, net: Option<&Net>) -> String {
    let known = net.and_then(|net| {
        let edge = &net.edges[net.lanes[net.lane(lane)?.0 as usize].edge.0 as usize];
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

/// A stance as x, y, heading, length, width and the numbers of its path.
fn stance(stance: &Snapshot) -> Vec<f64> {
    let path = stance.path.split(' ').filter_map(|number| number.parse::<f64>().ok());
    stance.numbers.into_iter().map(|number| rounded(number, 3)).chain(path).collect()
}

fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10_f64.powi(decimals);
    // Adding 0 makes the 0 of -0.
    (value * scale).round() / scale + 0.0
}

#[cfg(test)]
mod tests {
    use crate::analysis::report::data::*;

    #[test]
    fn a_lane_without_a_net_is_on_the_edge_or_junction_that_its_id_says() {
        assert_eq!(spot("a_b_0", None), "edge a_b");
        assert_eq!(spot(":J_1_3_0", None), "junction J_1");
        assert_eq!(spot("", None), "");
    }

    #[test]
    fn a_script_in_an_id_cannot_end_the_data() {
        let row = Row {
            run: 0,
            id: 1,
            kind: 0,
            severity: 0,
            collision: false,
            numbers: [None; NUMBERS.len()],
            ids: ["</script><script>".into(), "b".into()],
            types: Default::default(),
            lane: "".into(),
            snapshots: None,
        };
        let ground = Default::default();
        let text = json(Conflicts { logs: Vec::new(), records: Vec::new(), ground, rows: vec![row], seen: 1 });
        assert!(!text.contains('<'));
        let read: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(read["conflicts"]["ids"][0], "</script><script>");
    }
}
