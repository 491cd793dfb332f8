//! Statistics as tables, printed as text, CSV or HTML.

mod cells;
mod compared;
mod contents;
mod csv;
mod html;
mod text;

pub use crate::statistics::table::csv::csv;
pub use contents::tables;
pub use html::html;
pub use text::text;
