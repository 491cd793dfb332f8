//! What is known of a pair in a step: where both come from and go to, and where their ways meet.

use crate::detection::course::Course;
use crate::detection::encounter::{Encounter, Nearness};
use crate::detection::kind::Kind;
use crate::detection::measures::table::LoggedMeasure;
use crate::events::past::Past;
use crate::geometry::Point;
use crate::geometry::polylines::Vertex;
use crate::options::measures::ChosenValues;
use crate::traffic::frame::Frame;
use crate::traffic::net::{EdgeFunction, EdgeIndex, LaneIndex, Net, Passage};
use crate::traffic::profile::Category;
use crate::traffic::roster::{Roster, UserIndex};
use crate::traffic::signals::Signals;
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Probability, Radian, Second};

/// A vehicle's front bumper may be this far before a crossing when it touches a person there, in m.
pub(super) const BESIDE_A_CROSSING: Metre = 1.0;

/// Up to this distance from the end of a crossing a person may still be at the kerb, in m.
const KERB: Metre = 2.0;

/// A person may be this far beside a pavement or a crossing, in m.
const BESIDE: Metre = 0.3;

/// Standing is slower than this, in m/s: SUMO's limit for halting.
pub const STANDS: MetrePerSecond = 0.1;

/// What is known of a step besides the road users' states.
#[derive(Clone, Copy)]
pub struct Surroundings<'a> {
    /// The net, if there is one.
    pub net: Option<&'a Net>,
    /// Whether the road users were tracked by sensors, not simulated.
    pub is_tracked: bool,
    /// How long a step lasts, in s; 0 where that is not known.
    pub step: Second,
    /// What the traffic lights show, where that is known.
    pub signals: &'a Signals,
    /// The vehicles of `Tracker::standing` at a scheduled stop.
    pub stopped: &'a [UserIndex],
    /// The path of the front bumper of a row's road user, from where it is.
    pub path: &'a dyn Fn(u32) -> Vec<Point>,
    /// The course of the road user of a row, at least this far ahead.
    pub course: &'a dyn Fn(u32, Metre) -> Course,
    /// The chosen measures of an encounter, if any is chosen.
    pub chosen: &'a dyn Fn(&Encounter) -> Option<Box<ChosenValues>>,
    /// A crash probability of an encounter.
    pub crash_probability: &'a dyn Fn(&Nearness, LoggedMeasure) -> Option<Probability>,
    /// The time advantage of an encounter.
    pub tadv: &'a dyn Fn(&Encounter) -> Option<Second>,
}

/// One road user of a pair.
pub(in crate::events) struct Party {
    pub user: UserIndex,
    pub category: Category,
    /// Whether nothing protects it: a person, a bicycle, a motorcycle.
    pub unprotected: bool,
    pub front: Point,
    pub heading: Radian,
    pub length: Metre,
    pub speed: MetrePerSecond,
    /// How hard it can brake.
    pub brakes: MetrePerSecondSquared,
    /// How far it is from the conflict point.
    pub to_meeting: Metre,
    pub course: Course,
}

/// A pair in a step.
pub(in crate::events) struct Pair<'a> {
    pub ego: Party,
    pub foe: Party,
    pub time: Second,
    pub kind: Kind,
    pub gap: Metre,
    pub found: &'a Encounter,
    /// The conflict point.
    pub at: Point,
    pub around: Surroundings<'a>,
    pub past: &'a Past,
    /// The ways of the ego and the foe through the junction at the conflict point.
    pub passages: Option<[&'a Passage; 2]>,
}

impl Party {
    fn of(frame: &Frame, roster: &Roster, (user, row, to_meeting): (UserIndex, u32, Metre), course: Course) -> Self {
        let (state, profile) = (frame.state(row), roster.profile_of(user));
        let (category, brakes) = (profile.category, profile.brakes.deceleration);
        let (front, heading, speed) = (state.front(), state.heading, state.speed);
        let (length, unprotected) = (profile.length, profile.unprotected);
        Self { user, category, unprotected, front, heading, length, speed, brakes, to_meeting, course }
    }

    pub(crate) fn is_vehicle(&self) -> bool {
        self.category == Category::Vehicle
    }

    /// Whether it is a person on a crossing. Where SUMO does not tell its edge, that is not known at the kerb: SUMO's ways over
    /// a walking area lead over the ends of crossings.
    pub(crate) fn is_on_crossing(&self, net: &Net) -> bool {
        match self.course.at(0.0) {
            Some(lane) => net.function(lane) == EdgeFunction::Crossing,
            None => net.is_within_crossing(self.front, KERB),
        }
    }

