//! Conflicts over time and the distributions of their measures, as bars stacked by severity.

use plotters::chart::ChartBuilder;
use plotters::coord::Shift;
use plotters::prelude::{Color, DashedLineSeries, DrawingArea, DrawingBackend, Rectangle, Text, WHITE};

use super::chart::{Chart, INK, PictureStyle, colour, message};
use crate::dataset::Conflicts;
use closecall::detection::kind::Severity;
use closecall::util::units::Second;

/// The number of bars of a distribution.
const BARS: f64 = 30.0;
/// The share of the values that the axis covers; values beyond it count in a bar of their own.
const COVERED: f64 = 0.99;
/// The possible widths of the time line's bars, in s, and the greatest number of bars.
const WIDTHS: [Second; 16] =
    [1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0, 120.0, 300.0, 600.0, 900.0, 1800.0, 3600.0, 7200.0, 14400.0, 86400.0];
const MOST_BARS: f64 = 80.0;
/// Where a bar of values beyond the axis begins and ends, in widths of a bar behind the last one.
const APART: (f64, f64) = (1.0, 2.5);
/// From this duration on, the bars of the time line are at least a minute wide.
const LONG: Second = 1200.0;

/// The margin above a chart, for its title, the legend and the labels of a threshold, in pixels on a screen.
const TOP: i32 = 116;
/// The left edge of title and legend, the top of each, and the distance between the legend's entries.
const LEFT: i32 = 24;
const TITLE: i32 = 12;
const LEGEND: i32 = 50;
const ENTRY: i32 = 140;

/// A measure whose distribution has a chart.
pub(crate) struct ChartedMeasure {
    /// The file's name.
    pub name: &'static str,
    title: &'static str,
    /// What the axis says.
    axis: &'static str,
    /// Its columns in the log, of which the largest value counts.
    columns: &'static [&'static str],
}

/// The measures that have a chart, the same as on the report's page.
pub(crate) const MEASURES: [ChartedMeasure; 5] = [
    ChartedMeasure { name: "ttc", title: "Time to collision", axis: "TTC, s", columns: &["ttc"] },
    ChartedMeasure {
        name: "drac", title: "Deceleration to avoid a collision", axis: "DRAC, m/s²", columns: &["drac"]
    },
    ChartedMeasure { name: "pet", title: "Post-encroachment time", axis: "PET, s", columns: &["pet"] },
    ChartedMeasure { name: "margin", title: "Margin", axis: "gap − μ, m", columns: &["margin"] },
    ChartedMeasure {
        name: "delta_v",
        title: "Largest speed change in a collision",
        axis: "ΔV, m/s",
        columns: &["ego_delta_v", "foe_delta_v"],
    },
];

/// Conflicts over time.
pub(crate) struct TimeLine;

