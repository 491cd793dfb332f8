//! Jobs in parallel, each on a thread, until all are done or the user stops them.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread::Builder;
use std::time::Duration;

use crate::Result;
use closecall_run::Error;

/// The interval at which jobs, and the user's interrupt, are polled.
pub(super) const ASKED_EVERY: Duration = Duration::from_millis(5);

/// How jobs are done.
pub struct Pool<'a> {
    /// The number of jobs at the same time.
    pub workers: usize,
    /// Whether the user wants to stop; called repeatedly.
    pub interrupted: &'a mut dyn FnMut() -> bool,
    /// Told repeatedly how many jobs of how many have ended.
    pub progress: &'a mut dyn FnMut(u64, u64),
}

impl Pool<'_> {
    /// Does every job and returns what each gave, in the order of the jobs. A job should end soon once its flag is set.
    ///
    /// # Errors
    /// [`Error::Stopped`] where the user stopped them, [`Error::Value`] where the system gives no thread.
    pub fn run<J: Sync, R: Send>(&mut self, jobs: &[J], one: impl Fn(&J, &AtomicBool) -> R + Sync) -> Result<Vec<R>> {
        let next = AtomicUsize::new(0);
        let stop = AtomicBool::new(false);
        let ends = Mutex::new(jobs.iter().map(|_| None).collect::<Vec<Option<R>>>());
        let work = || {
            while !stop.load(Ordering::Relaxed) {
                let number = next.fetch_add(1, Ordering::Relaxed);
                let Some(job) = jobs.get(number) else { return };
                let end = one(job, &stop);
                ends.lock().unwrap_or_else(PoisonError::into_inner)[number] = Some(end);
            }
        };
        std::thread::scope(|scope| {
            let count = self.workers.clamp(1, jobs.len().max(1));
            let begin = |_| Builder::new().spawn_scoped(scope, work).ok();
            let workers = (0..count).filter_map(begin).collect::<Vec<_>>();
            if workers.is_empty() {
                return Err(Error::Value("the system gives no thread".to_owned()));
            }
            while workers.iter().any(|worker| !worker.is_finished()) {
                if (self.interrupted)() {
                    stop.store(true, Ordering::Relaxed);
                }
                let done = ends.lock().unwrap_or_else(PoisonError::into_inner).iter().flatten().count();
                (self.progress)(done as u64, jobs.len() as u64);
                std::thread::sleep(ASKED_EVERY);
            }
            Ok(())
        })?;
        // Ctrl-C in a terminal also ends the jobs' processes, so the last worker may be done before the interrupt is polled.
        if stop.into_inner() || (self.interrupted)() {
            return Err(Error::Stopped.into());
        }
        // Without a stop, every job has ended.
        Ok(ends.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().flatten().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_the_order_of_the_jobs() {
        let jobs = [30, 0, 10, 20];
        for workers in [1, 2, 9] {
            let mut pool = Pool { workers, interrupted: &mut || false, progress: &mut |_, _| () };
            let done = pool.run(&jobs, |job, _| {
                std::thread::sleep(Duration::from_millis(*job));
                job + 1
            });
            assert_eq!(done.unwrap(), [31, 1, 11, 21]);
        }
    }

    #[test]
    fn an_interrupt_stops_jobs_and_begins_none() {
        let begun = AtomicUsize::new(0);
        let interrupted = &mut || begun.load(Ordering::Relaxed) > 0;
        let outcome = Pool { workers: 1, interrupted, progress: &mut |_, _| () }.run(&[1, 2, 3], |_, stop| {
            begun.fetch_add(1, Ordering::Relaxed);
            while !stop.load(Ordering::Relaxed) {
                std::thread::yield_now();
            }
        });
        assert!(outcome.is_err());
        assert_eq!(begun.into_inner(), 1);
    }
}
