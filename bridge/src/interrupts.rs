//! Ctrl-C, SIGTERM and SIGHUP (the terminal has closed). They end a command at once while it has no results to keep;
//! after that they are reported to it.

use std::cell::Cell;

use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

/// Switches the handling of the signals: they end the process, or Python's handler of Ctrl-C keeps them until the command
/// asks.
pub struct Interrupts<'py> {
    signals: Bound<'py, PyModule>,
    /// The signals, each with its former handler. A signal whose handler is not Python's own was set by the caller, and is
    /// left alone.
    handlers: Vec<(Bound<'py, PyAny>, Bound<'py, PyAny>)>,
    end: Bound<'py, PyAny>,
    report: Bound<'py, PyAny>,
    reports: Cell<bool>,
    /// Whether a signal arrived while the handlers were being set.
    has_pending: Cell<bool>,
}

impl<'py> Interrupts<'py> {
    /// From now on the signals end the process.
    pub fn new(py: Python<'py>) -> PyResult<Self> {
        let signals = py.import("signal")?;
        let end = signals.getattr("SIG_DFL")?;
        let report = signals.getattr("default_int_handler")?;
        let mut handlers = Vec::new();
        for (signal, pythons) in [("SIGINT", &report), ("SIGTERM", &end), ("SIGHUP", &end)] {
            // Not every system has all three.
            let Ok(signal) = signals.getattr(signal) else { continue };
            let handler = signals.call_method1("getsignal", (&signal,))?;
            // Equal handlers need not be the same object.
            if handler.eq(pythons)? {
                handlers.push((signal, handler));
            }
        }
        let reports = Cell::new(true);
        let interrupts = Self { signals, handlers, end, report, reports, has_pending: Cell::new(false) };
        interrupts.end_the_process();
        Ok(interrupts)
    }

    /// From now on the signals end the process.
    pub fn end_the_process(&self) {
        if self.reports.replace(false) {
            self.set(|_| &self.end);
            if self.has_pending.take() {
                let _ = self.signals.getattr("SIGINT").and_then(|it| self.signals.call_method1("raise_signal", (it,)));
            }
        }
    }

    /// From now on the signals are reported.
    pub fn report(&self) {
        if !self.reports.replace(true) {
            self.set(|_| &self.report);
        }
    }

    /// Whether a signal has arrived since the last call; from now on they are reported.
    pub fn had_any(&self) -> bool {
        self.report();
        let is_pending = self.signals.py().check_signals().is_err();
        self.has_pending.take() || is_pending
    }

    fn set<'a>(&'a self, to: impl Fn(&'a Bound<'py, PyAny>) -> &'a Bound<'py, PyAny>) {
        for (signal, before) in &self.handlers {
            let set = || self.signals.call_method1("signal", (signal, to(before)));
            // Only the main thread may set handlers, and only it gets signals.
            if set().is_err_and(|error| error.is_instance_of::<PyKeyboardInterrupt>(signal.py())) {
                // Python reported a signal that had arrived already, and set nothing.
                self.has_pending.set(true);
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
