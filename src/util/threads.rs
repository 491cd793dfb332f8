//! Threads: a team that shares the work of a step, and a helper that works beside the caller.

use std::panic::resume_unwind;
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::sync::{Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use rayon::{ThreadPool, ThreadPoolBuilder};

/// Road users per thread that are worth waking one for. Two threads save nothing of a step with 5,000 road users in a
/// jam, a quarter in platoons, and two fifths where they are spread uniformly.
const LEAST_SHARE: usize = 2500;

/// Work per thread, in time, that is worth waking one for: that alone takes up to 70 µs on a virtual machine.
const LEAST_TIME: Duration = Duration::from_micros(200);

/// Chunks per thread; a thread that wakes late or runs slower takes fewer.
const PARTS: usize = 8;

/// How long a helper polls for work before it sleeps. Waking it costs the caller up to 70 µs on a virtual machine, as
/// much as both phases for 50 road users; in a step that takes SUMO longer than this, that is little.
const AWAKE: Duration = Duration::from_millis(1);

/// The most items that are kept from a helper that cost time: then it is tried again, at up to 4 ms where another program has
/// its processor, a hundredth of what as many steps of 0.4 ms take.
const LONGEST_PAUSE: u32 = 1023;

/// The caller's thread and those that help it.
///
/// Only as many threads help as have work, because a waiting thread polls at first. One thread too many on two cores
/// made attached runs up to 7 % longer (SUMO's A10).
#[derive(Default)]
pub struct Team {
    helpers: Option<ThreadPool>,
}

impl Team {
    /// A team of `threads`, the caller's included; only the caller's where the system refuses more.
    pub fn new(threads: usize) -> Self {
        let helpers = threads.saturating_sub(1);
        // rayon takes 0 threads as one per core.
        Self { helpers: (helpers > 0).then(|| ThreadPoolBuilder::new().num_threads(helpers).build().ok()).flatten() }
    }

    /// The number of threads.
    pub fn threads(&self) -> usize {
        1 + self.helpers.as_ref().map_or(0, ThreadPool::current_num_threads)
    }

    /// The number of threads worth using for `count` road users.
    pub fn busy(&self, count: usize) -> usize {
        (count / LEAST_SHARE).clamp(1, self.threads())
    }

    /// The number of threads worth using for what would take one of them this long.
    pub(crate) fn busy_for(&self, alone: Duration) -> usize {
        (alone.as_nanos() / LEAST_TIME.as_nanos()).clamp(1, self.threads() as u128) as usize
    }

    /// Does each part of the work once, by the next free worker; the first worker runs on the caller's thread. That takes
    /// parts from the front, and all others from the back: two workers then get mostly the same parts in every step.
    pub fn each<Worker: Send, Part: Send>(
        &self,
        workers: impl IntoIterator<Item = Worker>,
        parts: impl DoubleEndedIterator<Item = Part> + Send,
        work: impl Fn(&mut Worker, Part) + Sync,
    ) {
        let mut workers = workers.into_iter().peekable();
        let Some(mut own) = workers.next() else { return };
        let Some(helpers) = self.helpers.as_ref().filter(|_| workers.peek().is_some()) else {
            return parts.for_each(|part| work(&mut own, part));
        };
        let parts = Mutex::new(parts);
        let from_front = || parts.lock().unwrap_or_else(PoisonError::into_inner).next();
        let from_back = || parts.lock().unwrap_or_else(PoisonError::into_inner).next_back();
        helpers.in_place_scope(|scope| {
            let (work, from_back) = (&work, &from_back);
            for mut worker in workers {
                scope.spawn(move |_| {
                    while let Some(part) = from_back() {
                        work(&mut worker, part);
                    }
                });
            }
            while let Some(part) = from_front() {
                work(&mut own, part);
            }
        });
    }
}

/// The items in a part of the work, for `count` items and `busy` threads; at least one.
pub fn share(busy: usize, count: usize) -> usize {
    count.div_ceil(if busy > 1 { busy * PARTS } else { 1 }).max(1)
}

/// A thread that does the same work on each item it is given, while the caller does something else.
///
/// It polls for a millisecond for the next item before it sleeps.
pub struct Helper<Item, Done> {
    give: SyncSender<Item>,
    /// With the time that the work took.
    take_back: Receiver<(Item, Done, Duration)>,
    /// None when it has panicked.
    thread: Option<JoinHandle<()>>,
    gain: Gain,
}

/// Whether a helper saves time: not where its processor is busy with something else.
#[derive(Default)]
struct Gain {
    /// How many items the caller does itself after the next one that takes longer with the helper.
    pause: u32,
    /// How many of them are left.
    left: u32,
}

impl Gain {
    /// Whether the next item is one for the helper.
    fn is_expected(&mut self) -> bool {
        let is_expected = self.left == 0;
        self.left = self.left.saturating_sub(1);
        is_expected
    }

    /// Takes how long the caller waited for work that took the helper this long.
    fn take(&mut self, waited: Duration, work: Duration) {
        if waited > work {
            self.pause = (2 * self.pause + 1).min(LONGEST_PAUSE);
            self.left = self.pause;
        } else {
            self.pause /= 2;
        }
    }
}

impl<Item: Send + 'static, Done: Send + 'static> Helper<Item, Done> {
    /// A thread for this work; none where the system refuses one.
    pub fn new(work: impl Fn(&mut Item) -> Done + Send + 'static) -> Option<Self> {
        let (give, given) = sync_channel(1);
        let (give_back, take_back) = sync_channel(1);
        let all = move || {
            while let Some(mut item) = wait_for(&given) {
                let started = Instant::now();
                let done = work(&mut item);
                if give_back.send((item, done, started.elapsed())).is_err() {
                    break;
                }
            }
        };
        let thread = Some(thread::Builder::new().spawn(all).ok()?);
        Some(Self { give, take_back, thread, gain: Gain::default() })
    }

    /// Whether the helper will probably save time with the next item, by the last ones. Ask once for each item.
    pub fn is_worthwhile(&mut self) -> bool {
        self.gain.is_expected()
    }

    /// Has the helper work on an item while the caller's thread runs `own`; returns when both are done.
    pub fn beside<T>(&mut self, item: Item, own: impl FnOnce() -> T) -> (Item, Done, T) {
        let given = self.give.send(item);
        let own = own();
        let since = Instant::now();
        match given.ok().and_then(|()| wait_for(&self.take_back)) {
            Some((item, done, work)) => {
                self.gain.take(since.elapsed(), work);
                (item, done, own)
            }
            // The helper has panicked: pass the panic on.
            None => {
                let said = self.thread.take().and_then(|thread| thread.join().err());
                resume_unwind(said.unwrap_or_else(|| Box::new("the helper has gone")))
            }
        }
    }
}

/// The next item; none where the other side has gone.
fn wait_for<T>(from: &Receiver<T>) -> Option<T> {
    let started = Instant::now();
    loop {
        match from.try_recv() {
            Ok(item) => return Some(item),
            Err(TryRecvError::Disconnected) => return None,
            Err(TryRecvError::Empty) if started.elapsed() > AWAKE => return from.recv().ok(),
            // Let other threads run first.
            Err(TryRecvError::Empty) => thread::yield_now(),
        }
    }
}

/// The number of processors this process may use; 1 where that is unknown.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// The threads of a command that is not told how many: one per processor, up to the 64 that the option allows.
pub fn default_threads() -> u8 {
    processors().min(64) as u8
}

#[cfg(test)]
mod tests {
    use crate::util::threads::*;

    #[test]
    fn the_number_of_threads_is_as_asked_at_least_one() {
        assert_eq!([0, 1, 2, 5].map(|threads| Team::new(threads).threads()), [1, 1, 2, 5]);
    }

    #[test]
    fn every_part_is_done_once_by_any_number_of_workers() {
        for threads in [1, 2, 5] {
            for workers in 1..=threads {
                let (mut sums, mut done) = (vec![0; workers], [0; 99]);
                let add_up = |sum: &mut &mut usize, (number, done): (usize, &mut usize)| {
                    **sum += number;
                    *done += 1;
                };
                Team::new(threads).each(&mut sums, done.iter_mut().enumerate(), add_up);
                let sum = sums.iter().sum::<usize>();
                assert_eq!((done, sum), ([1; 99], 99 * 49), "by {workers} of {threads}");
            }
        }
    }

    #[test]
    fn a_helper_works_while_the_caller_does() {
        const LONG: Duration = Duration::from_secs(60);
        let [(say, heard), (answer, answered)] = [(); 2].map(|()| sync_channel(1));
        let work = move |item: &mut u32| {
            say.send(*item).unwrap();
            *item += 1;
            answered.recv_timeout(LONG).unwrap()
        };
        let mut helper = Helper::new(work).unwrap();
        for round in 0..3 {
            let own = || {
                answer.send(10 * round).unwrap();
                heard.recv_timeout(LONG).unwrap()
            };
            assert_eq!(helper.beside(round, own), (round + 1, 10 * round, round));
            // The next round finds it asleep.
            thread::sleep(2 * AWAKE);
        }
    }

    #[test]
    fn a_helper_that_costs_time_pauses_ever_longer() {
        let mut gain = Gain::default();
        let mut pauses = |waited: u64| {
            gain.take(Duration::from_micros(waited), Duration::from_micros(100));
            std::iter::from_fn(|| (!gain.is_expected()).then_some(())).count()
        };
        assert_eq!([50, 500, 500, 500, 50, 50, 500].map(&mut pauses), [0, 1, 3, 7, 0, 0, 3]);
        assert_eq!((0..20).map(|_| pauses(500)).max(), Some(LONGEST_PAUSE as usize));
    }

    #[test]
    #[should_panic(expected = "what the helper says")]
    fn a_helper_that_panics_makes_its_caller_panic() {
        let mut helper = Helper::new(|fails: &mut bool| assert!(!*fails, "what the helper says")).unwrap();
        assert_eq!(helper.beside(false, || 7), (false, (), 7));
        helper.beside(true, || 7);
    }
}
