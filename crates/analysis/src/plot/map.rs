//! The map: the net, and a sign for each conflict with a shape by kind and a colour by severity; below, legend and scale.
//! North is up, as in the net.

use plotters::coord::Shift;
use plotters::prelude::{
    Circle, Color, DrawingArea, DrawingBackend, EmptyElement, PathElement, Polygon, RGBColor, Text, TriangleMarker,
};

use super::chart::{Chart, INK, PictureStyle, colour, message};
use crate::dataset::Conflicts;
use closecall::detection::kind::{Kind, Severity};
use closecall::geometry::{Bounds, Point, Vector};
use closecall::traffic::net::{EdgeFunction, Net};

const ROAD: RGBColor = RGBColor(0xc3, 0xc9, 0xd0);
const JUNCTION: RGBColor = RGBColor(0xb9, 0xbf, 0xc6);
/// The margin around the net, and the height of the legend below it, in pixels on a screen.
const ROOM: f64 = 30.0;
const LEGEND: f64 = 92.0;
/// The distances between the legend's entries, and between its lines.
const ENTRY: i32 = 130;
/// The greatest length of the scale.
const SCALE: i32 = 80;
const LINE: i32 = 36;
/// Radius of a sign.
const SIGN: i32 = 6;
/// The height of the title above the map.
const TITLE: f64 = 36.0;

/// The map.
pub struct Map;

/// The projection from the net to pixels, with the same scale on both axes.
struct View {
    low: Point,
    scale: f64,
    corner: (f64, f64),
}

impl View {
    fn of(bounds: Bounds, (width, height): (u32, u32), style: PictureStyle) -> Self {
        let [room, legend, title] = [ROOM, LEGEND, TITLE].map(|length| f64::from(style.pixels(length as i32)));
        let extent = bounds.high - bounds.low;
        let wide = f64::from(width) - 2.0 * room;
        let high = f64::from(height) - 2.0 * room - legend - title;
        let scale = (wide / extent.x.max(1.0)).min(high / extent.y.max(1.0));
        let aside = (wide - extent.x * scale) / 2.0;
        let below = (high - extent.y * scale) / 2.0;
        Self { low: bounds.low, scale, corner: (room + aside, room + title + high - below) }
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
    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        found: &Conflicts,
        style: PictureStyle,
    ) -> Result<(), String> {
        let mut bounds = Bounds::EMPTY;
        let lanes = found.net().into_iter().flat_map(|net| &net.lanes);
        lanes.flat_map(|lane| &lane.shape).for_each(|point| bounds.include(*point));
        found.places().for_each(|(_, _, place)| bounds.include(place));
        if bounds.low.x > bounds.high.x {
            bounds = Bounds { low: Point::origin(), high: Point::new(100.0, 100.0) };
        }
        let view = View::of(bounds, area.dim_in_pixel(), style);
        if let Some(net) = found.net() {
            roads(area, net, &view)?;
        }
        for severity in Severity::ALL {
            for (kind, _, place) in found.places().filter(|(_, of_place, _)| *of_place == severity) {
                sign(area, kind, colour(severity), view.pixel(place), style.pixels(SIGN))?;
            }
        }
        legend(area, &view, style)?;
        let place = (style.pixels(ROOM as i32), style.pixels(12));
        area.draw(&Text::new("Conflict points", place, style.text())).map_err(message)
    }
}

fn roads<B: DrawingBackend>(area: &DrawingArea<B, Shift>, net: &Net, view: &View) -> Result<(), String> {
    for junction in net.junctions.iter().filter(|junction| junction.shape.len() > 2) {
        area.draw(&Polygon::new(view.pixels(&junction.shape), JUNCTION.filled())).map_err(message)?;
    }
    for lane in net.lanes.iter().filter(|lane| net.edges[lane.edge].function == EdgeFunction::Normal) {
        let width = ((lane.width - 0.25) * view.scale).round().max(1.0) as u32;
        area.draw(&PathElement::new(view.pixels(&lane.shape), ROAD.stroke_width(width))).map_err(message)?;
    }
    Ok(())
}

/// The sign of a kind in a colour, around a pixel.
fn sign<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    kind: Kind,
    colour: RGBColor,
    at: (i32, i32),
    radius: i32,
) -> Result<(), String> {
    let style = colour.mix(0.85).filled();
    let (x, y) = at;
    let drawn = match kind {
        Kind::RearEnd => area.draw(&Circle::new(at, radius - 1, style)),
        Kind::Side => area.draw(&(EmptyElement::at(at) + TriangleMarker::new((0, 0), radius + 1, style))),
        Kind::Frontal => {
            let corners = [(x, y - radius - 1), (x + radius + 1, y), (x, y + radius + 1), (x - radius - 1, y)];
            area.draw(&Polygon::new(corners.to_vec(), style))
        }
    };
    drawn.map_err(message)
}

/// The kinds and the scale in one line, the severities in the next.
fn legend<B: DrawingBackend>(area: &DrawingArea<B, Shift>, view: &View, style: PictureStyle) -> Result<(), String> {
    let pixels = |on_screen| style.pixels(on_screen);
    let bottom = area.dim_in_pixel().1 as i32;
    let [kinds, severities] = [2, 1].map(|lines| bottom - pixels(LINE * lines));
    let left = pixels(ROOM as i32 + 10);
    let text = |words: &str, (x, y): (i32, i32)| {
        area.draw(&Text::new(words.to_owned(), (x + pixels(16), y - pixels(10)), style.text())).map_err(message)
    };
    for (place, kind) in (0..).zip(Kind::ALL) {
        let at = (left + pixels(ENTRY) * place, kinds);
        sign(area, kind, INK, at, pixels(SIGN))?;
        text(&kind.name().replace('_', "-"), at)?;
    }
    for (place, severity) in (0..).zip(Severity::ALL) {
        let at = (left + pixels(ENTRY) * place, severities);
        sign(area, Kind::RearEnd, colour(severity), at, pixels(SIGN))?;
        text(severity.name(), at)?;
    }
    let length = round_length(f64::from(pixels(SCALE)) / view.scale);
    let from = left + pixels(ENTRY) * 3;
    let to = from + (length * view.scale).round() as i32;
    let tick = kinds - pixels(6);
    let bar = [(from, tick), (from, kinds), (to, kinds), (to, tick)];
    area.draw(&PathElement::new(bar.to_vec(), INK.stroke_width(2))).map_err(message)?;
    text(&format!("{length} m"), (to, kinds))
}

/// The greatest of 1, 2, 5, 10, … that is not above this.
fn round_length(longest: f64) -> f64 {
    let power = 10_f64.powf(longest.max(1e-3).log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|digit| digit * power).find(|length| *length <= longest).unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use crate::plot::map::*;

    #[test]
    fn the_scale_is_a_round_length() {
        assert_eq!([round_length(99.0), round_length(7.0), round_length(2.0)], [50.0, 5.0, 2.0]);
    }
}
