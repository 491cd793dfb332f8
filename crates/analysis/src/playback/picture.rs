//! A clip as an animated SVG, or as the stills of a film: the roads, the road users as rectangles, the predicted paths, and the
//! time left as a bar.
//!
//! No script and nothing from outside, so that it plays wherever pictures are shown, also in a README.

use std::fmt::Write;

use super::animation::{Changing, Loop};
use super::drawn_net::{roads, signals};
use super::found::Playback;
use super::view::{PANEL, SIZE, View, front, place_of};
use closecall::detection::kind::Severity;
use closecall::events::{ClipCategory, ClipUser};
use closecall::geometry::Point;
use closecall::util::units::{Metre, Second};
use closecall_run::output::palette::{Ground, hex};
use closecall_run::util::xml_text::escaped;

/// The time left at which the bar is full, in s.
const FULL: Second = 3.0;
/// Length of the bar.
const BAR: f64 = 300.0;

pub(super) const GRASS: &str = "#dfe5d8";
const INK: &str = "#1b1f23";
const OTHER: &str = "#d7dbe0";
const GLASS: &str = "#2b3036";
pub(super) const FONT: &str = "system-ui,-apple-system,Segoe UI,DejaVu Sans,sans-serif";

/// The clip as an SVG.
pub fn svg(playback: &Playback) -> String {
    picture(playback, &time_of(playback))
}

/// The clip as SVGs that stand still, this many for each second.
pub fn stills(playback: &Playback, rate: f64) -> Vec<String> {
    time_of(playback).stills(rate).map(|still| picture(playback, &still)).collect()
}

fn time_of(playback: &Playback) -> Loop {
    let times = &playback.clip.times;
    Loop::new(times, place_of(times, playback.conflict.time))
}

fn picture(playback: &Playback, time: &Loop) -> String {
    let Playback { conflict, clip, net, .. } = playback;
    let view = View::of(playback);
    let [width, height] = SIZE;
    let field = height - PANEL;
    let title = heading(playback);
    let full = format!("{title}: {} and {}", conflict.ego, conflict.foe);
    let full = escaped(&full);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"{FONT}\" \
         role=\"img\" aria-label=\"{full}\">\n<title>{full}</title>\n\
         <clipPath id=\"f\"><rect width=\"{width}\" height=\"{field}\"/></clipPath>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n\
         <g{}><rect width=\"{width}\" height=\"{field}\" fill=\"{GRASS}\"/>\n",
        // A still has edges, and the panel below covers the rest; to clip its roads takes longer than all else of it.
        if time.plays() { " clip-path=\"url(#f)\"" } else { "" }
    );
    if let Some(net) = net {
        text += &roads(net, &view);
        text += &signals(net, &clip.signals, &view, time);
    }
    text += &paths(playback, &view, time);
    let is_seen = |user: &&ClipUser| {
        user.category == ClipCategory::Obstacle
            || (0..clip.times.len()).filter_map(|place| front(user, place)).any(|at| view.sees(&[at], user.length))
    };
    for user in clip.users.iter().skip(2).filter(is_seen) {
        text += &road_user(user, None, playback, &view, time);
    }
    // The smaller one above, so that a vehicle does not hide the person that it hits.
    let [ego, foe] = [0, 1].map(|of| clip.users[of].length * clip.users[of].width);
    for of in if foe < ego { [0, 1] } else { [1, 0] } {
        text += &road_user(&clip.users[of], Some(of), playback, &view, time);
    }
    text += &conflict_point(playback, &view, time);
    text += "</g>\n";
    text += &panel(playback, &title, time);
    text + "</svg>\n"
}

fn heading(playback: &Playback) -> String {
    let conflict = &playback.conflict;
    let what = conflict.manoeuvre.as_str().replace('_', " ");
    let kind = conflict.kind.name().replace('_', "-");
    let what = if what.is_empty() { kind } else { format!("{kind}, {what}") };
    let crash = if conflict.collision { ", collision" } else { "" };
    format!("{} conflict: {what}{crash}", conflict.severity.name())
}

/// The colour of the pair at a place; none where it is in no conflict.
fn danger(playback: &Playback, place: usize) -> Option<String> {
    playback.clip.worst_so_far(place).map(|severity| hex(severity, Ground::Dark))
}

