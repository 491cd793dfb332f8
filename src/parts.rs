//! The same work for several threads: each takes its part of a step.

/// A part with fewer road users than this is not worth waking a thread for: of 5,000 in a jam two threads save a tenth of
/// the step, of 5,000 in platoons two fifths.
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
    rayon::in_place_scope(|scope| {
        let work = &work;
        for (worker, part) in jobs {
            scope.spawn(move |_| work(worker, part));
        }
        work(worker, part);
    });
}
