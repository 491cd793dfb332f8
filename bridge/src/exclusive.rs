//! What only one thread uses at a time: others wait, and let Python go on meanwhile.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{self, ThreadId};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::sync::MutexExt;

/// A value that one thread uses at a time.
pub struct Exclusive<T> {
    value: Mutex<T>,
    user: Mutex<Option<ThreadId>>,
}

impl<T: Send> Exclusive<T> {
    pub fn new(value: T) -> Self {
        Self { value: Mutex::new(value), user: Mutex::new(None) }
    }

    /// Uses the value. Refused where this thread is using it already, as in a signal handler: it would wait for itself.
    pub fn with<R>(&self, py: Python, using: impl FnOnce(&mut T) -> PyResult<R>) -> PyResult<R> {
        let this = thread::current().id();
        if *own(&self.user) == Some(this) {
            return Err(PyRuntimeError::new_err("the checker is in the middle of a step"));
        }
        let mut value = self.value.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        let _user = User::new(&self.user, this);
        using(&mut value)
    }
}

/// The thread that is using the value.
struct User<'a>(&'a Mutex<Option<ThreadId>>);

impl<'a> User<'a> {
    fn new(user: &'a Mutex<Option<ThreadId>>, thread: ThreadId) -> Self {
        *own(user) = Some(thread);
        Self(user)
    }
}

impl Drop for User<'_> {
    fn drop(&mut self) {
        *own(self.0) = None;
    }
}

fn own<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
