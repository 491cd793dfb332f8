//! The properties that all road users of a type share, from SUMO's type and the options.

use super::driver_distributions::Driver;
use super::sumo_type::SumoType;
use crate::braking::Brakes;
use crate::options::{BrakeSystem, Deceleration, Options, TypeOptions};
use crate::util::limits::{DECELERATION, DURATION, LENGTH, MASS, WIDTH};
use crate::util::units::{Kilogram, Metre, MetrePerSecond, MetrePerSecondSquared, Second};
use crate::{Error, Result};

/// The sort of road user, as far as the model distinguishes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Category {
    /// A vehicle, bicycles included: it brakes with its [`Brakes`].
    Vehicle,
    /// A person on foot: stops within a step. Two persons are not a pair.
    Person,
    /// A static obstacle: its shape is a polygon, and it has no heading.
    Obstacle,
}

impl Category {
    /// The number of categories.
    pub(crate) const COUNT: usize = 3;
}

/// The properties that all road users of a type share.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// SUMO's type id.
    pub name: String,
    /// SUMO's `vClass`; empty for an obstacle.
    pub class: String,
    /// Vehicle, person or obstacle.
    pub category: Category,
    /// Length in m, from front to rear bumper.
    pub length: Metre,
    /// Width in m.
    pub width: Metre,
    /// Length in m of the part whose direction the heading is: the first carriage, or the whole vehicle.
    pub chord: Metre,
    /// The number of carriages; 1 where the vehicle does not bend.
    pub carriages: u32,
    /// Mass in kg.
    pub mass: Kilogram,
    /// How it brakes.
    pub brakes: Brakes,
    /// Its drivers.
    pub driver: Driver,
    /// Whether nothing protects its occupants: a person, a bicycle, a motorcycle.
    pub unprotected: bool,
    /// The speed from which on its drivers follow another of their type more closely than μ allows, in m/s; infinite where
    /// they never do, or where it is not known how they follow.
    pub tailgates_from: MetrePerSecond,
}

/// Classes whose vehicles have air brakes.
const PNEUMATIC_CLASSES: [&str; 6] = ["truck", "trailer", "bus", "coach", "army", "delivery_truck"];

/// Classes that do not protect those who ride them.
const UNPROTECTED_CLASSES: [&str; 6] = ["bicycle", "scooter", "moped", "motorcycle", "wheelchair", "pedestrian"];

/// SUMO's default `emergencyDecel` of passenger cars, which the default drivers' decelerations belong to.
const PASSENGER_CAR_BRAKES: MetrePerSecondSquared = 9.0;

/// A person walks on for the current step and then stops; at this deceleration, within millimetres.
const PERSON_DECELERATION: MetrePerSecondSquared = 1e3;

/// A part of an articulated vehicle that does not bend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carriage {
    /// How far its front is behind the front bumper, along the vehicle, in m.
    pub behind: Metre,
    /// Its length in m.
    pub length: Metre,
}

/// The lengths in m of the first carriage and of the others, and the gap before each of these, by SUMO's shape and class:
/// SUMO's defaults (`SUMOVTypeParameter::initRailVisualizationParameters`; the first measured by the heading on a bend with
/// SUMO 1.28). A shape's row without a class is that of all other classes.
const CARRIAGES: [(&str, &str, [Metre; 3]); 10] = [
    ("bus/flexible", "", [8.25, 8.25, 0.0]),
    ("truck/semitrailer", "", [2.5, 13.5, 0.5]),
    ("truck/trailer", "", [9.25, 6.75, 0.5]),
    ("rail", "rail_electric", [19.1, 24.5, 1.0]),
    ("rail", "rail_fast", [25.835, 24.775, 1.0]),
    ("rail", "", [16.4, 24.5, 1.0]),
    ("rail/railcar", "tram", [5.71, 5.71, 1.0]),
    ("rail/railcar", "rail_urban", [18.4, 18.4, 1.0]),
    ("rail/railcar", "", [16.85, 16.85, 1.0]),
    ("rail/cargo", "", [13.86, 13.86, 1.0]),
];

/// The length of the first carriage of a vehicle, which SUMO's heading is the chord of, and the number of carriages: as
/// many as sumo-gui draws.
fn carriages(shape: &str, class: &str, length: Metre) -> (Metre, u32) {
    let is_of = |known: &str| known == class || known.is_empty();
    let known = CARRIAGES.iter().find(|(known, of, _)| *known == shape && is_of(of));
    let Some((_, _, [first, other, gap])) = known else { return (length, 1) };
    let others = ((length - first) / (other + gap)).round();
    if others >= 1.0 { (*first, 1 + others as u32) } else { (length.min(*first), 1) }
}

/// The name of a type of polygons among the types of road users.
pub fn obstacle_name(polygon_type: &str) -> String {
    format!("polygon:{polygon_type}")
}

/// A type and those that it may have been made from, likeliest first. When a script sets the length of one vehicle, SUMO
/// calls its type `TYPE@VEHICLE`, and either id may itself contain an @.
pub fn origins(name: &str) -> impl Iterator<Item = &str> {
    std::iter::once(name).chain(name.rmatch_indices('@').map(|(end, _)| &name[..end]))
}

