//! What is set before a run's first step, and what can be asked then.

use super::Run;
use crate::output::formats::Outputs;
use crate::output::log::Log;
use crate::util::decimal::Written;
use closecall::detection::detector::shortcuts::Shortcuts;
use closecall::events::Clips;
use closecall::options::ClipLevel;
use closecall::options::measures::Measures;
use closecall::util::remark::{Remark, RemarkCode};
use closecall::util::units::Second;

/// Steps longer than this are worth a remark, in s: on our nets the rate of conflicts at 0.2 s is off by 2 to 24 %, at 0.1 s
/// by 0 to 10 % (docs/step_length.md). The fourth digit is room for rounding in the times of recordings.
const LONG_STEP: Second = 0.1001;

impl Run {
    /// What the user should know before the run: how the net is drawn, and whether steps of this length are too long.
    pub fn opening_remarks(&self, step_length: Option<Second>) -> Vec<Remark> {
        let of_net = || {
            self.net
                .as_deref()
                .map(|net| net.remarks(self.detector.overlaps(), self.contact_tolerance))
                .unwrap_or_default()
        };
        let net = self.net_remarks.get_or_init(of_net).iter().cloned();
        let steps = step_length.filter(|length| *length > LONG_STEP).map(|length| {
            let text = format!(
                "steps of {} s are long: what happens within a step is not seen, so that counts and TTC depend on the \
                 step length; 0.1 s is better (SUMO's --step-length), and closecall study SCENARIO measures by how much",
                Written(length)
            );
            Remark::new(RemarkCode::LongSteps, text)
        });
        net.chain(steps).collect()
    }

    /// Writes the conflicts to a log too, with clips from this severity on.
    pub fn set_log(&mut self, log: Log, clips: ClipLevel) {
        self.writing.log = Some(log);
        self.clips = Clips::new(clips);
    }

    /// Counts closed conflicts, but does not keep them in memory for [`Run::conflicts`].
    pub fn drop_closed_conflicts(&mut self) {
        self.keep_closed_conflicts(0);
    }

    /// Keeps at most this many closed conflicts in memory for [`Run::conflicts`], the latest.
    pub fn keep_closed_conflicts(&mut self, most: usize) {
        self.most_conflicts = most;
    }

    /// Forgets the closed conflicts but for the latest.
    pub fn forget_closed_conflicts(&mut self, all_but: usize) {
        self.conflicts.drain(..self.conflicts.len().saturating_sub(all_but));
    }

    /// Why the log and the other files are no longer written, if that is so.
    pub fn log_error(&self) -> Option<&str> {
        self.writing.error.as_deref()
    }

    /// Writes other files besides the log.
    pub(super) fn set_outputs(&mut self, outputs: Outputs) {
        if outputs.want_lanes() {
            self.detector.keep_asking_for_lanes();
        }
        self.writing.outputs = outputs;
    }

    /// States how long a step lasts; by default as long as the time between the first two.
    pub(crate) fn set_step_length(&mut self, length: Second) {
        self.step_length = Some(length);
    }

    /// How long a step lasts, if it is known.
    pub fn step_length(&self) -> Option<Second> {
        self.step_length
    }

    /// The shortcuts that the run takes.
    pub fn shortcuts(&self) -> Shortcuts {
        self.detector.shortcuts()
    }

    /// Checks each step with this many threads, at least one. The number does not change the results.
    pub fn set_threads(&mut self, threads: usize) {
        self.detector.set_threads(threads);
    }

    /// States whether every road user keeps its route while it is in the scene; by default routes may change.
    pub fn set_fixed_routes(&mut self, fixed: bool) {
        self.detector.set_fixed_routes(fixed);
    }

    /// States whether road users move sideways without changing lanes (SUMO's sublane model).
    pub fn set_sublane(&mut self, sublane: bool) {
        self.detector.set_sublane(sublane);
    }

    /// Whether road users move sideways without changing lanes.
    pub fn sublane(&self) -> bool {
        self.detector.sublane()
    }

    /// The measures that are computed besides those that every run has.
    pub fn measures(&self) -> Measures {
        self.detector.measures()
    }

    /// Whether no road user's route changes while it is in the scene.
    pub fn has_fixed_routes(&self) -> bool {
        self.detector.has_fixed_routes()
    }

    /// States over which share of a step, up to its end, a road user's speed is the mean: 1 for SUMO's Euler update, 0 for its
    /// ballistic one and for measured speeds.
    pub fn set_averaged_over(&mut self, share: f64) {
        self.detector.set_averaged_over(share);
    }

    /// Whether road users are moved back by half a step, to the moment to which their speeds belong.
    pub fn aligns(&self) -> bool {
        self.detector.aligns()
    }
}
