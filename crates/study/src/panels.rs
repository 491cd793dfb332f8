//! What the chart of an axis shows.

use closecall_analysis::study::error_over_time::{Panel, Point, distinct};

use super::measurement::{Axis, Measurement};

/// The panels of an axis, one per scene: error over run time. All candidate searches are exact, so theirs show run time
/// over the number of road users, one per kind of traffic.
pub(crate) fn panels(axis: Axis, rows: &[Measurement]) -> Vec<Panel<'_>> {
    let point =
        |row: &'_ Measurement, x, y, on_front| Point { x, y, method: row.method, on_front, marked: row.default };
    if axis == Axis::Candidates {
        let of = |traffic: &str| {
            let same = rows.iter().filter(|row| row.traffic() == traffic);
            let points = same.map(|row| point(row, row.items as f64, row.ns_per_item, false)).collect();
            Panel { title: traffic.to_owned(), across: "road users", up: "ns per road user", points }
        };
        return distinct(rows.iter().map(Measurement::traffic)).into_iter().map(of).collect();
    }
    let of = |scene: &str| {
        let same = || rows.iter().filter(|row| row.scene == scene);
        let points = same().map(|row| point(row, row.ns_per_item, row.error, row.on_pareto_front)).collect();
        let up = same().next().map_or("", |row| row.error_name);
        Panel { title: scene.to_owned(), across: "ns per item", up, points }
    };
    distinct(rows.iter().map(|row| row.scene.as_str())).into_iter().map(of).collect()
}

/// What the ring and the grey line of an axis mean.
pub fn note(axis: Axis) -> &'static str {
    match axis {
        Axis::Candidates => "closecall's choice; no method loses a pair",
        _ => "closecall's choice; grey: the Pareto front; lower left is better",
    }
}
