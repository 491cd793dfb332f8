//! The font of all pictures, within the program: nothing has to be installed.

use plotters::style::{FontStyle, register_font};

use crate::{Error, Result};

/// DejaVu Sans, cut down to Latin, Greek and what formulas need.
const FONT: &[u8] = include_bytes!("font/DejaVuSans.ttf");
/// Its name in the pictures; an SVG viewer takes its own font of that name, or its own sans-serif.
pub(crate) const NAME: &str = "DejaVu Sans, sans-serif";

/// Makes the font known to the drawing library.
///
/// # Errors
/// [`Error::Value`] where the library does not take it.
pub(crate) fn register() -> Result<()> {
    let said = |_| Error::Value("the font of the pictures cannot be used".to_owned());
    register_font(NAME, FontStyle::Normal, FONT).map_err(said)
}
