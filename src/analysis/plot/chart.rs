//! What every chart shares: the ink, the colours of severities, and how to draw one on any backend.

use plotters::coord::Shift;
use plotters::prelude::{DrawingArea, DrawingBackend, RGBColor};

use crate::analysis::dataset::Conflicts;
use crate::detection::kind::Severity;

/// What stands around a chart.
pub(super) const INK: RGBColor = RGBColor(28, 33, 40);

/// The colour of a severity, as on the report's light page.
pub(super) fn colour(severity: Severity) -> RGBColor {
    match severity {
        Severity::Caution => RGBColor(0xc4, 0x8a, 0x00),
        Severity::Serious => RGBColor(0xd1, 0x43, 0x1f),
        Severity::Critical => RGBColor(0x6a, 0x1b, 0x9a),
    }
}

/// What can be drawn on any backend.
pub(super) trait Chart {
    /// Draws it.
    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        conflicts: &Conflicts,
    ) -> std::result::Result<(), String>;
}

/// A backend's error in words.
pub(super) fn said(error: impl std::fmt::Display) -> String {
    error.to_string()
}
