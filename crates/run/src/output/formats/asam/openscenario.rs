//! A clip as ASAM OpenSCENARIO XML 1.2: each road user follows the line that it drove, at the times when it was there.
//!
//! A vehicle's reference point is the middle of its rear axle, a pedestrian's and an object's the middle of its box (OpenSCENARIO
//! XML 1.2, coordinate systems). Heights are left out, which puts everyone on the road.

use std::fmt::Write;
use std::ops::Range;

use rustc_hash::FxHashSet;

use super::bodies::{Place, WHEEL, axle, box_around, class_of, places};
use crate::output::schema::LoggedConflict;
use crate::util::decimal::shortest;
use crate::util::xml_text::escaped;
use closecall::events::{Clip, ClipCategory, ClipUser};
use closecall::geometry::Point;
use closecall::util::units::{Metre, Second};

/// The format wants the largest speed, acceleration and deceleration of each vehicle, in m/s and m/s²: more than any that follows
/// a line in time reaches.
const LIMITS: [f64; 3] = [200.0, 50.0, 50.0];
/// The format wants the mass of each pedestrian and object, in kg: nothing in the scenario depends on it.
const MASS: f64 = 75.0;
/// The largest angle of a steered wheel in rad.
const STEERING: f64 = 0.5;

/// The inputs of a scenario.
#[derive(Clone, Copy, Debug)]
pub struct Scenario<'a> {
    /// The conflict.
    pub conflict: &'a LoggedConflict,
    /// Where the road users were.
    pub clip: &'a Clip,
    /// The file of OpenDRIVE beside the scenario; none without a net.
    pub roads: Option<&'a str>,
    /// When the log was written, as the format has it: 2026-11-28T09:30:00Z.
    pub date: &'a str,
}

/// The scenario's text. Its time is 0 at the clip's begin.
pub fn scenario(scenario: &Scenario) -> String {
    let Scenario { conflict, clip, roads, date } = scenario;
    let entities = entities(clip);
    let [begin, end] = [clip.times.first(), clip.times.last()].map(|time| time.copied().unwrap_or_default());
    let description = format!(
        "Conflict {} of {} with {}: {}, {}, worst {} s after the begin, which is {} s in SUMO",
        conflict.id,
        conflict.ego,
        conflict.foe,
        conflict.kind.name(),
        conflict.severity.name(),
        decimals(conflict.time - begin),
        decimals(begin)
    );
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<OpenSCENARIO>\n  \
           <FileHeader revMajor=\"1\" revMinor=\"2\" date=\"{date}\" author=\"closecall {}\" description=\"{}\"/>\n  \
           <CatalogLocations/>\n",
        env!("CARGO_PKG_VERSION"),
        escaped(&description)
    );
    text += &roads.map_or_else(
        || "  <RoadNetwork/>\n".to_owned(),
        |roads| format!("  <RoadNetwork>\n    <LogicFile filepath=\"{roads}\"/>\n  </RoadNetwork>\n"),
    );
    text += "  <Entities>\n";
    entities.iter().for_each(|entity| text += &entity.declared());
    text += "  </Entities>\n  <Storyboard>\n    <Init>\n      <Actions>\n";
    entities.iter().for_each(|entity| text += &entity.at_the_begin());
    text += "      </Actions>\n    </Init>\n    <Story name=\"conflict\">\n      <Act name=\"conflict\">\n";
    entities.iter().for_each(|entity| text += &entity.what_it_does(clip));
    let [start, stop] = [("start", 0.0), ("stop", end - begin)].map(|(name, time)| condition(name, time));
    let _ = write!(
        text,
        "        <StartTrigger>{start}</StartTrigger>\n      </Act>\n    </Story>\n    <StopTrigger>{stop}</StopTrigger>\n  \
           </Storyboard>\n</OpenSCENARIO>\n"
    );
    text
}

/// An entity of the scenario: a road user, or a part of an obstacle.
struct Entity<'a> {
    /// Its name, safe in XML.
    name: String,
    user: &'a ClipUser,
    role: Option<&'static str>,
    length: Metre,
    width: Metre,
    places: Vec<Option<Place>>,
}

