//! The assumptions made in reading a recording.

/// What had to be assumed, a line each.
#[derive(Debug, Default)]
pub(crate) struct Said {
    /// For lack of columns that the files or the format do not have at all.
    pub missing: Vec<String>,
    /// Because of what is in the files.
    pub doubtful: Vec<String>,
}
