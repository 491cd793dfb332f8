//! Statistics as tables, printed as text, CSV or HTML.

mod brief;
mod cells;
mod contents;
mod html;
mod table_csv;
mod text;
mod two_sets;

pub use crate::statistics::table::table_csv::csv;
pub use brief::brief;
pub use contents::tables;
pub use html::html;
pub use text::text;