fn entities(clip: &Clip) -> Vec<Entity<'_>> {
    let mut taken = FxHashSet::default();
    let mut entities = Vec::new();
    for (user, role) in clip.users.iter().zip([Some("ego"), Some("foe")].into_iter().chain(std::iter::repeat(None))) {
        let mut add = |length, width, places| {
            entities.push(Entity { name: name(&user.id, &mut taken), user, role, length, width, places });
        };
        if user.category == ClipCategory::Obstacle {
            for bounds in user.outlines.iter().map(|part| box_around(part)) {
                let (centre, size) = (nalgebra::center(&bounds.low, &bounds.high), bounds.size());
                add(size.x, size.y, vec![Some(Place { centre, heading: 0.0, speed: 0.0 }); clip.times.len()]);
            }
        } else {
            add(user.length, user.width, places(user));
        }
    }
    entities
}

/// A name that no other has. A `$` at its begin would make it the name of a parameter.
fn name(id: &str, taken: &mut FxHashSet<String>) -> String {
    let id = escaped(id.strip_prefix('$').unwrap_or(id)).into_owned();
    let names = std::iter::once(id.clone()).chain((2..).map(|number| format!("{id}_{number}")));
    let mut free = names.filter(|name| taken.insert(name.clone()));
    free.next().unwrap_or(id)
}

