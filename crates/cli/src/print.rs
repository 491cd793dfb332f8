//! How a command prints its results and reports a wrong value.

use std::fmt::Display;
use std::io::{ErrorKind, Write};

use super::error::{Error, Result};

/// Prints results. A reader that closes its end of the pipe early is not an error.
pub(super) fn print(text: impl Display) -> Result<()> {
    let mut output = std::io::stdout();
    match write!(output, "{text}").and_then(|()| output.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(value(format!("standard output: {error}"))),
        _ => Ok(()),
    }
}

/// The error for a value that cannot be used.
pub(super) fn value(message: impl Into<String>) -> Error {
    Error::Value(message.into())
}
