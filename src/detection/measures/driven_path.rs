//! The path that a road user drove, as a PET needs it: where each of its carriages was at each time.

use std::borrow::Cow;

use smallvec::SmallVec;

use crate::detection::path::Pose;
use crate::geometry::bow::Bow;
use crate::geometry::movement::TOLERANCE;
use crate::geometry::rectangle::{Rectangle, direction};
use crate::geometry::{Bounds, Point};
use crate::traffic::profile::Carriage;
use crate::util::units::{Metre, Radian, Second};

/// Parts of an arc, at most: 2.6 m deep. A deeper one is none, since the road user was put elsewhere.
const MOST_PARTS: f64 = 16.0;

/// The path that one road user drove: where it was at each time.
#[derive(Clone, Debug, Default)]
pub(crate) struct DrivenPath {
    poses: Vec<TimedPose>,
    carriages: SmallVec<[Carriage; 1]>,
    width: Metre,
    is_over: bool,
}

/// The position of its front bumper at a time, and its heading.
#[derive(Clone, Copy, Debug)]
pub(super) struct TimedPose {
    pub time: Second,
    pub front: Point,
    pub heading: Radian,
}

impl TimedPose {
    fn stands_as(&self, other: &Self) -> bool {
        (self.front, self.heading) == (other.front, other.heading)
    }
}

impl DrivenPath {
    /// An empty path of a road user that does not bend.
    pub fn new(length: Metre, width: Metre) -> Self {
        Self::of_carriages([Carriage { behind: 0.0, length }], width)
    }

    /// An empty path of a road user with these carriages.
    pub(crate) fn of_carriages(carriages: impl IntoIterator<Item = Carriage>, width: Metre) -> Self {
        Self { carriages: carriages.into_iter().collect(), width, ..Self::default() }
    }

    /// Adds the position of its front bumper at a time, and its heading. While it stands, no more is kept than when it
    /// began and ended.
    pub fn push(&mut self, time: Second, front: Point, heading: Radian) {
        let pose = TimedPose { time, front, heading };
        match &mut self.poses[..] {
            [.., before, last] if before.stands_as(last) && last.stands_as(&pose) => last.time = time,
            _ => self.poses.push(pose),
        }
    }

    /// Adds the same of a road user that was seen there, with what lies between on the arc that it drove.
    pub(crate) fn drive_to(&mut self, time: Second, front: Point, heading: Radian) {
        // Steps of a recording that differ in length may overlap by a part of one.
        while self.poses.last().is_some_and(|last| last.time >= time) {
            self.poses.pop();
        }
        if let Some(last) = self.poses.last().copied() {
            let bow = Bow::new([last.front, front], [last.heading, heading]);
            // A straight line through a part of an arc leaves it by the square of its share.
            let parts = (bow.depth() / TOLERANCE).sqrt().ceil().min(MOST_PARTS);
            for part in (1..parts as u32).map(|part| f64::from(part) / parts) {
                let time = last.time + (time - last.time) * part;
                self.push(time, bow.at(part), last.heading + bow.turn * part);
            }
        }
        self.push(time, front, heading);
    }

    /// The same if it goes on along these poses. When it comes to each is left open: a second later for each metre.
    pub(crate) fn going_on(&self, poses: &[Pose]) -> Self {
        let mut path = self.clone();
        let now = self.poses.last().map_or(0.0, |last| last.time);
        for pose in poses.iter().filter(|pose| pose.distance > 0.0) {
            path.push(now + pose.distance, pose.front, pose.axis.y.atan2(pose.axis.x));
        }
        path
    }

    /// Marks that it has left the scene.
    pub fn end(&mut self) {
        self.is_over = true;
    }

    /// Whether it has left the scene.
    pub fn has_ended(&self) -> bool {
        self.is_over
    }

    /// From its front to the rear of its last carriage.
    pub(super) fn length(&self) -> Metre {
        self.carriages.iter().map(|carriage| carriage.behind + carriage.length).fold(0.0, f64::max)
    }

    /// The path of each carriage.
    pub(super) fn courses(&self) -> SmallVec<[Course<'_>; 1]> {
        let of = |carriage: &Carriage| {
            let poses = if carriage.behind > 0.0 { self.trailing(carriage).into() } else { self.poses[..].into() };
            Course { poses, length: carriage.length, width: self.width }
        };
        self.carriages.iter().map(of).collect()
    }

    /// The poses of a carriage whose front and rear go where the front bumper went, and straight on before that is known.
    fn trailing(&self, carriage: &Carriage) -> Vec<TimedPose> {
        let Some(first) = self.poses.first() else { return Vec::new() };
        let mut travelled = 0.0;
        let mut reached_after = vec![travelled];
        reached_after.extend(self.poses.windows(2).map(|pair| {
            travelled += (pair[1].front - pair[0].front).norm();
            travelled
        }));
        let place = |travelled: Metre| {
            let next = reached_after.partition_point(|reached| *reached < travelled);
            if next == 0 {
                return first.front + direction(first.heading) * travelled;
            }
            let part = (travelled - reached_after[next - 1]) / (reached_after[next] - reached_after[next - 1]);
            self.poses[next - 1].front + (self.poses[next].front - self.poses[next - 1].front) * part
        };
        let pose = |(pose, travelled): (&TimedPose, &Metre)| {
            let [front, rear] = [0.0, carriage.length].map(|length| place(travelled - carriage.behind - length));
            TimedPose { time: pose.time, front, heading: (front.y - rear.y).atan2(front.x - rear.x) }
        };
        self.poses.iter().zip(&reached_after).map(pose).collect()
    }
}

/// The path of one carriage.
pub(super) struct Course<'a> {
    pub poses: Cow<'a, [TimedPose]>,
    pub length: Metre,
    pub width: Metre,
}

impl Course<'_> {
    pub fn pose(&self, pose: &TimedPose) -> Pose {
        Pose { distance: 0.0, front: pose.front, axis: direction(pose.heading) }
    }

    pub(crate) fn bounds_at(&self, pose: &Pose) -> Bounds {
        Rectangle::behind(pose.front, pose.axis, self.length, self.width).bounds()
    }
}

/// The box around all that these covered, larger than any rounding error.
pub(super) fn bounds(courses: &[Course]) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    for course in courses {
        course.poses.iter().for_each(|pose| bounds.join(&course.bounds_at(&course.pose(pose))));
    }
    bounds.grown(TOLERANCE)
}
