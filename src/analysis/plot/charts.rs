//! Conflicts over time and the distributions of their measures, as bars stacked by severity.

use plotters::chart::ChartBuilder;
use plotters::coord::Shift;
use plotters::prelude::{Color, DashedLineSeries, DrawingArea, DrawingBackend, Rectangle, Text, WHITE};
use plotters::style::{IntoFont, TextStyle};

use super::chart::{Chart, INK, colour, message};
use super::font;
use crate::analysis::dataset::Conflicts;
use crate::detection::kind::Severity;
use crate::output::schema::LoggedConflict;
use crate::util::units::Second;

/// The number of bars of a distribution.
const BARS: f64 = 30.0;
/// The share of the values that the axis covers; values beyond it count in the last bar.
const COVERED: f64 = 0.99;
/// The possible widths of the time line's bars, in s, and the greatest number of bars.
const WIDTHS: [Second; 16] =
    [1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0, 120.0, 300.0, 600.0, 900.0, 1800.0, 3600.0, 7200.0, 14400.0, 86400.0];
const MOST_BARS: f64 = 80.0;
/// From this duration on, the bars of the time line are at least a minute wide.
const LONG: Second = 1200.0;

/// The margin above a chart, for the legend and the label of a threshold, in pixels.
const TOP: i32 = 76;
/// The position of the legend's first entry and the distance between entries, in pixels.
const LEGEND: (i32, i32) = (122, 140);

/// A measure whose distribution has a chart.
pub struct ChartedMeasure {
    /// The file's name.
    pub name: &'static str,
    title: &'static str,
    of: fn(&LoggedConflict) -> Option<f64>,
}

/// The measures that have a chart, the same as on the report's page.
pub const MEASURES: [ChartedMeasure; 5] = [
    ChartedMeasure { name: "ttc", title: "Time to collision (TTC), s", of: |conflict| conflict.ttc },
    ChartedMeasure { name: "drac", title: "Deceleration to avoid it (DRAC), m/s²", of: |conflict| conflict.drac },
    ChartedMeasure { name: "pet", title: "Post-encroachment time (PET), s", of: |conflict| conflict.pet },
    ChartedMeasure { name: "margin", title: "Margin: gap − μ, m", of: |conflict| Some(conflict.margin) },
    ChartedMeasure {
        name: "delta_v",
        title: "Largest speed change in a collision (ΔV), m/s",
        of: |conflict| Some(conflict.delta_v()),
    },
];

/// Conflicts over time.
pub struct TimeLine;

/// The distribution of one measure.
pub struct Distribution(pub &'static ChartedMeasure);

/// Adjacent bars, the first of which begins at `low`.
struct Bars {
    low: f64,
    width: f64,
    /// Counts of each bar, by severity.
    counts: Vec<[u32; 3]>,
}

impl Bars {
    fn new(low: f64, high: f64, width: f64) -> Self {
        let many = ((high - low) / width).round().max(1.0) as usize;
        Self { low, width, counts: vec![[0; 3]; many] }
    }

    /// Counts a value; values beyond the axis count in the bar at its end.
    fn add(&mut self, value: f64, severity: Severity) {
        let bar = ((value - self.low) / self.width).floor().clamp(0.0, self.counts.len() as f64 - 1.0);
        self.counts[bar as usize][severity as usize] += 1;
    }
}

impl Chart for TimeLine {
    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>, found: &Conflicts) -> Result<(), String> {
        let (begin, end) = found.period();
        let length = (end - begin).max(1.0);
        let width = WIDTHS.into_iter().find(|width| length / width <= MOST_BARS).unwrap_or(86400.0);
        let width = if length >= LONG { width.max(60.0) } else { width };
        let low = (begin / width).floor() * width;
        let mut bars = Bars::new(low, low + ((end - low) / width).floor() * width + width, width);
        found.numbers(|conflict| Some(conflict.time)).for_each(|(severity, time)| bars.add(time, severity));
        draw(area, &bars, "Time, s", &format!("Conflicts per {width} s"), None)
    }
}

