//! Shared by all charts: the ink, the colours of severities, and the trait that draws on any backend.

use plotters::coord::Shift;
use plotters::prelude::{DrawingArea, DrawingBackend, RGBColor};

use crate::analysis::dataset::Conflicts;
use crate::detection::kind::Severity;
use crate::output::palette::{self, Ground};

/// The colour of text, axes and legends.
pub(super) const INK: RGBColor = RGBColor(28, 33, 40);

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
    ) -> std::result::Result<(), String>;
}

/// A backend's error as text.
pub(super) fn message(error: impl std::fmt::Display) -> String {
    error.to_string()
}