/// The distribution of one measure.
pub(crate) struct Distribution(pub &'static ChartedMeasure);

/// Adjacent bars, the first of which begins at `low`.
struct Bars {
    low: f64,
    width: f64,
    /// Counts of each bar, by severity.
    counts: Vec<[u32; 3]>,
    /// Counts below the first bar and above the last, by severity.
    beyond: [[u32; 3]; 2],
}

/// What is written around the bars.
struct Words<'a> {
    title: &'a str,
    x: &'a str,
    y: &'a str,
    threshold: Option<(f64, &'a str)>,
}

impl Bars {
    fn new(low: f64, high: f64, width: f64) -> Self {
        let many = ((high - low) / width).round().max(1.0) as usize;
        Self { low, width, counts: vec![[0; 3]; many], beyond: [[0; 3]; 2] }
    }

    /// Counts a value; values beyond the axis count in a bar of their own.
    fn add(&mut self, value: f64, severity: Severity) {
        // A value at the very end is in the last bar.
        let last = self.counts.len() - 1;
        let bar = if value == self.end() { last as f64 } else { ((value - self.low) / self.width).floor() };
        let counts = match bar as usize {
            _ if bar < 0.0 => &mut self.beyond[0],
            bar if bar <= last => &mut self.counts[bar],
            _ => &mut self.beyond[1],
        };
        counts[severity as usize] += 1;
    }

    /// Where the last bar ends.
    fn end(&self) -> f64 {
        self.low + self.width * self.counts.len() as f64
    }

    /// The left and the right edge of each bar with its counts, those beyond included, which stand apart.
    fn all(&self) -> Vec<(f64, f64, [u32; 3])> {
        let within = self.counts.iter().enumerate().map(|(bar, counts)| {
            let left = self.low + self.width * bar as f64;
            (left + 0.04 * self.width, left + 0.96 * self.width, *counts)
        });
        let [below, above] = self.beyond;
        let apart = [(self.low - APART.1 * self.width, below), (self.end() + APART.0 * self.width, above)];
        let apart = apart.map(|(left, counts)| (left, left + (APART.1 - APART.0) * self.width, counts));
        within.chain(apart).filter(|(_, _, counts)| counts.iter().sum::<u32>() > 0).collect()
    }

    /// Both ends of the axis, which has room for bars that stand apart.
    fn reach(&self) -> [f64; 2] {
        let room = self.beyond.map(|counts| if counts == [0; 3] { 0.0 } else { (APART.1 + 0.5) * self.width });
        [self.low - room[0], self.end() + room[1]]
    }
}

impl Chart for TimeLine {
    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        found: &Conflicts,
        style: PictureStyle,
    ) -> Result<(), String> {
        let (begin, end) = found.period();
        let length = (end - begin).max(1.0);
        let width = WIDTHS.into_iter().find(|width| length / width <= MOST_BARS).unwrap_or(86400.0);
        let width = if length >= LONG { width.max(60.0) } else { width };
        let low = (begin / width).floor() * width;
        let mut bars = Bars::new(low, low + ((end - low) / width).floor() * width + width, width);
        found.numbers(&["time"]).for_each(|(severity, time)| bars.add(time, severity));
        let y = format!("Conflicts per {width} s");
        draw(area, &bars, &Words { title: "Conflicts over time", x: "Time, s", y: &y, threshold: None }, style)
    }
}

impl Chart for Distribution {
    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        found: &Conflicts,
        style: PictureStyle,
    ) -> Result<(), String> {
        let threshold = found.threshold(self.0.name);
        let mut sizes = found.numbers(self.0.columns).map(|(_, value)| value.abs()).collect::<Vec<_>>();
        sizes.sort_by(f64::total_cmp);
        let covered = sizes.get((COVERED * sizes.len() as f64) as usize).or(sizes.last()).copied().unwrap_or(1.0);
        let furthest = round_up(covered.max(threshold.map_or(0.0, |threshold| threshold * 1.3)));
        // The width is chosen so that a threshold lies between two bars.
        let width = threshold.map_or(furthest / BARS, |at| at / (at * BARS / furthest).round().max(1.0));
        let reach = (furthest / width - 1e-9).ceil() * width;
        // Only a log of a wider condition has margins above 0.
        let has_positive = || found.numbers(self.0.columns).any(|(_, value)| value > 0.0);
        let high = if self.0.name != "margin" || has_positive() { reach } else { 0.0 };
        let low = if self.0.name == "margin" { -reach } else { 0.0 };
        let mut bars = Bars::new(low, high, width);
        found.numbers(self.0.columns).for_each(|(severity, value)| bars.add(value, severity));
        let words = if self.0.name == "ttc" { "serious below" } else { "serious above" };
        let threshold = threshold.map(|at| (at, words));
        draw(area, &bars, &Words { title: self.0.title, x: self.0.axis, y: "Conflicts", threshold }, style)
    }
}

