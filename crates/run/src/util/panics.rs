//! Panics, which are faults of closecall itself, as errors: one line that says what to report.

use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind, set_hook};
use std::sync::{Mutex, PoisonError};

use crate::{Error, Result};

/// What the last panic said, and where.
static LAST: Mutex<Option<String>> = Mutex::new(None);

/// Keeps what a panic says for the error that it becomes, instead of printing it.
pub fn keep_quiet() {
    set_hook(Box::new(|panic: &PanicHookInfo| {
        let payload = panic.payload();
        let said = payload.downcast_ref::<&str>().copied().or(payload.downcast_ref::<String>().map(String::as_str));
        let said = said.unwrap_or("no message").replace('\n', " ");
        let place = panic.location().map(|place| format!(" ({}:{})", place.file(), place.line()));
        *LAST.lock().unwrap_or_else(PoisonError::into_inner) = Some(said + &place.unwrap_or_default());
    }));
}

/// What the last panic said; a panic is under way or was caught.
pub fn last() -> String {
    let last = LAST.lock().unwrap_or_else(PoisonError::into_inner).clone();
    last.unwrap_or_else(|| "a panic".to_owned())
}

/// Does this; a panic in it becomes an error. What it was working on must not be used again.
///
/// # Errors
/// [`Error::Internal`] for a panic.
pub fn caught<T>(action: impl FnOnce() -> T) -> Result<T> {
    catch_unwind(AssertUnwindSafe(action)).map_err(|_| Error::Internal(last()))
}

#[cfg(test)]
mod tests {
    use crate::util::panics::*;

    #[test]
    fn a_panic_becomes_an_error_of_its_own() {
        let error = caught(|| [1, 2][std::hint::black_box(5)]).unwrap_err();
        assert!(matches!(error, Error::Internal(_)));
        assert!(error.to_string().ends_with("please report this line with the command and its input"), "{error}");
        assert_eq!(caught(|| 7).unwrap(), 7);
    }
}
