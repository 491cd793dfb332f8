//! How a second road user passes the corridor of an earlier one: it crosses it, or goes on in it.
//!
//! It crosses from when it comes into the corridor through the side until it is clear of it. Where the two go on together
//! before that, on one path, it has crossed until then. What makes them go on together is the path, not an angle: the
//! middle of the one within the width of the other, until they drive in parallel. A road user that enters the corridor from
//! behind, where the other drove or stood when the record began, goes on in it from there. It cannot cross before it has been
//! clear of it.

use super::corridor::{Corridor, Step};
use super::driven_path::Course;
use crate::detection::path::Pose;
use crate::geometry::bisection::Bisection;
use crate::geometry::separating_axes::Contact;
use crate::geometry::{Point, Vector, angle_between, cross};
use crate::util::units::{Metre, Radian, Second};

/// Two on one path whose headings differ by less than this drive in parallel, in rad: 5°, more than lanes and tracks sway.
const PARALLEL: Radian = 0.0873;
/// The distance between two looks at where the second is beside the first's path, in m: a fraction of a width.
const OFTEN: Metre = 0.5;
/// … and at most this often in a step: that of 100 m. A longer step is a jump.
const MOST_OFTEN: f64 = 200.0;
/// How often the distance between two looks is halved to find where it joins that path: to 2 cm.
const HALVES: u32 = 5;

/// A crossing of the first's corridor.
pub(super) struct Passage {
    /// When the second enters the conflict area, the place that both covered.
    pub enters: Second,
    /// When the first leaves it.
    pub leaves: Second,
    /// Whether nothing that follows changes this.
    pub is_final: bool,
}

impl Passage {
    /// That of two carriages of one road user.
    pub fn joined(self, other: Self) -> Self {
        Self {
            enters: self.enters.min(other.enters),
            leaves: self.leaves.max(other.leaves),
            is_final: self.is_final && other.is_final,
        }
    }
}

/// The path of the front of the first, with the place that it covered when its record began.
pub(super) struct Track<'a> {
    course: &'a Course<'a>,
    /// Of the first, its trailers included.
    length: Metre,
    /// On one path if nearer than this to it.
    near: Metre,
    /// Paths that meet at a smaller angle do not cross where they do not part again.
    crossing: Radian,
}

/// Where a pose is beside a track.
struct Beside {
    /// Distance from the nearest place of the track, positive to the left.
    aside: Metre,
    /// Between the headings of the two there.
    angle: Radian,
    /// Whether it is on one path with it there.
    is_on: bool,
}

/// A crossing under way.
struct Crossing {
    enters: Second,
    /// Where it came from: positive from the left.
    side: Metre,
    /// The largest angle so far.
    widest: Radian,
    /// Since when it has been on one path with the first.
    on_since: Option<Second>,
}

enum State {
    /// Clear of the corridor.
    Clear,
    /// On one path with the first, or no more known than that it is in the corridor.
    Within,
    Crosses(Crossing),
}

impl<'a> Track<'a> {
    /// That of a first of this length, given the course of its first carriage, for a second of this width.
    pub fn of(course: &'a Course<'a>, length: Metre, width: Metre, crossing: Radian) -> Self {
        Self { course, length, near: course.width.max(width) / 2.0, crossing }
    }

    /// When the record of the first ends.
    pub fn ends(&self) -> Second {
        self.course.poses.last().map_or(Second::NEG_INFINITY, |last| last.time)
    }

    /// When a step comes onto one path with the first, between a part where it is not and one where it is.
    fn joined_at(&self, step: &Step, [mut off, mut on]: [f64; 2]) -> f64 {
        for _ in 0..HALVES {
            let middle = (off + on) / 2.0;
            let side = if self.beside(&step.pose(middle), step.to).is_on { &mut on } else { &mut off };
            *side = middle;
        }
        on
    }

    /// Where a pose is beside the part of the track driven before a time.
    fn beside(&self, pose: &Pose, before: Second) -> Beside {
        let poses = &self.course.poses;
        let mut nearest = (f64::INFINITY, Beside { aside: f64::INFINITY, angle: 0.0, is_on: false });
        let mut look = |[from, to]: [Point; 2], axes: [Vector; 2], widest: Radian| {
            let (displacement, past) = (to - from, pose.front - from);
            let part = (past.dot(&displacement) / displacement.norm_squared().max(1e-12)).clamp(0.0, 1.0);
            let off = past - displacement * part;
            let distance = off.norm();
            if distance < nearest.0 {
                let axis = axes[0] * (1.0 - part) + axes[1] * part;
                let angle = angle_between(&axis, &pose.axis);
                let is_on = distance < self.near && angle < widest;
                nearest = (distance, Beside { aside: distance.copysign(cross(&axis, &off)), angle, is_on });
            }
        };
        if let Some(first) = poses.first().map(|first| self.course.pose(first)) {
            // In a narrow bend the follower's heading there differs by as much as the first's turned over its length.
            look([first.front - first.axis * self.length, first.front], [first.axis; 2], 2.0 * self.crossing);
        }
        for pair in poses.windows(2).take_while(|pair| pair[0].time < before) {
            let [from, to] = [&pair[0], &pair[1]].map(|pose| self.course.pose(pose));
            look([from.front, to.front], [from.axis, to.axis], self.crossing);
        }
        nearest.1
    }
}

