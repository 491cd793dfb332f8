//! Work that Ctrl-C ends: it is done by a thread of its own while this one asks Python for signals.

use std::sync::atomic::Ordering;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use closecall::Result;
use closecall::internals::util::{Stop, caught, until};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// How often Python is asked.
const ASKED_EVERY: Duration = Duration::from_millis(20);
/// How long the work may take to remove its temporary files once it is to stop. What does not end by then goes on alone until
/// it comes to its next step.
const ENDS_WITHIN: Duration = Duration::from_millis(500);

/// Does the work; a signal for which Python raises an exception ends it. The work looks at the flag between its steps.
pub fn interruptibly<T: Send + 'static>(
    py: Python,
    work: impl FnOnce(&Stop) -> Result<T> + Send + 'static,
) -> PyResult<Result<T>> {
    let stop = Stop::default();
    let (sender, mut ended) = channel();
    let of_work = stop.clone();
    thread::Builder::new().spawn(move || {
        let done = caught(|| until(&of_work, || work(&of_work))).and_then(|done| done);
        // Nobody waits for it once the user has interrupted it.
        let _ = sender.send(done);
    })?;
    loop {
        let waits_for = &mut ended;
        match py.detach(move || waits_for.recv_timeout(ASKED_EVERY)) {
            Ok(done) => return Ok(done),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the replay's thread has ended"));
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
        if let Err(signal) = py.check_signals() {
            stop.store(true, Ordering::Relaxed);
            let waits_for = &mut ended;
            let _ = py.detach(move || waits_for.recv_timeout(ENDS_WITHIN));
            return Err(signal);
        }
    }
}
