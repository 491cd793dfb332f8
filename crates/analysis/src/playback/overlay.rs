//! The paths of many runs over each other, as an SVG.

use std::fmt::Write;

use super::drawn_net::roads;
use super::picture::{FONT, GRASS};
use super::view::{PANEL, SIZE, View};
use closecall::geometry::Point;
use closecall::traffic::net::Net;
use closecall_run::util::xml_text::escaped;

/// The path of one road user in one run.
#[derive(Clone, Debug)]
pub struct DrawnPath {
    /// Its front bumper, step by step.
    pub places: Vec<Point>,
    /// Its colour.
    pub colour: &'static str,
    /// Whether a ring marks its end.
    pub is_struck: bool,
}

/// The paths around a place, with what the picture shows in words.
pub fn overlay(net: Option<&Net>, at: Point, paths: &[DrawnPath], title: &str) -> String {
    let view = View::around(at, paths.iter().flat_map(|path| path.places.iter().copied()));
    let ([width, height], title) = (SIZE, escaped(title));
    let height = height - PANEL;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"{FONT}\" role=\"img\" \
         aria-label=\"{title}\">\n<title>{title}</title>\n<rect width=\"{width}\" height=\"{height}\" fill=\"{GRASS}\"/>\n"
    );
    text += &net.map(|net| roads(net, &view)).unwrap_or_default();
    for DrawnPath { places, colour, is_struck } in paths {
        let points = view.points(places);
        let _ = writeln!(
            text,
            "<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\" stroke-opacity=\"0.5\"/>"
        );
        if let (true, Some(end)) = (is_struck, places.last()) {
            let [x, y] = view.to_picture(*end);
            let _ = writeln!(text, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\" fill=\"none\" stroke=\"{colour}\"/>");
        }
    }
    text + "</svg>\n"
}