/// The first crossing of a first's corridor by one carriage of a second, given in steps.
pub(super) fn crossing(steps: &[Step], first: &Corridor, track: &Track, halves: &mut Bisection) -> Option<Passage> {
    let mut state = State::Clear;
    let mut last: Option<&Step> = None;
    for (number, step) in steps.iter().enumerate() {
        let before = last.replace(step).filter(|last| last.to == step.from);
        let enters = first.touched_by(step, Contact::Entry, halves);
        if let (State::Crosses(under_way), true) = (&state, before.is_none() || enters.is_none()) {
            // The contact ended with the step before.
            let end = &steps[number - 1];
            if let Some(found) = cleared(under_way, (end, 1.0), (steps, first, track), halves) {
                return Some(found);
            }
        }
        let Some(enters) = enters else {
            state = State::Clear;
            continue;
        };
        if before.is_none() {
            // Where it was before is not known.
            state = if enters > 0.0 { State::Clear } else { State::Within };
        }
        let exit = first.touched_by(step, Contact::Exit, halves).unwrap_or(1.0);
        if let State::Clear = state {
            let pose = step.pose(enters);
            let beside = track.beside(&pose, step.to);
            state = if beside.is_on {
                State::Within
            } else {
                let (enters, side) = (step.time(enters), beside.aside);
                State::Crosses(Crossing { enters, side, widest: beside.angle, on_since: None })
            };
        }
        if let State::Crosses(under_way) = &mut state
            && let Some(since) = under_way.joins(step, exit, track)
        {
            if under_way.widest >= track.crossing {
                return Some(under_way.passage(since, true, (steps, first), halves));
            }
            state = State::Within;
        }
        if exit < 1.0 {
            if let State::Crosses(under_way) = &state
                && let Some(found) = cleared(under_way, (step, exit), (steps, first, track), halves)
            {
                return Some(found);
            }
            state = State::Clear;
        }
    }
    match state {
        State::Crosses(under_way) if under_way.widest >= track.crossing => {
            Some(under_way.passage(Second::INFINITY, false, (steps, first), halves))
        }
        _ => None,
    }
}

/// The crossing of a road user that is clear of the corridor again, at a part of a step; none unless it came at an angle, or
/// left on the other side.
fn cleared(
    under_way: &Crossing,
    (step, part): (&Step, f64),
    (steps, first, track): (&[Step], &Corridor, &Track),
    halves: &mut Bisection,
) -> Option<Passage> {
    let aside = track.beside(&step.pose(part), step.to).aside;
    let has_crossed = under_way.widest >= track.crossing || aside * under_way.side < 0.0;
    has_crossed.then(|| under_way.passage(step.time(part), true, (steps, first), halves))
}

impl Crossing {
    /// Since when it has gone on with the first, if it does by this part of a step.
    fn joins(&mut self, step: &Step, until: f64, track: &Track) -> Option<Second> {
        let parts = (step.travelled() / OFTEN).ceil().clamp(1.0, MOST_OFTEN);
        let begin = step.part_at(self.enters);
        let mut off = begin;
        for part in (1..=parts as u32).map(|part| begin + (until - begin) * (f64::from(part) / parts)) {
            let beside = track.beside(&step.pose(part), step.to);
            self.widest = self.widest.max(beside.angle);
            if !beside.is_on {
                self.on_since = None;
                off = part;
                continue;
            }
            let since = *self.on_since.get_or_insert_with(|| step.time(track.joined_at(step, [off, part])));
            if beside.angle < PARALLEL {
                return Some(since);
            }
        }
        None
    }

    /// What it is by this time.
    fn passage(
        &self,
        until: Second,
        is_final: bool,
        (steps, first): (&[Step], &Corridor),
        halves: &mut Bisection,
    ) -> Passage {
        let crossed = steps.iter().filter(|step| step.to >= self.enters && step.from <= until);
        let area = crossed.map(|step| step.between(self.enters, until, halves)).collect::<Vec<_>>();
        Passage { enters: self.enters, leaves: first.leaves(&area, self.enters, halves), is_final }
    }
}
