//! What a run has found: the pairs of the step, the conflicts so far, and the summary at its end.

use std::collections::VecDeque;

use super::Run;
use crate::Result;
use crate::output::net_faults_csv::NetFault;
use crate::output::summary::{Skipped, Summary};
use closecall::detection::encounter::Encounter;
use closecall::events::{Alarm, Conflict, PetSoFar};
use closecall::geometry::Point;
use closecall::traffic::net::Net;
use closecall::traffic::roster::{Roster, UserIndex};
use closecall::util::remark::{Remark, RemarkCode};
use closecall::util::units::MetrePerSecondSquared;

impl Run {
    /// Works out the crash probability of each step of a conflict, because alarms are asked for it.
    pub fn keep_probabilities(&mut self) {
        self.tracker.keep_probabilities();
    }

    /// The pairs that met the log's condition in the last step, or will with the PET of their events.
    pub fn in_conflict(&self) -> impl ExactSizeIterator<Item = &Encounter> {
        self.detector.encounters()
    }

    /// The expected path of a road user's front bumper, from where it is; empty where it is absent in this step.
    pub fn path(&self, user: UserIndex) -> Vec<Point> {
        let row = self.frame.row_of(user);
        row.map_or_else(Vec::new, |row| self.detector.path(&self.frame, &self.roster, row))
    }

    /// How a road user brakes, 0 or more.
    pub fn deceleration(&self, user: UserIndex) -> MetrePerSecondSquared {
        self.detector.deceleration(user)
    }

    /// The faults of the net so far, the worst first, and the number of road users that overlap only as drawn.
    pub(super) fn net_faults(&self) -> (Vec<NetFault>, usize) {
        (self.net().map(|net| self.net_faults.found(net)).unwrap_or_default(), self.net_faults.road_users())
    }

    /// The conflicts that are still open in this step.
    ///
    /// Their crash probabilities are there if [`Run::keep_probabilities`] was called before.
    pub fn alarms(&self) -> impl Iterator<Item = Alarm> {
        self.tracker.alarms()
    }

    /// The conflicts that are over and wait for their PET, as in their last step.
    pub fn waiting(&self) -> impl Iterator<Item = Alarm> {
        self.tracker.waiting()
    }

    /// The PET of an open or waiting conflict, or its lower bound in this step.
    pub fn pet_so_far(&self, alarm: &Alarm) -> Option<PetSoFar> {
        let ahead = |user| {
            let row = self.frame.row_of(user);
            row.map(|row| self.detector.ahead(&self.frame, &self.roster, row)).unwrap_or_default()
        };
        self.tracker.pet_so_far(alarm, ahead)
    }

    /// The number of the first of [`Run::conflicts`], as in the log: closed conflicts before it are no longer in memory.
    pub fn first_number(&self) -> u64 {
        self.closed_conflicts() + 1 - self.conflicts.len() as u64
    }

    /// The closed conflicts that are kept in memory, in the order in which they closed.
    pub fn closed(&self) -> impl Iterator<Item = &Conflict> {
        self.conflicts.iter()
    }

    /// The closed conflicts that are kept in memory, then the open ones as they are now.
    pub fn conflicts(&self) -> Vec<Conflict> {
        self.conflicts.iter().cloned().chain(self.tracker.open(&self.roster)).collect()
    }

    /// The net, if there is one.
    pub fn net(&self) -> Option<&Net> {
        self.net.as_deref()
    }

    /// What was found so far, open conflicts included.
    pub fn summary(&self) -> Summary {
        let mut summary = self.summary.clone();
        for conflict in self.tracker.open(&self.roster) {
            summary.add(&conflict, self.counts_artefacts, &self.roster);
        }
        summary
    }

    /// The number of conflicts that have closed so far.
    pub fn closed_conflicts(&self) -> u64 {
        self.summary.logged()
    }

    /// Closes the open conflicts and writes them; returns the summary.
    ///
    /// # Errors
    /// [`crate::Error::File`] that names what cannot be written; the run is over then too, and counted.
    pub fn finish(&mut self) -> Result<Summary> {
        self.count_exposure(self.step_length.unwrap_or_default());
        let first = self.closed_conflicts() + 1;
        let closed = self.tracker.finish(&self.roster);
        let clips = self.clips.as_mut().map_or_else(Vec::new, |clips| clips.finish(closed, first));
        let written = self.writing.finish(closed, &clips, &self.roster, self.net.as_deref());
        self.net_faults.take(closed, first, self.net.as_deref(), &self.roster);
        count(closed, &self.roster, self.counts_artefacts, &mut self.summary, &mut self.conflicts, self.most_conflicts);
        closed.iter().for_each(|conflict| self.ordinary_driving.count(conflict, &self.roster));
        self.summary.entered = self.net.as_deref().map(|net| self.entering.by_junction(net)).unwrap_or_default();
        self.summary.left_out = self.detector.left_out();
        self.summary.skipped = Skipped::of(&self.detector.work(), self.lane_lookups);
        let unmet = self.type_settings.iter().filter(|(_, name)| !self.roster.has_any_of(name));
        let remarks = unmet.map(|(setting, _)| {
            let text = format!("{setting}: no road user of this type was in the scene");
            Remark::new(RemarkCode::UnusedSetting, text)
        });
        let of_settings = self.ordinary_driving.remarks(&self.roster);
        self.summary.remarks = remarks.chain(self.warm_up.remark()).chain(of_settings).collect();
        written.map(|()| self.summary.clone())
    }
}

/// Counts closed conflicts, and keeps the latest `most` of them.
pub(super) fn count(
    closed: &[Conflict],
    roster: &Roster,
    counts_artefacts: bool,
    summary: &mut Summary,
    kept: &mut VecDeque<Conflict>,
    most: usize,
) {
    for conflict in closed {
        summary.add(conflict, counts_artefacts, roster);
    }
    let new = &closed[closed.len().saturating_sub(most)..];
    kept.drain(..(kept.len() + new.len()).saturating_sub(most).min(kept.len()));
    kept.extend(new.iter().cloned());
}
