//! Work for several threads: the same for each, on its part of a step, or something else beside what the caller does.

use rayon::{ThreadPool, ThreadPoolBuilder};

/// A part with fewer road users than this is not worth waking a thread for: of 5,000 in a jam two threads save a tenth of
/// the step, of 5,000 in platoons two fifths.
const LEAST_SHARE: usize = 2000;

/// The caller's thread and those that help it.
///
/// No more help than have work: who waits for some looks for it again and again at first. One thread too many on two
/// cores made attached runs up to 7 % longer (SUMO's A10).
#[derive(Default)]
pub struct Team {
    helpers: Option<ThreadPool>,
}

impl Team {
    /// So many threads, the caller's among them; that one alone where the system gives no more.
    pub fn new(threads: usize) -> Self {
        let helpers = threads.saturating_sub(1);
        // No helper: for rayon 0 would be as many as there are cores.
        Self { helpers: (helpers > 0).then(|| ThreadPoolBuilder::new().num_threads(helpers).build().ok()).flatten() }
    }

    /// How many threads there are.
    pub fn threads(&self) -> usize {
        1 + self.helpers.as_ref().map_or(0, ThreadPool::current_num_threads)
    }

    /// How many items each thread gets, of so many.
    pub fn share(&self, count: usize) -> usize {
        count.div_ceil(self.threads()).max(LEAST_SHARE)
    }

    /// Each part of the work by a worker of its own; the first is the caller's thread's.
    pub fn each<'a, Worker: Send + 'a, Part: Send>(
        &self,
        workers: impl IntoIterator<Item = &'a mut Worker>,
        parts: impl IntoIterator<Item = Part>,
        work: impl Fn(&mut Worker, Part) + Sync,
    ) {
        let mut jobs = workers.into_iter().zip(parts).peekable();
        let Some((worker, part)) = jobs.next() else { return };
        let Some(helpers) = self.helpers.as_ref().filter(|_| jobs.peek().is_some()) else {
            work(worker, part);
            return jobs.for_each(|(worker, part)| work(worker, part));
        };
        helpers.in_place_scope(|scope| {
            let work = &work;
            for (worker, part) in jobs {
                scope.spawn(move |_| work(worker, part));
            }
            work(worker, part);
        });
    }

    /// Does what the caller's thread has to do while a helper does something else; returns when both are done.
    pub fn beside<T>(&self, helper: impl FnOnce() + Send, own: impl FnOnce() -> T) -> T {
        match &self.helpers {
            Some(helpers) => helpers.in_place_scope(|scope| {
                scope.spawn(|_| helper());
                own()
            }),
            None => {
                helper();
                own()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_as_many_threads_as_asked_for_and_never_none() {
        assert_eq!([0, 1, 2, 5].map(|threads| Team::new(threads).threads()), [1, 1, 2, 5]);
    }

    #[test]
    fn every_part_is_done_once_by_however_many() {
        for threads in [1, 2, 5] {
            let mut done = [0; 9];
            Team::new(threads).each(&mut done, 1..=9, |done, part| *done += part);
            assert_eq!(done, [1, 2, 3, 4, 5, 6, 7, 8, 9], "by {threads}");
        }
    }

    #[test]
    fn both_are_done_when_it_returns() {
        for threads in [1, 2] {
            let mut helped = false;
            let own = Team::new(threads).beside(|| helped = true, || 7);
            assert_eq!((helped, own), (true, 7), "by {threads}");
        }
    }
}
