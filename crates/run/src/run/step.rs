//! One step of a run, in the order of the flow: paths, placements, broad phase, narrow phase, events, log.

use super::Run;
use super::results::count;
use crate::{Error, Result};
use closecall::detection::encounter::{Encounter, Nearness};
use closecall::detection::measures::table::LoggedMeasure;
use closecall::events::{Scene, Surroundings};
use closecall::geometry::Point;

/// The parts of a step that follow once every road user is placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepPart {
    /// Finds the pairs that may meet.
    BroadPhase,
    /// Tests these pairs.
    NarrowPhase,
    /// Opens and closes conflicts.
    Events,
    /// Writes the log and the other files.
    Log,
}

impl Run {
    /// Checks the frame: updates the paths, asks for placements, then runs both phases, the events and the log.
    ///
    /// `place` sets the placement ([`Run::set_placement`]) of the rows that it is given. A row may stay without one.
    ///
    /// # Errors
    /// Those of `place` and of [`Run::finish_step`].
    pub fn step<E: From<Error>>(
        &mut self,
        place: impl FnOnce(&mut Self, &[u32]) -> std::result::Result<(), E>,
    ) -> std::result::Result<(), E> {
        self.update_paths(place)?;
        Ok(self.finish_step(|_| ())?)
    }

    /// The first half of [`Run::step`]: what needs the source of the road users.
    ///
    /// # Errors
    /// Those of `place`.
    pub fn update_paths<E>(
        &mut self,
        place: impl FnOnce(&mut Self, &[u32]) -> std::result::Result<(), E>,
    ) -> std::result::Result<(), E> {
        let mut rows = std::mem::take(&mut self.unplaced);
        rows.clear();
        rows.extend_from_slice(self.track_paths());
        self.lane_lookups += rows.len() as u64;
        let placed = place(self, &rows);
        self.unplaced = rows;
        placed
    }

    /// The second half of [`Run::step`]: both phases, the events and the log. `on_part_end` is called after each part.
    ///
    /// # Errors
    /// [`Error::Step`] if a road user's state is impossible, or too many are in one place; [`Error::File`] that names an output
    /// that cannot be written, once: the steps after that one are checked, and nothing more is written.
    pub fn finish_step(&mut self, mut on_part_end: impl FnMut(StepPart)) -> Result<()> {
        if let Some((user, why)) = self.frame.impossible() {
            return Err(Error::step(self.frame.time, format!("\"{}\": {why}", self.roster.id(*user))));
        }
        self.count_entering();
        // With the positions that SUMO has, before road users are moved back.
        let recorded = self.writing.trajectories(&self.frame, &self.roster, self.net.as_deref());
        self.detector.align(&mut self.frame, &self.roster);
        self.warm_up.count_present(&mut self.summary.exposure);
        self.broad_phase();
        self.check_crowd()?;
        on_part_end(StepPart::BroadPhase);
        self.narrow_phase();
        self.check_crowd()?;
        on_part_end(StepPart::NarrowPhase);
        self.close_conflicts();
        on_part_end(StepPart::Events);
        let written = self.write();
        on_part_end(StepPart::Log);
        recorded.and(written)
    }

    /// Follows every road user along its predicted path; returns the rows that need a placement.
    fn track_paths(&mut self) -> &[u32] {
        self.detector.track_paths(&self.frame, &self.roster)
    }

    /// Finds the pairs that may meet.
    fn broad_phase(&mut self) {
        self.detector.broad_phase(&self.frame, &self.roster);
    }

    /// Ends the run where a step has more pairs than memory should hold.
    fn check_crowd(&self) -> Result<()> {
        let crowd = self.detector.crowd(&self.frame, &self.roster);
        crowd.map_or(Ok(()), |crowd| Err(Error::step(self.frame.time, crowd)))
    }

    /// Tests these pairs and keeps those that may be logged, on the filter's lanes if there is a filter.
    fn narrow_phase(&mut self) {
        let Self { detector, net, filter, warm_up, .. } = self;
        _ = detector.narrow_phase(&self.frame, &self.roster);
        detector.retain(|found| {
            let is_wanted = warm_up.is_over() && found.may_be_logged();
            if let (true, None, Some(net)) = (is_wanted, found.lane, &net) {
                found.lane = net.lane_at(Point::new(found.x, found.y));
            }
            is_wanted && filter.as_ref().is_none_or(|filter| filter.holds(found.lane))
        });
        detector.drop_pairs_with_one_between(&self.frame, &self.roster);
    }

    /// Updates the events and closes those that are over.
    fn close_conflicts(&mut self) {
        let (detector, frame, roster) = (&self.detector, &self.frame, &self.roster);
        let path = |row| detector.path(frame, roster, row);
        let course = |row, distance| {
            let user = frame.user(row);
            let edge = self.edges.iter().find(|(known, _)| *known == user).map(|(_, edge)| *edge);
            detector.course(frame, roster, row, distance).on_edge(self.net.as_deref(), edge, frame.state(row).front())
        };
        let chosen = |found: &Encounter| detector.chosen(frame, roster, found);
        let tadv = |found: &Encounter| detector.tadv(frame, roster, found);
        let crash_probability =
            |near: &Nearness, measure: LoggedMeasure| detector.crash_probability(roster, near, measure);
        let net = self.net.as_deref();
        let (signals, stopped, step) = (&self.signals, &self.stopped, self.step_length.unwrap_or_default());
        let around = Surroundings {
            net,
            is_tracked: self.is_tracked,
            step,
            signals,
            stopped,
            path: &path,
            course: &course,
            chosen: &chosen,
            crash_probability: &crash_probability,
            tadv: &tadv,
        };
        let closed = self.tracker.step(frame, roster, detector.encounters(), around, self.collided.as_deref());
        self.net_faults.take(closed, self.summary.logged() + 1, net, roster);
        count(closed, roster, self.counts_artefacts, &mut self.summary, &mut self.conflicts, self.most_conflicts);
        closed.iter().for_each(|conflict| self.ordinary_driving.count(conflict, roster));
    }

    /// Writes the log and the other files, and ends the step.
    ///
    /// # Errors
    /// [`Error::File`] that names what cannot be written.
    fn write(&mut self) -> Result<()> {
        let (roster, net, closed) = (&self.roster, self.net.as_deref(), self.tracker.closed());
        let clips = match &mut self.clips {
            Some(clips) => {
                let first = self.summary.logged() + 1 - closed.len() as u64;
                let (frame, signals, tracker) = (&self.frame, &self.signals, &self.tracker);
                clips.step(Scene { frame, roster, net, signals, tracker }, closed, first)
            }
            None => Vec::new(),
        };
        let written = self.writing.conflicts(closed, &clips, roster, net);
        self.tracker.forget_closed();
        // The indices become free only now: this step's events had to see that the road users are gone.
        for user in self.leaving.drain(..) {
            if let Some(clips) = &mut self.clips {
                clips.forget(user, self.frame.time, &self.roster);
            }
            self.roster.leave(user);
            self.entering.forget(user);
            self.detector.forget(user);
            self.tracker.forget(user);
            self.writing.outputs.forget(user);
        }
        written
    }
}
