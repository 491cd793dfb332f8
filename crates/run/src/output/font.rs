//! The font of all pictures, part of the program, so that none has to be installed.

/// DejaVu Sans, reduced to Latin, Greek and the signs of formulas.
pub const FONT: &[u8] = include_bytes!("font/DejaVuSans.ttf");