    /// Whether it is a person where only persons go. They leave pavements for nothing but crossings, whatever their heading,
    /// and do so when it is their turn.
    pub(crate) fn is_off_the_road(&self, net: &Net) -> bool {
        let is_in_walking_area = |lane| net.function(lane) == EdgeFunction::WalkingArea;
        self.course.at(0.0).is_some_and(is_in_walking_area)
            || (!self.is_on_crossing(net) && net.is_off_the_road(self.front, BESIDE))
    }

    /// The lanes that it is on when its front bumper is between these distances ahead.
    pub(crate) fn lanes_over(&self, [from, to]: [Metre; 2]) -> impl Iterator<Item = LaneIndex> {
        let stretches = self.course.stretches.iter();
        stretches.filter(move |on| on.end > from - self.length && on.begin <= to).map(|on| on.lane)
    }

    /// How far ahead of its front bumper a way through a junction begins or, behind its place to wait within the junction,
    /// goes on; negative where it is past that.
    pub(crate) fn distance_to(&self, lane: LaneIndex) -> Option<Metre> {
        self.course.of(lane).map(|stretch| stretch.begin)
    }

    /// Whether it has passed a place, or can no longer stop before it.
    pub fn passes(&self, ahead: Metre) -> bool {
        ahead < 0.0 || self.speed * self.speed / (2.0 * self.brakes) > ahead
    }

    /// Its ways through junctions, each with how far its conflict point is from there.
    fn passages<'a>(&'a self, net: &'a Net) -> impl Iterator<Item = (&'a Passage, Metre)> {
        self.course.stretches.iter().filter_map(|stretch| {
            let passage = net.passage(stretch.lane).filter(|passage| passage.from != passage.to)?;
            Some((passage, (stretch.begin - self.to_meeting).max(self.to_meeting - stretch.end).max(0.0)))
        })
    }
}

impl<'a> Pair<'a> {
    pub fn of(
        (frame, roster, found): (&Frame, &Roster, &'a Encounter),
        around: Surroundings<'a>,
        past: &'a Past,
    ) -> Self {
        let party = |user, row, to_meeting| {
            let mut course = (around.course)(row, to_meeting);
            if past.is_new(user, frame.time) {
                // It has not driven the lanes behind it.
                course.stretches.retain(|stretch| stretch.end > 0.0);
            }
            Party::of(frame, roster, (user, row, to_meeting), course)
        };
        let ego = party(found.ego, found.ego_row, found.ego_distance);
        let foe = party(found.foe, found.foe_row, found.foe_distance);
        let at = Point::new(found.x, found.y);
        let passages = around.net.and_then(|net| passages(net, &ego, &foe, at));
        Self { ego, foe, time: frame.time, kind: found.kind, gap: found.gap, found, at, around, past, passages }
    }

    /// Each road user, and the other.
    pub fn both(&self) -> [(&Party, &Party); 2] {
        [(&self.ego, &self.foe), (&self.foe, &self.ego)]
    }
}

/// The ways of two through the junction that is nearest to their conflict point; a person's is the crossing there.
fn passages<'a>(net: &'a Net, ego: &Party, foe: &Party, at: Point) -> Option<[&'a Passage; 2]> {
    let owned = |of: &Passage| net.passage(of.lanes[0]);
    let crossing = || net.passage(net.crossing_at(at, BESIDE_A_CROSSING)?);
    let nearest_of = |vehicle: &Party, to: &Passage| {
        let through = vehicle.passages(net).filter(|(passage, _)| passage.junction == to.junction);
        through.min_by(|a, b| a.1.total_cmp(&b.1)).and_then(|(passage, _)| owned(passage))
    };
    match [ego.category, foe.category] {
        [Category::Vehicle, Category::Person] => {
            crossing().and_then(|crossed| Some([nearest_of(ego, crossed)?, crossed]))
        }
        [Category::Person, Category::Vehicle] => {
            crossing().and_then(|crossed| Some([crossed, nearest_of(foe, crossed)?]))
        }
        [Category::Vehicle, Category::Vehicle] => {
            let through =
                ego.passages(net).filter_map(|(passage, away)| Some((passage, away, nearest_of(foe, passage)?)));
            let (passage, _, other) = through.min_by(|a, b| a.1.total_cmp(&b.1))?;
            Some([owned(passage)?, other])
        }
        _ => None,
    }
}

/// The angle between the directions in which two lanes end, −π to π; positive where the second is turned to the left.
pub(super) fn turn_between(net: &Net, one: LaneIndex, other: LaneIndex) -> Radian {
    let direction = |lane: LaneIndex| {
        let vertices: &[Vertex] = net.lines.line(lane.0);
        vertices.last_chunk::<2>().map(|[a, b]| b.point - a.point)
    };
    let Some((one, other)) = direction(one).zip(direction(other)) else { return 0.0 };
    crate::geometry::cross(&one, &other).atan2(one.dot(&other))
}

/// The edge of a lane.
pub(super) fn edge_of(net: &Net, lane: LaneIndex) -> EdgeIndex {
    net.lanes[lane].edge
}
