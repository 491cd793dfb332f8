//! A net as the page draws it: lanes grouped by look and width, junctions as areas, stop lines. Coordinates are in centimetres, each
//! point as its difference from the previous one.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use closecall::geometry::{Point, Vector};
use closecall::traffic::net::{EdgeFunction, Lane, Net, Passage};

/// Centimetres per metre: short numbers, without a visible error.
const SCALE: f64 = 100.0;

/// The net's lanes and junctions as JSON.
pub fn json(net: &Net) -> Value {
    let mut groups = BTreeMap::<(&str, u32), Vec<&[Point]>>::new();
    let mut stops = BTreeMap::<&str, Vec<[Point; 2]>>::new();
    for lane in &net.lanes {
        let look = match net.edges[lane.edge].function {
            EdgeFunction::Normal if lane.has_vehicles => "road",
            EdgeFunction::Normal => "foot",
            EdgeFunction::Internal => "within",
            EdgeFunction::Crossing => "crossing",
            // The shape of a walking area is its outline, which its junction's area already covers.
            EdgeFunction::WalkingArea | EdgeFunction::Connector => continue,
        };
        let decimetres = (lane.width * 10.0).round() as u32;
        groups.entry((look, decimetres)).or_default().push(&lane.shape);
        if let ("road", Some(rule)) = (look, rule(net, lane))
            && let Some(across) = across_the_end(lane)
        {
            stops.entry(rule).or_default().push(across);
        }
    }
    let lanes = groups.into_iter().map(
        |((look, width), shapes)| json!({ "look": look, "width": f64::from(width) / 10.0, "lines": lines(&shapes) }),
    );
    let junctions = net.junctions.iter().map(|junction| &junction.shape[..]).filter(|shape| shape.len() > 2);
    let stops = stops.into_iter().map(|(rule, ends)| {
        let ends = ends.iter().map(|ends| &ends[..]).collect::<Vec<_>>();
        json!({ "rule": rule, "lines": lines(&ends) })
    });
    json!({
        "lanes": lanes.collect::<Vec<_>>(),
        "junctions": lines(&junctions.collect::<Vec<_>>()),
        "stops": stops.collect::<Vec<_>>(),
    })
}

/// Why vehicles may have to stop at the end of a lane; none where they never have to.
fn rule(net: &Net, lane: &Lane) -> Option<&'static str> {
    let passages = || lane.links.iter().filter_map(|link| net.passage(link.via?));
    let yields = |passage: &Passage| net.junctions[passage.junction as usize].has_to_yield(passage.link);
    if passages().any(|passage| passage.signal.is_some()) {
        Some("signal")
    } else {
        passages().any(yields).then_some("yield")
    }
}

/// The line across the end of a lane.
fn across_the_end(lane: &Lane) -> Option<[Point; 2]> {
    let [.., before, end] = lane.shape[..] else { return None };
    let along = (end - before).try_normalize(0.0)?;
    let aside = Vector::new(-along.y, along.x) * (lane.width / 2.0 - 0.2);
    Some([end + aside, end - aside])
}

/// Lines as one list of whole numbers: for each line the number of points, then x and y of each point.
fn lines(shapes: &[&[Point]]) -> Vec<i64> {
    let mut numbers = Vec::new();
    let (mut x, mut y) = (0, 0);
    for shape in shapes {
        numbers.push(shape.len() as i64);
        for point in *shape {
            let (to_x, to_y) = ((point.x * SCALE).round() as i64, (point.y * SCALE).round() as i64);
            numbers.extend([to_x - x, to_y - y]);
            (x, y) = (to_x, to_y);
        }
    }
    numbers
}

#[cfg(test)]
mod tests {
    use crate::report::page_net::*;

    #[test]
    fn a_line_is_its_count_and_differences() {
        let a = [Point::new(1.0, 2.0), Point::new(1.5, 2.0)];
        let b = [Point::new(1.5, 0.0)];
        assert_eq!(lines(&[&a, &b]), [2, 100, 200, 50, 0, 1, 0, -200]);
    }
}
