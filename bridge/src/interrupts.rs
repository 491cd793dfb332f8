//! Ctrl-C: it ends a command at once as long as that has nothing to keep, and is told to it from then on.

use std::cell::RefCell;

use pyo3::prelude::*;

/// Python's handler of SIGINT, and whether it is in its place. With it, Ctrl-C waits until somebody asks.
pub struct Interrupts<'py> {
    signals: Bound<'py, PyModule>,
    /// The handler that was taken away; none where it is in its place, or was not Python's own.
    taken: RefCell<Option<Bound<'py, PyAny>>>,
}

impl<'py> Interrupts<'py> {
    /// Lets Ctrl-C end the process, unless whoever started it, or called, wants that otherwise.
    pub fn new(py: Python<'py>) -> PyResult<Self> {
        let signals = py.import("signal")?;
        let handler = signals.call_method1("getsignal", (signals.getattr("SIGINT")?,))?;
        let is_pythons = handler.is(&signals.getattr("default_int_handler")?);
        let default = signals.getattr("SIG_DFL")?;
        let interrupts = Self { signals, taken: RefCell::new(None) };
        // Another thread than the first may not, and is not interrupted.
        if is_pythons && interrupts.set(&default).is_ok() {
            interrupts.taken.replace(Some(handler));
        }
        Ok(interrupts)
    }

    /// From now on Ctrl-C is told.
    pub fn tell(&self) {
        if let Some(handler) = self.taken.take() {
            // Nothing better is left than that it goes on ending the process.
            let _ = self.set(&handler);
        }
    }

    /// Whether there was one since it was asked last.
    pub fn had_any(&self) -> bool {
        self.tell();
        self.signals.py().check_signals().is_err()
    }

    fn set(&self, handler: &Bound<PyAny>) -> PyResult<()> {
        self.signals.call_method1("signal", (self.signals.getattr("SIGINT")?, handler)).map(|_| ())
    }
}
