//! Ctrl-C: it ends a command at once as long as that has nothing to keep, and is told to it otherwise.

use std::cell::Cell;

use pyo3::prelude::*;

/// Who gets SIGINT: nobody, so that it ends the process, or Python's own handler, which keeps it until somebody asks.
pub struct Interrupts<'py> {
    signals: Bound<'py, PyModule>,
    /// None where it is another's than Python's: whoever started the process, or called, wants that so.
    handler: Option<Bound<'py, PyAny>>,
    is_told: Cell<bool>,
}

impl<'py> Interrupts<'py> {
    /// From now on it ends the process.
    pub fn new(py: Python<'py>) -> PyResult<Self> {
        let signals = py.import("signal")?;
        let handler = signals.call_method1("getsignal", (signals.getattr("SIGINT")?,))?;
        let is_pythons = handler.is(&signals.getattr("default_int_handler")?);
        let interrupts = Self { signals, handler: is_pythons.then_some(handler), is_told: Cell::new(true) };
        interrupts.end_the_process();
        Ok(interrupts)
    }

    /// From now on it ends the process.
    pub fn end_the_process(&self) {
        self.set(false);
    }

    /// From now on it is told.
    pub fn tell(&self) {
        self.set(true);
    }

    /// Whether there was one since it was asked last; it is told from now on.
    pub fn had_any(&self) -> bool {
        self.tell();
        self.signals.py().check_signals().is_err()
    }

    fn set(&self, is_told: bool) {
        let Some(handler) = self.handler.as_ref().filter(|_| self.is_told.get() != is_told) else { return };
        let set = || {
            let default = self.signals.getattr("SIG_DFL")?;
            self.signals
                .call_method1("signal", (self.signals.getattr("SIGINT")?, if is_told { handler } else { &default }))
        };
        // Another thread than the first may not set it, and does not get it.
        let done: PyResult<_> = set();
        if done.is_ok() {
            self.is_told.set(is_told);
        }
    }
}
