//! Work that is done side by side.

use std::collections::BTreeMap;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use std::sync::{Mutex, PoisonError};
use std::thread::{self, Builder};

use crate::{Error, Result};
use closecall::util::threads::processors;

/// The results of all these tasks, each done once, in a thread of its own as far as the system gives any.
pub fn together<T: Send, F: FnMut() -> T + Send, const N: usize>(tasks: [F; N]) -> [T; N] {
    let tasks = tasks.map(Mutex::new);
    let run = |task: &Mutex<F>| task.lock().unwrap_or_else(PoisonError::into_inner)();
    thread::scope(|scope| {
        let begin = |task| (task, Builder::new().spawn_scoped(scope, move || run(task)));
        tasks.each_ref().map(begin).map(|(task, thread)| match thread {
            Ok(thread) => thread.join().unwrap_or_else(|panic| resume_unwind(panic)),
            Err(_) => run(task),
        })
    })
}

/// Does tasks 0 to `count`, as many at a time as the machine has processors, and hands their results to `take` in their
/// order. What a task reports to its last argument goes to `reported` at once. Ends early with the first error.
///
/// # Errors
/// Those of `take`; [`Error::Value`] where the system gives no thread.
pub fn in_order<T: Send, R: Send>(
    count: usize,
    task: impl Fn(usize, &mut dyn FnMut(R)) -> T + Sync,
    mut take: impl FnMut(usize, T) -> Result<()>,
    mut reported: impl FnMut(R),
) -> Result<()> {
    enum Message<R, T> {
        Report(R),
        Done(usize, T),
    }
    let next = AtomicUsize::new(0);
    thread::scope(|scope| {
        let (sender, messages) = channel();
        let workers = processors().min(count);
        let mut begun = 0;
        for _ in 0..workers {
            let (sender, next, task) = (sender.clone(), &next, &task);
            let work = move || {
                loop {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    if number >= count {
                        break;
                    }
                    // Nobody listens any more after an error.
                    let done = task(number, &mut |report| _ = sender.send(Message::Report(report)));
                    _ = sender.send(Message::Done(number, done));
                }
            };
            begun += usize::from(Builder::new().spawn_scoped(scope, work).is_ok());
        }
        if begun == 0 && count > 0 {
            return Err(Error::Value("the system gives no thread".to_owned()));
        }
        drop(sender);
        let mut early = BTreeMap::new();
        let mut awaited = 0;
        for message in messages {
            match message {
                Message::Report(report) => reported(report),
                Message::Done(number, done) => _ = early.insert(number, done),
            }
            while let Some(done) = early.remove(&awaited) {
                take(awaited, done).inspect_err(|_| next.store(count, Ordering::Relaxed))?;
                awaited += 1;
            }
        }
        Ok(())
    })
}