impl Chart for Distribution {
    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>, found: &Conflicts) -> Result<(), String> {
        let threshold = found.threshold(self.0.name);
        let mut sizes = found.numbers(self.0.of).map(|(_, value)| value.abs()).collect::<Vec<_>>();
        sizes.sort_by(f64::total_cmp);
        let covered = sizes.get((COVERED * sizes.len() as f64) as usize).or(sizes.last()).copied().unwrap_or(1.0);
        let furthest = round_up(covered.max(threshold.map_or(0.0, |threshold| threshold * 1.3)));
        // The width is chosen so that a threshold lies between two bars.
        let width = threshold.map_or(furthest / BARS, |at| at / (at * BARS / furthest).round().max(1.0));
        let reach = (furthest / width - 1e-9).ceil() * width;
        // Only a log of a wider condition has margins above 0.
        let has_positive = || found.numbers(self.0.of).any(|(_, value)| value > 0.0);
        let high = if self.0.name != "margin" || has_positive() { reach } else { 0.0 };
        let low = if self.0.name == "margin" { -reach } else { 0.0 };
        let mut bars = Bars::new(low, high, width);
        found.numbers(self.0.of).for_each(|(severity, value)| bars.add(value, severity));
        let words = if self.0.name == "ttc" { "serious below" } else { "serious above" };
        draw(area, &bars, self.0.title, "Conflicts", threshold.map(|at| (at, words)))
    }
}

fn draw<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    bars: &Bars,
    x_title: &str,
    y_title: &str,
    threshold: Option<(f64, &str)>,
) -> Result<(), String> {
    let highest = bars.counts.iter().map(|counts| counts.iter().sum::<u32>()).max().unwrap_or(0);
    let top = f64::from(highest.max(1)) * 1.08;
    let end = bars.low + bars.width * bars.counts.len() as f64;
    let font = |size: i32| TextStyle::from((font::NAME, size).into_font()).color(&INK);
    let mut chart = ChartBuilder::on(area)
        .margin(24)
        .margin_right(48)
        .margin_top(TOP)
        .x_label_area_size(72)
        .y_label_area_size(96)
        .build_cartesian_2d(bars.low..end, 0.0..top)
        .map_err(message)?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .light_line_style(WHITE.mix(0.0))
        .bold_line_style(INK.mix(0.15))
        .axis_style(INK)
        .label_style(font(24))
        .axis_desc_style(font(26))
        .x_desc(x_title)
        .y_desc(y_title)
        .x_label_formatter(&|value| ((value * 100.0).round() / 100.0 + 0.0).to_string().replace('-', "−"))
        .y_label_formatter(&|value| format!("{value:.0}"))
        .draw()
        .map_err(message)?;
    for severity in Severity::ALL {
        let blocks = bars.counts.iter().enumerate().filter(|(_, counts)| counts[severity as usize] > 0);
        let blocks = blocks.map(|(bar, counts)| {
            let below = counts[..severity as usize].iter().sum::<u32>();
            let left = bars.low + bars.width * bar as f64;
            let corner = (left + 0.04 * bars.width, f64::from(below));
            let other = (left + 0.96 * bars.width, f64::from(below + counts[severity as usize]));
            Rectangle::new([corner, other], colour(severity).filled())
        });
        chart.draw_series(blocks).map_err(message)?;
        let x = LEGEND.0 + LEGEND.1 * severity as i32;
        area.draw(&Rectangle::new([(x, 16), (x + 16, 32)], colour(severity).filled())).map_err(message)?;
        area.draw(&Text::new(severity.name(), (x + 26, 14), font(24))).map_err(message)?;
    }
    if let Some((at, words)) = threshold {
        let line = [(at, 0.0), (at, top)];
        chart.draw_series(DashedLineSeries::new(line, 8, 6, INK.stroke_width(2))).map_err(message)?;
        let (x, y) = chart.backend_coord(&(at, top));
        area.draw(&Text::new(format!("{words} {at}"), (x + 4, y - 26), font(22))).map_err(message)?;
    }
    Ok(())
}

/// The least round number that is not below this.
fn round_up(value: f64) -> f64 {
    let power = 10_f64.powf(value.max(1e-3).log10().floor());
    let digits = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];
    digits.into_iter().map(|digit| digit * power).find(|round| *round >= value * 0.999).unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use crate::analysis::plot::charts::*;

    #[test]
    fn values_beyond_the_axis_count_at_its_end() {
        let mut bars = Bars::new(0.0, 10.0, 2.0);
        for value in [-1.0, 1.0, 9.9, 10.0, 99.0] {
            bars.add(value, Severity::Serious);
        }
        assert_eq!(bars.counts.iter().map(|counts| counts[1]).collect::<Vec<_>>(), [2, 0, 0, 0, 3]);
    }

    #[test]
    fn an_axis_ends_at_a_round_number() {
        assert_eq!([round_up(9.7), round_up(0.41), round_up(31.0)], [10.0, 0.5, 40.0]);
    }
}
