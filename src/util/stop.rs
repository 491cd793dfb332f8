//! Whether work is to end before it is done, for reading and stepping that nobody else could interrupt.
//!
//! A thread that is given a flag ends its work soon after the flag is set: every file that it opens fails at its next block.

use std::cell::RefCell;
use std::fs::File;
use std::io::{Error, Read, Result};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that another thread sets.
pub type Stop = Arc<AtomicBool>;

thread_local! {
    static STOP: RefCell<Option<Stop>> = const { RefCell::new(None) };
}

/// Runs an action that ends early, with an error, where it reads files after the flag was set.
pub fn until<T>(stop: &Stop, action: impl FnOnce() -> T) -> T {
    let before = STOP.with(|of_thread| of_thread.replace(Some(stop.clone())));
    let result = action();
    STOP.with(|of_thread| of_thread.replace(before));
    result
}

/// A file that fails at its next block once the flag of the thread that opened it is set.
#[derive(Debug)]
pub struct StoppableFile {
    file: File,
    stop: Option<Stop>,
}

impl StoppableFile {
    /// The file, opened by this thread.
    pub fn new(file: File) -> Self {
        Self { file, stop: STOP.with(|of_thread| of_thread.borrow().clone()) }
    }
}

impl Read for StoppableFile {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        if self.stop.as_ref().is_some_and(|stop| stop.load(Ordering::Relaxed)) {
            return Err(Error::other("stopped"));
        }
        self.file.read(buffer)
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    #[test]
    fn a_file_fails_once_the_flag_of_its_thread_is_set() {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(b"text").unwrap();
        let stop = Stop::default();
        let open = || StoppableFile::new(file.reopen().unwrap());
        let (mut inside, mut outside, mut text) = (until(&stop, open), open(), [0; 2]);
        assert_eq!(inside.read(&mut text).unwrap(), 2);
        stop.store(true, Ordering::Relaxed);
        assert_eq!(inside.read(&mut text).unwrap_err().to_string(), "stopped");
        assert_eq!(outside.read(&mut text).unwrap(), 2);
    }
}
