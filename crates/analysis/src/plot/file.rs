//! Pictures are drawn in memory and then written.

use std::fmt::Display;
use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::{BitMapBackend, DrawingArea, IntoDrawingArea, SVGBackend};

use crate::{Error, Result};
use closecall_run::util::output_file;
use closecall_run::util::xml_text::valid;

/// Writes a PNG with red, green and blue of one byte each.
///
/// # Errors
/// [`Error::content`] where `draw` fails, [`Error::file`] where the file cannot be written.
pub(crate) fn png<E: Display>(
    path: &Path,
    size: (u32, u32),
    draw: impl FnOnce(DrawingArea<BitMapBackend<'_>, Shift>) -> std::result::Result<(), E>,
) -> Result<()> {
    let mut pixels = vec![0; 3 * size.0 as usize * size.1 as usize];
    draw(BitMapBackend::with_buffer(&mut pixels, size).into_drawing_area()).map_err(|error| undrawn(path, &error))?;
    let mut encoded = Vec::new();
    let mut encoder = png::Encoder::new(&mut encoded, size.0, size.1);
    encoder.set_color(png::ColorType::Rgb);
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(&pixels)?;
        writer.finish()
    });
    written.map_err(|error| undrawn(path, &error))?;
    Ok(output_file::write(path, &encoded)?)
}

/// Writes an SVG; with a `width` in mm it is shown that wide.
///
/// # Errors
/// [`Error::content`] where `draw` fails, [`Error::file`] where the file cannot be written.
pub(crate) fn svg<E: Display>(
    path: &Path,
    size: (u32, u32),
    width: Option<f64>,
    draw: impl FnOnce(DrawingArea<SVGBackend<'_>, Shift>) -> std::result::Result<(), E>,
) -> Result<()> {
    let mut text = String::new();
    draw(SVGBackend::with_string(&mut text, size).into_drawing_area()).map_err(|error| undrawn(path, &error))?;
    if let Some(width) = width {
        let high = width * f64::from(size.1) / f64::from(size.0);
        let (pixels, shown) = (
            format!("width=\"{}\" height=\"{}\"", size.0, size.1),
            format!("width=\"{width}mm\" height=\"{high:.2}mm\""),
        );
        text = text.replacen(&pixels, &shown, 1);
    }
    Ok(output_file::write(path, valid(&text).as_bytes())?)
}

fn undrawn(path: &Path, message: &impl Display) -> Error {
    Error::content(path, format!("it cannot be drawn: {message}"))
}