fn settings(name: &str, options: &Options) -> TypeOptions {
    origins(name).find_map(|name| options.types.get(name)).cloned().unwrap_or_default()
}

/// The speed from which on drivers of a type follow each other more closely than μ allows. At a speed V they keep V·tau +
/// minGap; until they act, a leader that brakes as usual takes off what an actionStepLength · decel / a of headway is worth.
/// μ is V (t1 + t2 + t3/2) + ε.
fn tailgates_from(sumo: &SumoType, brakes: &Brakes, epsilon: Metre) -> MetrePerSecond {
    let keeps = sumo.tau - sumo.action_step * sumo.decel / brakes.deceleration;
    let lacks = brakes.response + brakes.build_up / 2.0 - keeps;
    let room = (sumo.min_gap - epsilon).max(0.0);
    if lacks > 0.0 { room / lacks } else { f64::INFINITY }
}

impl Profile {
    /// Checks that the values are possible.
    ///
    /// # Errors
    /// [`Error::Profile`] where a dimension, mass or brake value is beyond its limit; an obstacle has none.
    pub fn check(&self) -> Result<()> {
        if self.category == Category::Obstacle {
            return Ok(());
        }
        for (what, value, limit) in [
            ("length", self.length, &LENGTH),
            ("width", self.width, &WIDTH),
            ("mass", self.mass, &MASS),
            ("deceleration", self.brakes.deceleration, &DECELERATION),
            ("response time", self.brakes.response, &DURATION),
            ("build-up time", self.brakes.build_up, &DURATION),
        ] {
            limit.check(what, value).map_err(|why| Error::Profile { name: self.name.to_string(), why })?;
        }
        Ok(())
    }

    /// Its carriages, front to back. The others share the length behind the first equally, couplings included.
    pub fn carriages(&self) -> impl Iterator<Item = Carriage> + use<> {
        let (first, count) = (self.chord, self.carriages);
        let other = (self.length - first) / f64::from(count - 1).max(1.0);
        (0..count).map(move |number| match number {
            0 => Carriage { behind: 0.0, length: first },
            _ => Carriage { behind: first + f64::from(number - 1) * other, length: other },
        })
    }

    /// The profile of a vehicle type: from `[type.NAME]` first, then the general settings, then SUMO.
    pub fn vehicle(sumo: &SumoType, options: &Options) -> Self {
        let set = settings(&sumo.name, options);
        let system = set.brakes.unwrap_or_else(|| {
            if PNEUMATIC_CLASSES.contains(&sumo.vehicle_class.as_str()) {
                BrakeSystem::Pneumatic
            } else {
                BrakeSystem::Hydraulic
            }
        });
        let delay = set.brake_delay.unwrap_or(match system {
            BrakeSystem::Hydraulic => options.hydraulic_delay,
            BrakeSystem::Pneumatic => options.pneumatic_delay,
        });
        let deceleration = set.decel.unwrap_or(match options.decel {
            Deceleration::Emergency => sumo.emergency_decel,
            Deceleration::Decel => sumo.decel,
        });
        let brakes = Brakes {
            response: set.response_time.unwrap_or(options.response_time) + delay,
            build_up: set.build_up.unwrap_or(options.build_up),
            deceleration,
        };
        let length = set.length.unwrap_or(sumo.length);
        let (chord, carriages) = carriages(&sumo.shape, &sumo.vehicle_class, length);
        Self {
            name: sumo.name.clone(),
            class: sumo.vehicle_class.clone(),
            category: Category::Vehicle,
            length,
            chord,
            carriages,
            width: set.width.unwrap_or(sumo.width),
            mass: set.mass.unwrap_or_else(|| sumo.mass_on_the_road()),
            brakes,
            driver: Driver::new(
                options.driver,
                &options.driver_options,
                &set.driver,
                sumo.emergency_decel / PASSENGER_CAR_BRAKES,
            ),
            unprotected: UNPROTECTED_CLASSES.contains(&sumo.vehicle_class.as_str()),
            tailgates_from: tailgates_from(sumo, &brakes, options.epsilon),
        }
    }

    /// The profile of a person type: it stops within a step of `step_length` s.
    pub fn person(sumo: &SumoType, options: &Options, step_length: Second) -> Self {
        let set = settings(&sumo.name, options);
        Self {
            name: sumo.name.clone(),
            class: sumo.vehicle_class.clone(),
            category: Category::Person,
            length: set.length.unwrap_or(sumo.length),
            chord: set.length.unwrap_or(sumo.length),
            carriages: 1,
            width: set.width.unwrap_or(sumo.width),
            mass: set.mass.unwrap_or(sumo.mass),
            brakes: Brakes { response: step_length, build_up: 0.0, deceleration: PERSON_DECELERATION },
            driver: Driver::certain(step_length, PERSON_DECELERATION),
            unprotected: true,
            tailgates_from: f64::INFINITY,
        }
    }

