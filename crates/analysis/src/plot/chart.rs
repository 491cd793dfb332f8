//! Shared by all charts: what they are for, the ink, the colours of severities, and the trait that draws on any backend.

use plotters::coord::Shift;
use plotters::prelude::{DrawingArea, DrawingBackend, RGBColor};
use plotters::style::{IntoFont, TextStyle};

use super::font;
use crate::dataset::Conflicts;
use closecall::detection::kind::Severity;
use closecall_run::output::palette::{self, Ground};

/// The colour of text, axes and legends.
pub(super) const INK: RGBColor = RGBColor(28, 33, 40);
/// The size of text on a screen, in pixels.
pub(super) const TEXT: i32 = 24;

/// What the pictures are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum PictureStyle {
    /// Slides and pages.
    Screen,
    /// A column of a paper: 85 mm wide, text of 8 pt, SVG.
    Paper,
}

impl PictureStyle {
    /// The width of a column, in mm.
    pub(super) const COLUMN: f64 = 85.0;
    /// Pixels are drawn four times as fine as CSS's, of which an inch has 96: 8 pt are 42.7 of them.
    pub(super) const FINE: f64 = 4.0 * 96.0 / 25.4;
    /// The width of a paper's picture, in these pixels.
    pub(super) const WIDTH: u32 = (Self::COLUMN * Self::FINE) as u32;
    /// The drawing library's size of text divided by that in the SVG.
    const OF_LIBRARY: f64 = 1.24;
    /// 8 pt in these pixels, divided by [`TEXT`].
    const LARGER: f64 = 8.0 / 72.0 * 25.4 * Self::FINE * Self::OF_LIBRARY / TEXT as f64;

    /// A length of the screen's pictures, in pixels, as this style has it beside its text.
    pub(super) fn pixels(self, on_screen: i32) -> i32 {
        match self {
            Self::Screen => on_screen,
            Self::Paper => (f64::from(on_screen) * Self::LARGER).round() as i32,
        }
    }

    /// The style of text.
    pub(super) fn text(self) -> TextStyle<'static> {
        TextStyle::from((font::NAME, self.pixels(TEXT)).into_font()).color(&INK)
    }
}

/// The colour of a severity, as on the report's light page.
pub(super) fn colour(severity: Severity) -> RGBColor {
    let [red, green, blue] = palette::colour(severity, Ground::Light);
    RGBColor(red, green, blue)
}

/// A chart that any backend can draw.
pub(super) trait Chart {
    /// Draws the chart.
    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        conflicts: &Conflicts,
        style: PictureStyle,
    ) -> std::result::Result<(), String>;
}

/// A backend's error as text.
pub(super) fn message(error: impl std::fmt::Display) -> String {
    error.to_string()
}