impl Entity<'_> {
    /// How far the reference point is behind the centre.
    fn behind(&self) -> Metre {
        if self.user.category == ClipCategory::Vehicle { axle(self.user) } else { 0.0 }
    }

    fn reference(&self, place: &Place) -> Point {
        place.centre - place.forward() * self.behind()
    }

    fn position(&self, place: &Place) -> String {
        let Point { coords } = self.reference(place);
        let [x, y, heading] = [coords.x, coords.y, place.heading].map(decimals);
        format!("<Position><WorldPosition x=\"{x}\" y=\"{y}\" h=\"{heading}\"/></Position>")
    }

    /// Its `ScenarioObject`.
    fn declared(&self) -> String {
        let Self { name, user, length, width, .. } = self;
        let class = class_of(user);
        let [behind, length, half_height, height] =
            [self.behind(), *length, class.height / 2.0, class.height].map(decimals);
        let width = decimals(*width);
        let mut inner = format!(
            "        <BoundingBox>\n          <Center x=\"{behind}\" y=\"0\" z=\"{half_height}\"/>\n          \
                       <Dimensions length=\"{length}\" width=\"{width}\" height=\"{height}\"/>\n        </BoundingBox>\n"
        );
        let (what, more) = match user.category {
            ClipCategory::Vehicle => {
                let [speed, acceleration, deceleration] = LIMITS;
                let axle = |kind: &str, steering: f64, x: Metre| {
                    format!(
                        "          <{kind}Axle maxSteering=\"{steering}\" wheelDiameter=\"{WHEEL}\" trackWidth=\"{width}\" \
                                   positionX=\"{}\" positionZ=\"{}\"/>\n",
                        decimals(x),
                        WHEEL / 2.0
                    )
                };
                let _ = write!(
                    inner,
                    "        <Performance maxSpeed=\"{speed}\" maxAcceleration=\"{acceleration}\" \
                             maxDeceleration=\"{deceleration}\"/>\n        <Axles>\n{}{}        </Axles>\n",
                    axle("Front", STEERING, 2.0 * self.behind()),
                    axle("Rear", 0.0, 0.0)
                );
                ("Vehicle", format!("vehicleCategory=\"{}\"", class.category))
            }
            ClipCategory::Person => {
                let kind = if user.class == "wheelchair" { "wheelchair" } else { "pedestrian" };
                ("Pedestrian", format!("mass=\"{MASS}\" pedestrianCategory=\"{kind}\""))
            }
            ClipCategory::Obstacle => ("MiscObject", format!("mass=\"{MASS}\" miscObjectCategory=\"obstacle\"")),
        };
        let role = self.role.map(|role| format!("<Property name=\"role\" value=\"{role}\"/>")).unwrap_or_default();
        let model = if user.class.is_empty() { what } else { &user.class };
        format!(
            "    <ScenarioObject name=\"{name}\">\n      <{what} name=\"{}\" {more}>\n{inner}        \
                   <Properties>{role}</Properties>\n      </{what}>\n    </ScenarioObject>\n",
            escaped(model)
        )
    }

    /// Its place and speed at the scenario's begin, if it is there then.
    fn at_the_begin(&self) -> String {
        let Some(place) = self.places.first().and_then(Option::as_ref) else { return String::new() };
        let mut text = format!(
            "        <Private entityRef=\"{}\">\n          <PrivateAction><TeleportAction>{}</TeleportAction></PrivateAction>\n",
            self.name,
            self.position(place)
        );
        if self.user.category != ClipCategory::Obstacle {
            let _ = writeln!(
                text,
                "          <PrivateAction><LongitudinalAction><SpeedAction><SpeedActionDynamics dynamicsShape=\"step\" \
                           dynamicsDimension=\"time\" value=\"0\"/><SpeedActionTarget><AbsoluteTargetSpeed value=\"{}\"/>\
                           </SpeedActionTarget></SpeedAction></LongitudinalAction></PrivateAction>",
                decimals(place.speed)
            );
        }
        text + "        </Private>\n"
    }

    /// Its events: that it comes, drives and leaves.
    fn what_it_does(&self, clip: &Clip) -> String {
        let name = &self.name;
        let spans = if self.user.category == ClipCategory::Obstacle { Vec::new() } else { self.spans() };
        if spans.is_empty() {
            return String::new();
        }
        let mut text = format!(
            "        <ManeuverGroup name=\"{name}\" maximumExecutionCount=\"1\">\n          \
                       <Actors selectTriggeringEntities=\"false\"><EntityRef entityRef=\"{name}\"/></Actors>\n          \
                       <Maneuver name=\"{name}\">\n"
        );
        for (number, span) in spans.into_iter().enumerate() {
            let after = |place: usize| clip.times[place] - clip.times[0];
            let mut actions = String::new();
            if span.start > 0 {
                actions += &self.places[span.start].map(|place| self.comes(&place)).unwrap_or_default();
            }
            if span.len() > 1 {
                actions += &self.follows(span.clone(), after);
            }
            text += &event(&format!("drives_{number}"), &actions, after(span.start));
            if span.end < clip.times.len() {
                let leaves = format!(
                    "<Action name=\"leaves\"><GlobalAction><EntityAction entityRef=\"{name}\"><DeleteEntityAction/>\
                     </EntityAction></GlobalAction></Action>"
                );
                text += &event(&format!("leaves_{number}"), &leaves, after(span.end));
            }
        }
        text + "          </Maneuver>\n        </ManeuverGroup>\n"
    }

    /// The runs of times at which it is there.
    fn spans(&self) -> Vec<Range<usize>> {
        let places = self.places.iter().enumerate().collect::<Vec<_>>();
        let spans = places.chunk_by(|(_, one), (_, next)| one.is_some() == next.is_some());
        let spans =
            spans.filter_map(|span| span.first().filter(|(_, place)| place.is_some()).map(|(at, _)| (*at, span)));
        spans.map(|(at, span)| at..at + span.len()).collect()
    }

    fn comes(&self, place: &Place) -> String {
        format!(
            "<Action name=\"comes\"><GlobalAction><EntityAction entityRef=\"{}\"><AddEntityAction>{}</AddEntityAction>\
             </EntityAction></GlobalAction></Action>",
            self.name,
            self.position(place)
        )
    }

    /// That it follows its line over these times.
    fn follows(&self, span: Range<usize>, after: impl Fn(usize) -> Second) -> String {
        let places = span.filter_map(|place| self.places[place].map(|at| (after(place), self.position(&at))));
        let vertices = places.map(|(time, position)| {
            format!("                  <Vertex time=\"{}\">{position}</Vertex>\n", decimals(time))
        });
        format!(
            "<Action name=\"drives\"><PrivateAction><RoutingAction><FollowTrajectoryAction>\n                \
             <TrajectoryRef><Trajectory name=\"{}\" closed=\"false\"><Shape><Polyline>\n{}                \
             </Polyline></Shape></Trajectory></TrajectoryRef>\n                \
             <TimeReference><Timing domainAbsoluteRelative=\"absolute\" scale=\"1\" offset=\"0\"/></TimeReference>\n                \
             <TrajectoryFollowingMode followingMode=\"position\"/>\n              \
             </FollowTrajectoryAction></RoutingAction></PrivateAction></Action>",
            self.name,
            vertices.collect::<String>()
        )
    }
}

fn event(name: &str, actions: &str, time: Second) -> String {
    format!(
        "            <Event name=\"{name}\" priority=\"parallel\" maximumExecutionCount=\"1\">\n              {actions}\n              \
                       <StartTrigger>{}</StartTrigger>\n            </Event>\n",
        condition(name, time)
    )
}

/// That a time has come.
fn condition(name: &str, time: Second) -> String {
    format!(
        "<ConditionGroup><Condition name=\"{name}\" delay=\"0\" conditionEdge=\"none\"><ByValueCondition>\
         <SimulationTimeCondition value=\"{}\" rule=\"greaterOrEqual\"/></ByValueCondition></Condition></ConditionGroup>",
        decimals(time)
    )
}

fn decimals(value: f64) -> String {
    shortest(value, &mut String::new()).to_owned()
}
