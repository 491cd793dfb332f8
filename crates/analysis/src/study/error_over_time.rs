//! The charts of a study as SVG and PNG: error over run time, both logarithmic, in panels.

use std::ops::Range;
use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::Result;
use crate::plot::{file, font};

const FONT: &str = font::NAME;

/// Colours that colour-blind readers can distinguish (Okabe and Ito 2008).
const COLOURS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(230, 159, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(213, 94, 0),
    RGBColor(110, 110, 110),
    RGBColor(0, 0, 0),
];
const PANEL: (u32, u32) = (360, 280);
const LEGEND: u32 = 84;
const MOST_COLUMNS: usize = 3;

type Drawn<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// One panel: a title and its points.
pub struct Panel<'a> {
    /// What stands above it.
    pub title: String,
    /// What goes across, with its unit.
    pub across: &'a str,
    /// What goes up, with its unit.
    pub up: &'a str,
    /// Its points.
    pub points: Vec<Point<'a>>,
}

/// A method's place in a panel.
pub struct Point<'a> {
    /// Across; above 0.
    pub x: f64,
    /// Up; 0 stands at the lower end.
    pub y: f64,
    /// The method.
    pub method: &'a str,
    /// Whether the grey line joins it.
    pub on_front: bool,
    /// Whether it gets a ring, which the chart's note explains.
    pub marked: bool,
}

/// Draws the panels as `<name>.svg` and `<name>.png`; the note says what the ring and the grey line mean.
pub fn draw(folder: &Path, name: &str, panels: &[Panel], note: &str) -> Result<()> {
    font::register()?;
    let columns = panels.len().clamp(1, MOST_COLUMNS);
    let lines = panels.len().div_ceil(columns) as u32;
    let size = (PANEL.0 * columns as u32, PANEL.1 * lines + LEGEND);
    let file = |ending: &str| folder.join(format!("{name}.{ending}"));
    file::svg(&file("svg"), size, None, |area| page(area, panels, columns, note))?;
    file::png(&file("png"), size, |area| page(area, panels, columns, note))
}

fn page<DB: DrawingBackend>(area: DrawingArea<DB, Shift>, panels: &[Panel], columns: usize, note: &str) -> Drawn<()>
where
    DB::ErrorType: 'static,
{
    area.fill(&WHITE)?;
    let methods = distinct(panels.iter().flat_map(|panel| &panel.points).map(|point| point.method));
    let height = area.dim_in_pixel().1 - LEGEND;
    let (charts, legend) = area.split_vertically(height);
    for (panel, place) in panels.iter().zip(charts.split_evenly((panels.len().div_ceil(columns), columns))) {
        draw_panel(&place, panel, &methods)?;
    }
    draw_legend(&legend, &methods, note)?;
    area.present()?;
    Ok(())
}

fn draw_panel<DB: DrawingBackend>(area: &DrawingArea<DB, Shift>, panel: &Panel, methods: &[&str]) -> Drawn<()>
where
    DB::ErrorType: 'static,
{
    let floor = floor(panel);
    let height = |point: &Point| if point.y > 0.0 { point.y } else { floor };
    let across = decades(panel.points.iter().map(|point| point.x));
    let up = decades(panel.points.iter().map(height));
    let mut chart = ChartBuilder::on(area)
        .margin(8)
        .caption(&panel.title, (FONT, 15))
        .x_label_area_size(34)
        .y_label_area_size(58)
        .build_cartesian_2d(across.log_scale(), up.log_scale())?;
    let label = |value: &f64| match value / floor {
        part if part < 0.99 => String::new(),
        part if part < 1.01 => "0".to_owned(),
        _ => power_of_ten(*value),
    };
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(230, 230, 230))
        .x_desc(panel.across)
        .y_desc(panel.up)
        .x_label_formatter(&|value| power_of_ten(*value))
        .y_label_formatter(&label)
        .label_style((FONT, 11))
        .axis_desc_style((FONT, 12))
        .draw()?;
    let mut front = panel.points.iter().filter(|point| point.on_front).collect::<Vec<_>>();
    front.sort_by(|a, b| a.x.total_cmp(&b.x));
    let steps = front.iter().enumerate().flat_map(|(index, point)| {
        let corner = front.get(index + 1).map(|next| (next.x, height(point)));
        [Some((point.x, height(point))), corner].into_iter().flatten()
    });
    chart.draw_series(LineSeries::new(steps, RGBColor(170, 170, 170).stroke_width(2)))?;
    for (index, method) in methods.iter().enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
        let points = panel.points.iter().filter(|point| point.method == *method).collect::<Vec<_>>();
        chart.draw_series(LineSeries::new(points.iter().map(|point| (point.x, height(point))), colour.mix(0.6)))?;
        for point in points {
            let place = (point.x, height(point));
            chart.draw_series([Circle::new(place, 4, colour.filled())])?;
            if point.marked {
                chart.draw_series([Circle::new(place, 7, BLACK.stroke_width(1))])?;
            }
        }
    }
    Ok(())
}

fn draw_legend<DB: DrawingBackend>(area: &DrawingArea<DB, Shift>, methods: &[&str], note: &str) -> Drawn<()>
where
    DB::ErrorType: 'static,
{
    let width = area.dim_in_pixel().0 as i32;
    let per_line = (width / 190).max(1);
    for (index, method) in methods.iter().enumerate() {
        let (column, line) = (index as i32 % per_line, index as i32 / per_line);
        let place = (16 + column * 190, 14 + line * 20);
        area.draw(&Circle::new(place, 4, COLOURS[index % COLOURS.len()].filled()))?;
        area.draw(&Text::new((*method).to_owned(), (place.0 + 12, place.1 - 7), (FONT, 13)))?;
    }
    let lines = (methods.len() as i32).div_euclid(per_line) + 1;
    let place = (16, 14 + lines * 20);
    area.draw(&Circle::new(place, 7, BLACK.stroke_width(1)))?;
    area.draw(&Text::new(note.to_owned(), (place.0 + 12, place.1 - 7), (FONT, 13)))?;
    Ok(())
}

/// The height at which an error of 0 is drawn: a decade below the smallest.
fn floor(panel: &Panel) -> f64 {
    let errors = panel.points.iter().map(|point| point.y).filter(|error| *error > 0.0);
    let least = errors.fold(f64::INFINITY, f64::min);
    if least.is_finite() { 10_f64.powf(least.log10().floor() - 1.0) } else { 1e-3 }
}

/// The whole decades around these values.
fn decades(values: impl Iterator<Item = f64>) -> Range<f64> {
    let mut low = f64::INFINITY;
    let mut high = f64::NEG_INFINITY;
    for value in values {
        low = low.min(value.log10());
        high = high.max(value.log10());
    }
    if !low.is_finite() || !high.is_finite() {
        return 0.1..10.0;
    }
    10_f64.powf((low - 0.1).floor())..10_f64.powf((high + 0.1).ceil().max(low.floor() + 1.0))
}

fn power_of_ten(value: f64) -> String {
    let power = value.log10();
    match power.round() as i32 {
        _ if (power - power.round()).abs() > 1e-6 => String::new(),
        0 => "1".to_owned(),
        1 => "10".to_owned(),
        power => {
            let digits = power.abs().to_string();
            let raised = digits.chars().filter_map(|digit| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(digit.to_digit(10)? as usize));
            format!("10{}{}", if power < 0 { "⁻" } else { "" }, raised.collect::<String>())
        }
    }
}

/// Each name once, in the order of first appearance.
pub fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut distinct = Vec::new();
    for name in names {
        if !distinct.contains(&name) {
            distinct.push(name);
        }
    }
    distinct
}
