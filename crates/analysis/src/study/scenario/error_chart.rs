//! The charts: size of the error over processor time. Steps have a row of panels for each integration, the other axes share
//! one; each panel is one measure.

use std::path::Path;

use super::comparison::{SHOWN, Study};
use super::plan::{Axis, Choice};
use crate::Result;
use crate::study::error_over_time::{self, Panel, Point};

/// Draws the charts of steps and of the other axes; returns their names.
pub(super) fn draw(study: &Study, folder: &Path) -> Result<Vec<&'static str>> {
    let mut drawn = Vec::new();
    let charts = [
        ("steps", true, "the recommended step; grey: the Pareto front; 0: what the others are compared with"),
        ("choices", false, "the present setting, which the others are compared with"),
    ];
    for (name, steps, note) in charts {
        let axes = study.plan.axes.iter().filter(|axis| axis.has_steps() == steps).collect::<Vec<_>>();
        if axes.is_empty() {
            continue;
        }
        let labels = axes.iter().map(|axis| labels(axis)).collect::<Vec<_>>();
        let points = |measure: &str, axis: usize| points(study, measure, axes[axis], &labels[axis]);
        let panels = if steps {
            let of = |axis: usize| SHOWN.map(|measure| panel(title(measure, axes[axis]), points(measure, axis)));
            (0..axes.len()).flat_map(of).collect::<Vec<_>>()
        } else {
            let of =
                |measure| panel(in_words(measure), (0..axes.len()).flat_map(|axis| points(measure, axis)).collect());
            SHOWN.map(of).into()
        };
        error_over_time::draw(folder, name, &panels, note)?;
        drawn.push(name);
    }
    Ok(drawn)
}

/// What the legend calls the choices of an axis.
fn labels(axis: &Axis) -> Vec<String> {
    let name = axis.name.trim_start_matches("sumo:");
    let label = |(at, choice): (usize, &Choice)| match choice.step {
        Some(_) => format!("{} s", choice.value),
        None if at == 0 => "present setting".to_owned(),
        None => format!("{name}={}", choice.value),
    };
    axis.choices.iter().enumerate().map(label).collect()
}

/// The choices of an axis in the panel of a measure.
fn points<'a>(study: &Study, measure: &str, axis: &Axis, labels: &'a [String]) -> Vec<Point<'a>> {
    let place = study.place(measure);
    let (errors, front) = (study.errors(axis, place), study.front(axis, place));
    let marked = if axis.has_steps() { study.recommended(axis, place) } else { 0 };
    let point = |at: usize| {
        Some(Point {
            x: study.run_time(axis.choices[at].setting).cpu,
            y: errors[at]?.value.abs(),
            method: &labels[at],
            on_front: axis.has_steps() && front[at],
            marked: at == marked,
        })
    };
    (0..axis.choices.len()).filter_map(point).collect()
}

fn panel(title: String, points: Vec<Point<'_>>) -> Panel<'_> {
    Panel { title, across: "processor time of a run, s", up: "relative error", points }
}

/// The measure, and how the axis differs from the user's own integration.
fn title(measure: &str, axis: &Axis) -> String {
    axis.name.split_once(", ").map_or(in_words(measure), |(_, with)| format!("{}, {with}", in_words(measure)))
}

fn in_words(measure: &str) -> String {
    measure.trim_end_matches("_per_vehicle_hour").trim_end_matches("_per_vehicle_kilometre").replace('_', " ")
}
