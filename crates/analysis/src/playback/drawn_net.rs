//! The net around a conflict as SVG: lanes, their markings, crossings, and what the signals show.

use std::fmt::Write;

use super::animation::{Changing, Loop};
use super::view::View;
use closecall::events::ClipSignal;
use closecall::geometry::{Point, Vector, left_of};
use closecall::traffic::net::{EdgeFunction, Lane, Net};
use closecall::util::units::Metre;

const ASPHALT: &str = "#464b51";
const PAVEMENT: &str = "#a5a9a3";
const MARKING: &str = "#f4f4f0";

/// Lengths of a dividing line and of the room to the next, in m (Richtlinien für die Markierung von Straßen, urban roads).
const DASHES: [Metre; 2] = [3.0, 6.0];
/// Width of a line, in m.
const LINE: Metre = 0.15;
/// Width of a zebra's bars and of the room between them, in m.
const ZEBRA: Metre = 0.5;
/// Depth of a stop line, in m: as wide as the picture needs to show a colour.
const STOP_LINE: Metre = 0.9;

/// Lanes, junctions and markings within the view.
pub fn roads(net: &Net, view: &View) -> String {
    let mut text = String::new();
    let lanes = net.lanes.iter().filter(|lane| view.sees(&lane.shape, lane.width)).collect::<Vec<_>>();
    let of = |function: EdgeFunction| lanes.iter().filter(move |lane| net.edges[lane.edge].function == function);
    for area in of(EdgeFunction::WalkingArea) {
        let _ = writeln!(text, "<polygon points=\"{}\" fill=\"{PAVEMENT}\"/>", view.points(&area.shape));
    }
    let junctions = net.junctions.iter().map(|junction| &junction.shape[..]);
    for outline in junctions.filter(|outline| outline.len() > 2 && view.sees(outline, 0.0)) {
        let _ =
            writeln!(text, "<polygon points=\"{}\" fill=\"{ASPHALT}\" stroke=\"{ASPHALT}\"/>", view.points(outline));
    }
    for lane in of(EdgeFunction::Internal).chain(of(EdgeFunction::Normal)) {
        let colour = if lane.has_vehicles { ASPHALT } else { PAVEMENT };
        text += &line(view, &lane.shape, lane.width, colour, "");
    }
    let [dash, room] = DASHES.map(|length| length * view.scale());
    let dashes = format!(" stroke-dasharray=\"{dash:.1} {room:.1}\"");
    for lane in of(EdgeFunction::Normal).filter(|lane| lane.has_vehicles) {
        let all = &net.edges[lane.edge].lanes;
        let inner = if net.left_hand { -1.0 } else { 1.0 };
        let beside = beside(lane, inner * lane.width / 2.0);
        let is_innermost = all.last().is_some_and(|last| net.lanes[*last].id == lane.id);
        text += &line(view, &beside, LINE, MARKING, if is_innermost { "" } else { &dashes });
    }
    let zebra = format!(" stroke-dasharray=\"{:.1}\"", ZEBRA * view.scale());
    for crossing in of(EdgeFunction::Crossing) {
        text += &line(view, &crossing.shape, crossing.width, ASPHALT, "");
        text += &line(view, &crossing.shape, crossing.width, MARKING, &zebra);
    }
    text
}

fn line(view: &View, shape: &[Point], width: Metre, colour: &str, more: &str) -> String {
    let (points, width) = (view.points(shape), width * view.scale());
    format!("<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width:.1}\"{more}/>\n")
}

/// The line at a distance to the left of a lane's middle.
fn beside(lane: &Lane, left: Metre) -> Vec<Point> {
    let shape = &lane.shape;
    let direction = |from: usize, to: usize| (shape[to] - shape[from]).try_normalize(0.0).unwrap_or_else(Vector::zeros);
    let last = shape.len().saturating_sub(1);
    let shifted = |place: usize| {
        let along = direction(place.saturating_sub(1), place) + direction(place, (place + 1).min(last));
        let normal = along.try_normalize(0.0).map_or_else(Vector::zeros, |along| left_of(&along));
        shape[place] + normal * left
    };
    (0..shape.len()).map(shifted).collect()
}

/// The signals: bars at the ends of the lanes, one for each way on from there, in the colour that it shows.
pub fn signals(net: &Net, shown: &[ClipSignal], view: &View, time: &Loop) -> String {
    let mut text = String::new();
    for (place, signal) in shown.iter().enumerate() {
        let Some(corners) = signal_bar(net, shown, place) else { continue };
        let colour = |place: usize| signal_colour(signal.states.as_bytes()[place]).to_owned();
        let (points, Changing { first, changes }) = (view.points(&corners), time.jumps("fill", colour));
        let _ = writeln!(text, "<polygon points=\"{points}\" {first}>{changes}</polygon>");
    }
    text
}

/// The corners of the bar of one of the signals that are shown; none where the net has no such lane.
pub fn signal_bar(net: &Net, shown: &[ClipSignal], place: usize) -> Option<[Point; 4]> {
    let name = &shown[place].lane;
    let lane = &net.lanes[net.lane(name)?];
    let [.., before, end] = &lane.shape[..] else { return None };
    let along = (end - before).try_normalize(0.0)?;
    let of_lane = shown.iter().filter(|other| other.lane == *name).count();
    let number = shown[..place].iter().filter(|other| other.lane == *name).count();
    let width = lane.width / of_lane as f64;
    let across = left_of(&along);
    let low = end - across * (lane.width / 2.0 - width * number as f64) - along * STOP_LINE;
    Some([low, low + across * width, low + across * width + along * STOP_LINE, low + along * STOP_LINE])
}

/// The colour of a signal's letter.
pub fn signal_colour(letter: u8) -> &'static str {
    match letter {
        b'r' | b's' => "#e5383b",
        b'y' | b'Y' | b'u' => "#ffd60a",
        b'g' | b'G' => "#38b000",
        _ => "#8d99ae",
    }
}
