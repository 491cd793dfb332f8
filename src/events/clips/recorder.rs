//! Records the clips of a run, step by step.

use super::clip::Clip;
use super::recent::Recent;
use super::take::{Source, Take};
use crate::detection::kind::Severity;
use crate::events::event::Conflict;
use crate::events::tracker::Tracker;
use crate::events::under_way::SevereEvent;
use crate::options::ClipLevel;
use crate::traffic::frame::Frame;
use crate::traffic::net::Net;
use crate::traffic::roster::{Roster, UserIndex};
use crate::traffic::signals::Signals;
use crate::util::units::Second;

/// The most events that are recorded at once: in a jam of severe conflicts each takes up to a megabyte.
const MOST_AT_ONCE: usize = 100;
/// The most clips of a run: ten megabytes of file.
pub const MOST: usize = 1000;

/// Records the clips of a run.
#[derive(Debug)]
pub struct Clips {
    least: Severity,
    recent: Recent,
    takes: Vec<Take>,
    made: usize,
}

/// What a step gives the clips.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    /// The road users.
    pub frame: &'a Frame,
    /// Their ids and types.
    pub roster: &'a Roster,
    /// The net, if there is one.
    pub net: Option<&'a Net>,
    /// What the traffic lights show.
    pub signals: &'a Signals,
    /// The events.
    pub tracker: &'a Tracker,
}

impl Clips {
    /// Records conflicts of at least this severity; none where no clips are wanted.
    pub fn new(level: ClipLevel) -> Option<Self> {
        let least = match level {
            ClipLevel::None => return None,
            ClipLevel::Caution => Severity::Caution,
            ClipLevel::Serious => Severity::Serious,
            ClipLevel::Critical => Severity::Critical,
        };
        Some(Self { least, recent: Recent::default(), takes: Vec::new(), made: 0 })
    }

    /// Takes a step and the conflicts that it has settled, the first with this number in the log; returns the clips that are
    /// whole now.
    pub fn step(&mut self, scene: Scene, closed: &[Conflict], first: u64) -> Vec<Clip> {
        let Scene { frame, roster, net, signals, tracker } = scene;
        let is_kept = self.recent.add(frame, tracker.alarms());
        let Self { least, recent, takes, made } = self;
        let source = Source { recent, roster, net, signals };
        for take in takes.iter_mut().filter(|take| take.is_open) {
            (first..).zip(closed).for_each(|(number, conflict)| take.close(number, conflict, *least));
            take.begin_step();
        }
        for SevereEvent { pair, worst } in tracker.severe(*least) {
            if let Some(take) = takes.iter_mut().find(|take| take.is_open && take.pair == pair) {
                take.add_moments(&worst);
            } else if takes.len() < MOST_AT_ONCE && *made + takes.len() < MOST {
                let mut take = Take::of(pair, frame.time, &worst, &source);
                (first..).zip(closed).for_each(|(number, conflict)| take.close(number, conflict, *least));
                takes.push(take);
            }
        }
        for take in takes.iter_mut() {
            take.is_open &= take.is_under_way;
        }
        if is_kept {
            takes.iter_mut().for_each(|take| take.take(&source));
        }
        let whole = takes.extract_if(.., |take| take.is_done(frame.time));
        let clips = whole.flat_map(|take| take.clips().collect::<Vec<_>>()).collect::<Vec<_>>();
        self.made += clips.len();
        clips
    }

    /// Notes that a road user has left.
    pub fn forget(&mut self, user: UserIndex, time: Second, roster: &Roster) {
        self.recent.forget(user, time, roster);
    }

    /// The run is over: returns the clips that are left, with the last conflicts.
    pub fn finish(&mut self, closed: &[Conflict], first: u64) -> Vec<Clip> {
        for take in self.takes.iter_mut().filter(|take| take.is_open) {
            (first..).zip(closed).for_each(|(number, conflict)| take.close(number, conflict, self.least));
        }
        self.takes.drain(..).flat_map(|take| take.clips().collect::<Vec<_>>()).collect()
    }
}