fn draw<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    bars: &Bars,
    words: &Words,
    style: PictureStyle,
) -> Result<(), String> {
    let all = bars.all();
    let highest = all.iter().map(|(_, _, counts)| counts.iter().sum::<u32>()).max().unwrap_or(0);
    let top = f64::from(highest.max(1)) * 1.08;
    let pixels = |on_screen| style.pixels(on_screen);
    let write =
        |text: &str, (x, y): (i32, i32)| area.draw(&Text::new(text.to_owned(), (x, y), style.text())).map_err(message);
    let [low, high] = bars.reach();
    let mut chart = ChartBuilder::on(area)
        .margin(pixels(24))
        .margin_right(pixels(48))
        .margin_top(pixels(TOP))
        .x_label_area_size(pixels(72))
        .y_label_area_size(pixels(96))
        .build_cartesian_2d(low..high, 0.0..top)
        .map_err(message)?;
    let end = bars.end() + 1e-9 * bars.width;
    let is_within = |value: f64| (bars.low - 1e-9 * bars.width..=end).contains(&value);
    let mut mesh = chart.configure_mesh();
    if style == PictureStyle::Paper {
        mesh.x_labels(6).y_labels(5);
    }
    mesh.disable_x_mesh()
        .light_line_style(WHITE.mix(0.0))
        .bold_line_style(INK.mix(0.15))
        .axis_style(INK)
        .label_style(style.text())
        .axis_desc_style(style.text())
        .x_desc(words.x)
        .y_desc(words.y)
        // No number stands below a bar of values beyond the axis: its label says what is in it.
        .x_label_formatter(&|value| {
            let text = ((value * 100.0).round() / 100.0 + 0.0).to_string().replace('-', "−");
            if is_within(*value) { text } else { String::new() }
        })
        .y_label_formatter(&|value| format!("{value:.0}"))
        .draw()
        .map_err(message)?;
    write(words.title, (pixels(LEFT), pixels(TITLE)))?;
    for severity in Severity::ALL {
        let blocks = all.iter().filter(|(_, _, counts)| counts[severity as usize] > 0).map(|(left, right, counts)| {
            let below = counts[..severity as usize].iter().sum::<u32>();
            let upper = f64::from(below + counts[severity as usize]);
            Rectangle::new([(*left, f64::from(below)), (*right, upper)], colour(severity).filled())
        });
        chart.draw_series(blocks).map_err(message)?;
        let x = pixels(LEFT + ENTRY * severity as i32);
        let key = [(x, pixels(LEGEND + 2)), (x + pixels(16), pixels(LEGEND + 18))];
        area.draw(&Rectangle::new(key, colour(severity).filled())).map_err(message)?;
        write(severity.name(), (x + pixels(24), pixels(LEGEND)))?;
    }
    for (counts, edge, sign, to_left) in
        [(bars.beyond[0], bars.low, "<", false), (bars.beyond[1], bars.end(), ">", true)]
    {
        let many = counts.iter().sum::<u32>();
        if many > 0 {
            let edge = ((edge * 100.0).round() / 100.0 + 0.0).to_string().replace('-', "−");
            let text = format!("{sign} {edge}: {many}");
            let wide = style.text().font.box_size(&text).map_err(message)?.0 as i32;
            let (x, y) = chart.backend_coord(&(if to_left { high } else { low }, f64::from(many)));
            write(&text, (if to_left { x - wide } else { x }, y - pixels(28)))?;
        }
    }
    if let Some((at, threshold)) = words.threshold {
        let line = [(at, 0.0), (at, top)];
        chart
            .draw_series(DashedLineSeries::new(line, pixels(8) as u32, pixels(6) as u32, INK.stroke_width(2)))
            .map_err(message)?;
        let (x, y) = chart.backend_coord(&(at, top));
        write(&format!("{threshold} {at}"), (x + 4, y - pixels(28)))?;
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
    use crate::plot::charts::*;

    #[test]
    fn values_beyond_the_axis_have_bars_of_their_own() {
        let mut bars = Bars::new(0.0, 10.0, 2.0);
        for value in [-1.0, 1.0, 9.9, 10.0, 99.0] {
            bars.add(value, Severity::Serious);
        }
        assert_eq!(bars.counts.iter().map(|counts| counts[1]).collect::<Vec<_>>(), [1, 0, 0, 0, 2]);
        assert_eq!(bars.beyond.map(|counts| counts[1]), [1, 1]);
        let [low, high] = bars.reach();
        assert!(bars.all().iter().all(|(left, right, _)| low < *left && *right < high));
        assert_eq!(bars.all().len(), 4);
    }

    #[test]
    fn an_axis_ends_at_a_round_number() {
        assert_eq!([round_up(9.7), round_up(0.41), round_up(31.0)], [10.0, 0.5, 40.0]);
    }
}