    /// The profile of all polygons of one type: they do not move.
    pub fn obstacle(polygon_type: &str) -> Self {
        Self {
            name: obstacle_name(polygon_type),
            class: String::new(),
            category: Category::Obstacle,
            length: 0.0,
            chord: 0.0,
            carriages: 1,
            width: 0.0,
            mass: f64::MAX,
            brakes: Brakes { response: 0.0, build_up: 0.0, deceleration: 1.0 },
            driver: Driver::certain(0.0, 1.0),
            unprotected: false,
            tailgates_from: f64::INFINITY,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::traffic::profile::*;

    #[test]
    fn a_type_made_for_one_vehicle_inherits_its_settings() {
        let mut options = Options::default();
        for (name, width) in [("car", 1.5), ("car@b", 3.0), ("car@wide", 2.5)] {
            options.types.insert(name.to_owned(), TypeOptions { width: Some(width), ..TypeOptions::default() });
        }
        let width = |name: &str| Profile::vehicle(&SumoType::car(name), &options).width;
        assert_eq!(["car", "car@a", "car@b", "carriage"].map(width), [1.5, 1.5, 3.0, 1.8]);
        // Both the type's id and the vehicle's may contain an @.
        assert_eq!(["car@wide@a", "car@wide@b@1", "car@c@1"].map(width), [2.5, 2.5, 1.5]);
    }

    #[test]
    fn drivers_that_act_seldom_tailgate_at_lower_speeds() {
        let from = |tau, action_step| {
            let sumo = SumoType { tau, action_step, ..SumoType::car("car") };
            Profile::vehicle(&sumo, &Options::default()).tailgates_from
        };
        // 2.5 m less ε of 0.5 m, over what lacks to the response time of 1.05 s and half of the build-up.
        assert!((from(1.0, 0.0) - 20.0).abs() < 1e-9 && (from(1.0, 0.1) - 2.0 / 0.15).abs() < 1e-9);
        assert_eq!(from(1.2, 0.1), f64::INFINITY);
    }

    #[test]
    fn a_ridden_vehicle_of_default_mass_weighs_its_rider_too() {
        let mut options = Options::default();
        options.types.insert("light".to_owned(), TypeOptions { mass: Some(12.0), ..TypeOptions::default() });
        let mass = |sumo: SumoType| Profile::vehicle(&sumo, &options).mass;
        let of_class = |class| mass(SumoType::of_class("any", class));
        assert_eq!(["bicycle", "scooter", "moped", "motorcycle"].map(of_class), [85.0, 85.0, 155.0, 275.0]);
        assert_eq!(["passenger", "wheelchair", "bus", "tram"].map(of_class), [1500.0, 90.0, 12000.0, 37900.0]);
        // Masses that a type or the user sets are taken as they are.
        assert_eq!(mass(SumoType { mass: 95.0, ..SumoType::of_class("any", "bicycle") }), 95.0);
        assert_eq!(mass(SumoType::of_class("light", "bicycle")), 12.0);
    }

    #[test]
    fn an_articulated_vehicle_has_the_carriages_that_sumo_gui_draws() {
        let carriages = |shape: &str, class, length| {
            let sumo = SumoType { length, shape: shape.to_owned(), ..SumoType::of_class("any", class) };
            Profile::vehicle(&sumo, &Options::default()).carriages().map(|carriage| carriage.length).collect::<Vec<_>>()
        };
        assert_eq!(carriages("bus/flexible", "bus", 18.0), [8.25, 9.75]);
        assert_eq!(carriages("truck/semitrailer", "truck", 16.5), [2.5, 14.0]);
        assert_eq!(carriages("truck/trailer", "trailer", 16.5), [9.25, 7.25]);
        assert_eq!(carriages("rail/railcar", "tram", 45.0).len(), 7);
        assert_eq!(carriages("rail/railcar", "subway", 109.5).len(), 6);
        assert_eq!(carriages("rail", "rail_fast", 200.0)[..2], [25.835, (200.0 - 25.835) / 7.0]);
        for (shape, class, length) in [("bus", "bus", 12.0), ("bus/coach", "coach", 14.0), ("truck", "truck", 18.0)] {
            assert_eq!(carriages(shape, class, length), [length], "a rigid vehicle does not bend");
        }
    }

    #[test]
    fn carriages_follow_each_other_over_the_whole_length() {
        let tram =
            Profile::vehicle(&SumoType { length: 45.0, ..SumoType::of_class("any", "tram") }, &Options::default());
        let end = tram.carriages().fold(0.0, |end, carriage| {
            assert!((carriage.behind - end).abs() < 1e-9);
            carriage.behind + carriage.length
        });
        assert!((end - 45.0).abs() < 1e-9);
    }

    #[test]
    fn a_road_user_without_size_is_refused() {
        let options = Options::default();
        let flat = SumoType { width: 0.0, ..SumoType::car("car") };
        for profile in [Profile::vehicle(&flat, &options), Profile::person(&flat, &options, 0.1)] {
            let message = profile.check().unwrap_err().to_string();
            assert_eq!(message, "type \"car\": width is 0, it must be above 0 and at most 200 m");
        }
        Profile::obstacle("kiosk").check().unwrap();
    }
}
