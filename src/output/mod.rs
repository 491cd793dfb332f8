//! What a run leaves on disk: its log, what was run, and files for other tools.

pub mod formats;
pub mod input_hash;
pub mod log;
pub mod record;
pub mod summary;
