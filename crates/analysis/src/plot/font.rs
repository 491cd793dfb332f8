//! The font of the charts.

use plotters::style::{FontStyle, register_font};

use crate::{Error, Result};
use closecall_run::output::font::FONT;

/// The font's name in the pictures; an SVG viewer uses its own font of that name, or its own sans-serif.
pub(crate) const NAME: &str = "DejaVu Sans, sans-serif";

/// Registers the font with the drawing library.
///
/// # Errors
/// [`Error::Value`] if the library rejects it.
pub(crate) fn register() -> Result<()> {
    let rejected = |_| Error::Value("the font of the pictures cannot be used".to_owned());
    register_font(NAME, FontStyle::Normal, FONT).map_err(rejected)
}
