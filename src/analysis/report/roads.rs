//! A net as the page draws it: lanes grouped by look and width, junctions as areas. Coordinates are in centimetres, each
//! point as its difference from the previous one.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::geometry::Point;
use crate::traffic::net::{EdgeFunction, Net};

/// Centimetres per metre: short numbers, without a visible error.
const SCALE: f64 = 100.0;

/// The net's lanes and junctions as JSON.
pub fn json(net: &Net) -> Value {
    let mut groups = BTreeMap::<(&str, u32), Vec<&[Point]>>::new();
    for lane in &net.lanes {
        let look = match net.edges[lane.edge.0 as usize].function {
            EdgeFunction::Normal => "road",
            EdgeFunction::Internal => "within",
            EdgeFunction::Crossing | EdgeFunction::WalkingArea => "walk",
            EdgeFunction::Connector => continue,
        };
        // The shape of a walking area is its outline, which its junction's area already covers.
        if net.edges[lane.edge.0 as usize].function != EdgeFunction::WalkingArea {
            let decimetres = (lane.width * 10.0).round() as u32;
            groups.entry((look, decimetres)).or_default().push(&lane.shape);
        }
    }
    let lanes = groups.into_iter().map(
        |((look, width), shapes)| json!({ "look": look, "width": f64::from(width) / 10.0, "lines": lines(&shapes) }),
    );
    let junctions = net.junctions.iter().map(|junction| &junction.shape[..]).filter(|shape| shape.len() > 2);
    json!({ "lanes": lanes.collect::<Vec<_>>(), "junctions": lines(&junctions.collect::<Vec<_>>()) })
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
    use crate::analysis::report::roads::*;

    #[test]
    fn a_line_is_its_count_and_differences() {
        let a = [Point::new(1.0, 2.0), Point::new(1.5, 2.0)];
        let b = [Point::new(1.5, 0.0)];
        assert_eq!(lines(&[&a, &b]), [2, 100, 200, 50, 0, 1, 0, -200]);
    }
}
