//! The page's data as JSON. In memory there are the conflicts' rows and one column as text.

use std::path::PathBuf;

use rustc_hash::FxHashSet;
use serde_json::{Map, Value, json};

use super::sink::{Sink, escaped, rank, rounded};
use super::tiles::TileUrl;
use super::{clips, columns, faults, page_net, reading, remarks};
use crate::Result;
use crate::dataset::Conflicts;
use crate::dataset::conflict_table::ConflictTable;
use crate::dataset::kept::RunConflict;
use crate::filter::NamedPlaces;
use crate::statistics::Effects;
use closecall::detection::kind::{Kind, Severity};
use closecall::options::Options;
use closecall::traffic::net::Net;
use closecall_run::output::schema::LoggedConflict;

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

/// All of the page's data.
pub(super) struct Data {
    /// In the order of the logs.
    conflicts: Vec<RunConflict>,
    table: ConflictTable,
    /// The snapshots of the worst.
    drawn: Vec<Value>,
    net: Option<Net>,
    named: Option<NamedPlaces>,
    /// All but the conflicts, as JSON.
    others: String,
}

impl Data {
    /// That of a report.
    ///
    /// # Errors
    /// Those of reading the clips and the faults of the net; where the net has no place for `tiles`.
    pub fn of(found: Conflicts, before: Option<Value>, details: Details, tiles: Option<&TileUrl>) -> Result<Self> {
        let Conflicts { logs, records, variants, mut ground, mut conflicts, table, .. } = found;
        let worst = &conflicts[..conflicts.len().min(details.played)];
        let mut played = clips::of_worst((worst, &table), &logs, details.clip_bytes, &mut ground)?;
        let drawn = conflicts.iter().take(details.drawn).map(RunConflict::key).collect::<FxHashSet<_>>();
        conflicts.sort_unstable();
        let drawn = (0..).zip(&conflicts).filter(|(_, one)| drawn.contains(&one.key()));
        let drawing = |(place, one): (usize, &RunConflict)| Ok(drawing(place, &table.conflict(one.row)?));
        let drawn = drawn.map(drawing).filter_map(Result::transpose).collect::<Result<Vec<_>>>()?;
        let net = ground.net;
        let clip = |(place, one): (usize, &RunConflict)| Some(json!([place, played.remove(&one.key())?]));
        let played = (0..).zip(&conflicts).filter_map(clip).collect::<Vec<_>>();
        let others = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "seen": found.seen,
            "kinds": Kind::ALL.map(Kind::name),
            "severities": Severity::ALL.map(Severity::name),
            "clips": played,
            "reading": reading::json(&records),
            "remarks": remarks::json(&records),
            "scope": found.scope,
            "places": found.named.as_ref().map(|named| &*named.all),
            "tiles": tiles.map(|tiles| tiles.json(net.as_ref())).transpose()?,
            "runs": runs(&logs, records),
            "variants": variants.iter().map(|variant| json!({ "name": variant.name, "runs": variant.runs })).collect::<Vec<_>>(),
            "defaults": Options::default(),
            "net": net.as_ref().map(page_net::json),
            "net_faults": faults::json(&logs)?,
            "notes": ground.notes,
            "before": before,
            "filter": found.filter,
            "set_aside": found.set_aside,
        });
        let others = escaped(&others.to_string());
        Ok(Self { conflicts, table, drawn, net, named: found.named, others })
    }

    /// Writes it as JSON without a `<`, which could end the script around it.
    ///
    /// # Errors
    /// Those of `to`.
    pub fn write(&self, to: &mut Sink) -> Result<()> {
        let Self { conflicts, table, drawn, net, named, others } = self;
        to(b"{\"conflicts\":")?;
        columns::write((conflicts, table), drawn, net.as_ref(), named.as_ref(), to)?;
        to(b",")?;
        to(&others.as_bytes()[1..])
    }
}

/// The runs that the report compares with: how the rates differ, and where their conflicts are.
pub fn before(effects: &Effects, found: &Conflicts) -> Value {
    let numbers = |column: &str, decimals| {
        let number = found.table.numbers(column);
        found.conflicts.iter().map(move |one| number(one.row).map(|number| rounded(number, decimals)))
    };
    let artefact = found.table.texts("artefact");
    // An artefact is not a danger, on either side.
    let probabilities = found
        .conflicts
        .iter()
        .zip(numbers("crash_probability", 5))
        .map(|(one, probability)| probability.filter(|_| artefact(one.row).is_empty()).unwrap_or_default());
    json!({
        "effects": effects,
        "x": numbers("x", 1).collect::<Vec<_>>(),
        "y": numbers("y", 1).collect::<Vec<_>>(),
        "severity": found.conflicts.iter().map(|one| rank(&Severity::ALL, one.severity)).collect::<Vec<_>>(),
        "crash_probability": probabilities.collect::<Vec<_>>(),
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

/// The place of a conflict among all, and both of its snapshots: x, y, heading, length, width and the numbers of the path. None where
/// the log has no snapshots.
fn drawing(place: usize, conflict: &LoggedConflict) -> Option<Value> {
    let LoggedConflict { ego_x, ego_y, ego_heading, ego_length, ego_width, ego_path, .. } = conflict;
    let LoggedConflict { foe_x, foe_y, foe_heading, foe_length, foe_width, foe_path, .. } = conflict;
    let ego = snapshot([ego_x, ego_y, ego_heading, ego_length, ego_width], ego_path)?;
    let foe = snapshot([foe_x, foe_y, foe_heading, foe_length, foe_width], foe_path)?;
    Some(json!([place, ego, foe]))
}

fn snapshot(numbers: [&Option<f64>; 5], path: &str) -> Option<Vec<f64>> {
    let mut snapshot = numbers.into_iter().map(|number| Some(rounded((*number)?, 3))).collect::<Option<Vec<_>>>()?;
    snapshot.extend(path.split(' ').filter_map(|number| number.parse::<f64>().ok()));
    Some(snapshot)
}

#[cfg(test)]
mod tests {
    use crate::dataset::kept::KeptConflicts;
    use crate::report::data::*;
    use closecall_run::output::sample_conflict::sample;

    #[test]
    fn a_script_in_an_id_cannot_end_the_data() {
        let conflict = sample(&[("ego", "</script><script>")]).unwrap();
        let mut kept = KeptConflicts::new(1);
        kept.push(0, &conflict);
        let (conflicts, table) = kept.into_sorted();
        let found = Conflicts {
            lost: Vec::new(),
            logs: Vec::new(),
            records: Vec::new(),
            variants: Vec::new(),
            ground: Default::default(),
            conflicts,
            table,
            seen: 1,
            set_aside: None,
            filter: None,
            scope: Default::default(),
            named: None,
        };
        let mut text = Vec::new();
        let data = Data::of(found, None, Details::REPORT, None).unwrap();
        data.write(&mut |part| {
            text.extend_from_slice(part);
            Ok(())
        })
        .unwrap();
        assert!(!text.contains(&b'<'));
        let read: Value = serde_json::from_slice(&text).unwrap();
        assert_eq!(read["conflicts"]["ids"][0], "</script><script>");
    }
}
