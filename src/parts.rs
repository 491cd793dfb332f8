//! The same work for several threads: each takes its part of a step.

/// A part with fewer road users than this is not worth waiting for a thread to start: 0.1 ms on a virtual machine whose
/// other core is idle, in which 2,000 of a jam are done.
const WORTH_A_THREAD: usize = 2000;

/// How many items each of the workers gets, of so many.
pub fn share(count: usize, workers: usize) -> usize {
    count.div_ceil(workers.max(1)).max(WORTH_A_THREAD)
}

/// Each part of the work by a worker of its own; the first is this thread's.
pub fn each<'a, Worker: Send + 'a, Part: Send>(
    workers: impl IntoIterator<Item = &'a mut Worker>,
    parts: impl IntoIterator<Item = Part>,
    work: impl Fn(&mut Worker, Part) + Sync,
) {
    let mut jobs = workers.into_iter().zip(parts).peekable();
    let Some((worker, part)) = jobs.next() else { return };
    if jobs.peek().is_none() {
        return work(worker, part);
    }
    std::thread::scope(|scope| {
        for (worker, part) in jobs {
            scope.spawn(|| work(worker, part));
        }
        work(worker, part);
    });
}
