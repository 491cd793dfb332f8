//! The map: the net, and a sign for each conflict with a shape by kind and a colour by severity; below, legend and scale.

use plotters::coord::Shift;
use plotters::prelude::{
    Circle, Color, DrawingArea, DrawingBackend, EmptyElement, PathElement, Polygon, RGBColor, Text, TriangleMarker,
};
use plotters::style::{IntoFont, TextStyle};

use super::chart::{Chart, INK, colour, message};
use super::font;
use crate::analysis::dataset::Conflicts;
use crate::detection::kind::{Kind, Severity};
use crate::geometry::{Bounds, Point, Vector};
use crate::traffic::net::{EdgeFunction, Net};

const ROAD: RGBColor = RGBColor(0xc3, 0xc9, 0xd0);
const JUNCTION: RGBColor = RGBColor(0xb9, 0xbf, 0xc6);
/// The margin around the net, and the height of the legend below it, in pixels.
const ROOM: f64 = 30.0;
const LEGEND: f64 = 60.0;
/// Radius of a sign, in pixels.
const SIGN: i32 = 6;

/// The map.
pub struct Map;

/// The projection from the net to pixels, with the same scale on both axes.
struct View {
    low: Point,
    scale: f64,
    corner: (f64, f64),
}

impl View {
    fn of(bounds: Bounds, (width, height): (u32, u32)) -> Self {
        let extent = bounds.high - bounds.low;
        let wide = f64::from(width) - 2.0 * ROOM;
        let high = f64::from(height) - 2.0 * ROOM - LEGEND;
        let scale = (wide / extent.x.max(1.0)).min(high / extent.y.max(1.0));
        let aside = (wide - extent.x * scale) / 2.0;
        let below = (high - extent.y * scale) / 2.0;
        Self { low: bounds.low, scale, corner: (ROOM + aside, ROOM + high - below) }
    }

    fn pixel(&self, place: Point) -> (i32, i32) {
        let from: Vector = place - self.low;
        let x = self.corner.0 + from.x * self.scale;
        let y = self.corner.1 - from.y * self.scale;
        (x.round() as i32, y.round() as i32)
    }

    fn pixels(&self, places: &[Point]) -> Vec<(i32, i32)> {
        places.iter().map(|place| self.pixel(*place)).collect()
    }
}

impl Chart for Map {
    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>, found: &Conflicts) -> Result<(), String> {
        let mut bounds = Bounds::EMPTY;
        let lanes = found.net().map(|net| &net.lanes[..]).unwrap_or_default();
        lanes.iter().flat_map(|lane| &lane.shape).for_each(|point| bounds.include(*point));
        found.places().for_each(|(_, _, place)| bounds.include(place));
        if bounds.low.x > bounds.high.x {
            bounds = Bounds { low: Point::origin(), high: Point::new(100.0, 100.0) };
        }
        let view = View::of(bounds, area.dim_in_pixel());
        if let Some(net) = found.net() {
            roads(area, net, &view)?;
        }
        for severity in Severity::ALL {
            for (kind, _, place) in found.places().filter(|(_, of_place, _)| *of_place == severity) {
                sign(area, kind, severity, view.pixel(place))?;
            }
        }
        legend(area, &view)
    }
}

fn roads<B: DrawingBackend>(area: &DrawingArea<B, Shift>, net: &Net, view: &View) -> Result<(), String> {
    for junction in net.junctions.iter().filter(|junction| junction.shape.len() > 2) {
        area.draw(&Polygon::new(view.pixels(&junction.shape), JUNCTION.filled())).map_err(message)?;
    }
    for lane in net.lanes.iter().filter(|lane| net.edges[lane.edge.0 as usize].function == EdgeFunction::Normal) {
        let width = ((lane.width - 0.25) * view.scale).round().max(1.0) as u32;
        area.draw(&PathElement::new(view.pixels(&lane.shape), ROAD.stroke_width(width))).map_err(message)?;
    }
    Ok(())
}

/// The sign of a kind in the colour of a severity, around a pixel.
fn sign<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    kind: Kind,
    severity: Severity,
    at: (i32, i32),
) -> Result<(), String> {
    let style = colour(severity).mix(0.85).filled();
    let (x, y) = at;
    let drawn = match kind {
        Kind::RearEnd => area.draw(&Circle::new(at, SIGN - 1, style)),
        Kind::Side => area.draw(&(EmptyElement::at(at) + TriangleMarker::new((0, 0), SIGN + 1, style))),
        Kind::Frontal => {
            let corners = [(x, y - SIGN - 1), (x + SIGN + 1, y), (x, y + SIGN + 1), (x - SIGN - 1, y)];
            area.draw(&Polygon::new(corners.to_vec(), style))
        }
    };
    drawn.map_err(message)
}

fn legend<B: DrawingBackend>(area: &DrawingArea<B, Shift>, view: &View) -> Result<(), String> {
    let y = area.dim_in_pixel().1 as i32 - 35;
    let style = TextStyle::from((font::NAME, 24).into_font()).color(&INK);
    let text =
        |words: &str, x: i32| area.draw(&Text::new(words.to_owned(), (x, y - 10), style.clone())).map_err(message);
    let mut x = ROOM as i32 + 10;
    for kind in Kind::ALL {
        sign(area, kind, Severity::Caution, (x, y))?;
        text(&kind.name().replace('_', "-"), x + 16)?;
        x += 150;
    }
    for severity in Severity::ALL {
        sign(area, Kind::RearEnd, severity, (x, y))?;
        text(severity.name(), x + 16)?;
        x += 150;
    }
    let length = round_length(200.0 / view.scale);
    let from = x;
    let to = x + (length * view.scale).round() as i32;
    let bar = [(from, y - 6), (from, y), (to, y), (to, y - 6)];
    area.draw(&PathElement::new(bar.to_vec(), INK.stroke_width(2))).map_err(message)?;
    text(&format!("{length} m"), to + 12)
}

/// The greatest of 1, 2, 5, 10, … that is not above this.
fn round_length(longest: f64) -> f64 {
    let power = 10_f64.powf(longest.max(1e-3).log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|digit| digit * power).find(|length| *length <= longest).unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use crate::analysis::plot::map::*;

    #[test]
    fn the_scale_is_a_round_length() {
        assert_eq!([round_length(99.0), round_length(7.0), round_length(2.0)], [50.0, 5.0, 2.0]);
    }
}