/// The predicted paths at the worst step, as wide as the road users, while the two are in conflict.
fn paths(playback: &Playback, view: &View, time: &Loop) -> String {
    let mut text = String::new();
    let seen = |place: usize| playback.clip.severity[place].is_some();
    for ((path, user), opacity) in playback.paths().iter().zip(&playback.clip.users).zip([0.55, 0.3]).rev() {
        if path.len() < 2 {
            continue;
        }
        let colour = |place: usize| danger(playback, place).unwrap_or_else(|| OTHER.to_owned());
        let (points, width) = (view.points(path), user.width.max(0.5) * view.scale());
        let Changing { first, changes } = time.jumps("stroke", colour);
        let band = format!(
            "<polyline points=\"{points}\" fill=\"none\" {first} stroke-width=\"{width:.1}\" \
             stroke-opacity=\"{opacity}\">{changes}</polyline>"
        );
        text += &time.seen(seen, &band);
    }
    text
}

/// A road user that moves; `of` is 0 for the ego and 1 for the foe.
fn road_user(user: &ClipUser, of: Option<usize>, playback: &Playback, view: &View, time: &Loop) -> String {
    let count = playback.clip.times.len();
    let Some(first) = (0..count).find_map(|place| front(user, place)) else { return String::new() };
    if user.category == ClipCategory::Obstacle {
        let outline = |part: &Vec<[Metre; 2]>| part.iter().map(|[x, y]| Point::new(*x, *y)).collect::<Vec<_>>();
        let parts = user.outlines.iter().map(outline);
        return parts.map(|part| format!("<polygon points=\"{}\" fill=\"#7f5539\"/>\n", view.points(&part))).collect();
    }
    let (mut places, mut turns) = (Vec::new(), Vec::new());
    let (mut last, mut turned) = (first, user.heading.iter().flatten().next().copied().unwrap_or_default());
    for place in 0..count {
        last = front(user, place).unwrap_or(last);
        let heading = user.heading[place].unwrap_or(turned);
        // The short way round.
        let turn = (heading - turned + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        turned += turn;
        places.push(view.to_picture(last));
        turns.push([-turned.to_degrees()]);
    }
    let (length, width) = (user.length * view.scale(), user.width * view.scale());
    let fill = |place: usize| of.and_then(|_| danger(playback, place)).unwrap_or_else(|| OTHER.to_owned());
    let Changing { first: colour, changes: change } = time.jumps("fill", fill);
    let body = if user.category == ClipCategory::Person {
        let radius = width.max(length).max(8.0) / 2.0;
        format!("<circle r=\"{radius:.1}\" {colour} stroke=\"{INK}\">{change}</circle>")
    } else {
        let (round, half) = ((width / 4.0).min(5.0), width / 2.0);
        // The windscreen tells front from rear.
        let (back, deep) = (0.3 * length.min(3.0 * width), 0.14 * length.min(3.0 * width));
        format!(
            "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{length:.1}\" height=\"{width:.1}\" rx=\"{round:.1}\" {colour} \
             stroke=\"{INK}\">{change}</rect><rect x=\"{:.1}\" y=\"{:.1}\" width=\"{deep:.1}\" height=\"{:.1}\" rx=\"2\" \
             fill=\"{GLASS}\"/>",
            -length,
            -half,
            -back - deep / 2.0,
            -0.4 * width,
            0.8 * width
        )
    };
    let (ring, name) = match of {
        Some(of) => (ring(user, of, view), label(of)),
        None => (String::new(), String::new()),
    };
    let turn = time.transform("rotate", |place| turns[place]);
    let go = time.transform("translate", |place| places[place]);
    let all = format!("<g {}>{}<g {}>{}{ring}{body}</g>{name}</g>\n", go.first, go.changes, turn.first, turn.changes);
    time.seen(|place: usize| user.x[place].is_some(), &all)
}

/// The ring around the ego, solid, or the foe, dashed.
fn ring(user: &ClipUser, of: usize, view: &View) -> String {
    let margin = 5.0;
    let (length, width) = (user.length * view.scale() + 2.0 * margin, user.width * view.scale() + 2.0 * margin);
    let style = if of == 0 { "stroke-width=\"3\"" } else { "stroke-width=\"2\" stroke-dasharray=\"6 4\"" };
    format!(
        "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{length:.1}\" height=\"{width:.1}\" rx=\"9\" fill=\"none\" stroke=\"#fff\" \
         {style}/>",
        margin - length,
        -width / 2.0
    )
}

fn label(of: usize) -> String {
    let name = ["ego", "foe"][of];
    format!(
        "<text x=\"24\" y=\"6\" font-size=\"17\" font-weight=\"600\" fill=\"#fff\" stroke=\"{INK}\" \
         stroke-width=\"4\" paint-order=\"stroke\">{name}</text>"
    )
}

fn conflict_point(playback: &Playback, view: &View, time: &Loop) -> String {
    let [x, y] = view.to_picture(Point::new(playback.conflict.x, playback.conflict.y));
    let cross = format!("M{:.1} {:.1}l16 16m0 -16l-16 16", x - 8.0, y - 8.0);
    let drawn = format!(
        "<g fill=\"none\" stroke-linecap=\"round\"><path d=\"{cross}\" stroke=\"{INK}\" stroke-width=\"8\"/><path \
         d=\"{cross}\" stroke=\"#fff\" stroke-width=\"4\"/></g>\n"
    );
    time.seen(|place| playback.clip.severity[place].is_some(), &drawn)
}

/// Below the roads: what it is, the time left, where in time one is, and what the colours mean.
fn panel(playback: &Playback, title: &str, time: &Loop) -> String {
    let Playback { conflict, clip, .. } = playback;
    let [width, height] = SIZE;
    let top = height - PANEL;
    let mut text = format!(
        "<rect y=\"{top}\" width=\"{width}\" height=\"{PANEL}\" fill=\"#fff\"/>\n<g fill=\"{INK}\" font-size=\"15\">\n\
         <text x=\"16\" y=\"{:.0}\" font-size=\"18\" font-weight=\"600\">{}</text>\n",
        top + 28.0,
        title
    );
    // The bar.
    let (x, y) = (118.0, top + 46.0);
    let _ = write!(
        text,
        "<text x=\"16\" y=\"{:.0}\">time left</text><rect x=\"{x}\" y=\"{y}\" width=\"{BAR}\" height=\"20\" fill=\"#e7e9ec\"/>",
        y + 15.0
    );
    let length = |place: usize| clip.time_left[place].map_or(0.0, |left| (left / FULL).clamp(0.0, 1.0) * BAR);
    let colour = |place: usize| hex(clip.worst_so_far(place).unwrap_or(Severity::Caution), Ground::Light);
    let (length, colour) = (time.smooth("width", length), time.jumps("fill", colour));
    let _ = writeln!(
        text,
        "<rect x=\"{x}\" y=\"{y}\" height=\"20\" {} {}>{}{}</rect>",
        length.first, colour.first, length.changes, colour.changes
    );
    let needed = (playback.response * 100.0).round() / 100.0;
    let mark = x + (needed / FULL).min(1.0) * BAR;
    let _ = writeln!(
        text,
        "<path d=\"M{mark:.1} {:.1}v28\" stroke=\"{INK}\" stroke-width=\"2\"/><text x=\"{mark:.1}\" y=\"{:.1}\" \
         text-anchor=\"middle\" font-size=\"12\">a driver needs {needed} s</text>",
        y - 4.0,
        y + 35.0
    );
    text += &numbers(x + BAR + 12.0, y + 15.0, time, clip.times.len(), |place| {
        clip.time_left[place].map_or_else(|| "–".to_owned(), |left| format!("{left:.1} s"))
    });
    let worst = clip.times[place_of(&clip.times, conflict.time)];
    text += &numbers(width - 16.0 - 78.0, top + 28.0, time, clip.times.len(), |place| {
        let apart = clip.times[place] - worst;
        if apart == 0.0 { "worst step".to_owned() } else { format!("{apart:+.1} s").replace('-', "−") }
    });
    let mut x = 508.0;
    for severity in Severity::ALL {
        let (name, colour) = (severity.name(), hex(severity, Ground::Dark));
        let _ = write!(
            text,
            "<rect x=\"{x}\" y=\"{:.0}\" width=\"16\" height=\"16\" rx=\"3\" fill=\"{colour}\" stroke=\"{INK}\"/>\
             <text x=\"{:.0}\" y=\"{:.0}\">{name}</text>",
            y + 2.0,
            x + 22.0,
            y + 15.0
        );
        x += 92.0;
    }
    for (name, style) in [("ego", "stroke-width=\"3\""), ("foe", "stroke-width=\"2\" stroke-dasharray=\"5 3\"")] {
        let _ = write!(
            text,
            "<rect x=\"{x}\" y=\"{:.0}\" width=\"26\" height=\"16\" rx=\"5\" fill=\"none\" stroke=\"{INK}\" {style}/>\
             <text x=\"{:.0}\" y=\"{:.0}\">{name}</text>",
            y + 2.0,
            x + 32.0,
            y + 15.0
        );
        x += 70.0;
    }
    text + "\n</g>\n"
}

/// A text that changes: all its texts in one place, one seen at a time.
fn numbers(x: f64, y: f64, time: &Loop, count: usize, text_at: impl Fn(usize) -> String) -> String {
    let mut texts = (0..count).map(&text_at).collect::<Vec<_>>();
    texts.sort_unstable();
    texts.dedup();
    let drawn = texts.iter().map(|text| {
        let drawn = format!("<text x=\"{x}\" y=\"{y}\">{text}</text>\n");
        time.seen(|place: usize| text_at(place) == *text, &drawn)
    });
    drawn.collect()
}
