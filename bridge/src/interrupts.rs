//! Ctrl-C, SIGTERM and SIGHUP (a terminal that is gone): they end a command at once as long as that has nothing to keep,
//! and are told to it otherwise.

use std::cell::Cell;

use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

/// Who gets the signals: nobody, so that they end the process, or Python's handler of Ctrl-C, which keeps them until
/// somebody asks.
pub struct Interrupts<'py> {
    signals: Bound<'py, PyModule>,
    /// The signals, each with its handler so far; not those which whoever started the process, or called, wants otherwise
    /// than Python does.
    handlers: Vec<(Bound<'py, PyAny>, Bound<'py, PyAny>)>,
    end: Bound<'py, PyAny>,
    tell: Bound<'py, PyAny>,
    is_told: Cell<bool>,
    /// One that came while it was said who gets them.
    has_one: Cell<bool>,
}

impl<'py> Interrupts<'py> {
    /// From now on they end the process.
    pub fn new(py: Python<'py>) -> PyResult<Self> {
        let signals = py.import("signal")?;
        let (end, tell) = (signals.getattr("SIG_DFL")?, signals.getattr("default_int_handler")?);
        let mut handlers = Vec::new();
        for (signal, pythons) in [("SIGINT", &tell), ("SIGTERM", &end), ("SIGHUP", &end)] {
            // Not every system has all of them.
            let Ok(signal) = signals.getattr(signal) else { continue };
            let handler = signals.call_method1("getsignal", (&signal,))?;
            // Those of signals are equal, not the same object.
            if handler.eq(pythons)? {
                handlers.push((signal, handler));
            }
        }
        let interrupts = Self { signals, handlers, end, tell, is_told: Cell::new(true), has_one: Cell::new(false) };
        interrupts.end_the_process();
        Ok(interrupts)
    }

    /// From now on they end the process.
    pub fn end_the_process(&self) {
        if self.is_told.replace(false) {
            self.set(|_| &self.end);
            if self.has_one.take() {
                let _ = self.signals.getattr("SIGINT").and_then(|it| self.signals.call_method1("raise_signal", (it,)));
            }
        }
    }

    /// From now on they are told.
    pub fn tell(&self) {
        if !self.is_told.replace(true) {
            self.set(|_| &self.tell);
        }
    }

    /// Whether there was one since it was asked last; they are told from now on.
    pub fn had_any(&self) -> bool {
        self.tell();
        let is_pending = self.signals.py().check_signals().is_err();
        self.has_one.take() || is_pending
    }

    fn set<'a>(&'a self, to: impl Fn(&'a Bound<'py, PyAny>) -> &'a Bound<'py, PyAny>) {
        for (signal, before) in &self.handlers {
            let set = || self.signals.call_method1("signal", (signal, to(before)));
            // Another thread than the first may not set it, and does not get it.
            if set().is_err_and(|error| error.is_instance_of::<PyKeyboardInterrupt>(signal.py())) {
                // Python told of one that was there already, and set nothing.
                self.has_one.set(true);
                let _ = set();
            }
        }
    }
}

impl Drop for Interrupts<'_> {
    fn drop(&mut self) {
        self.set(|before| before);
    }
}
