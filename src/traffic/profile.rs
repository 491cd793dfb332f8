//! What all road users of one type have in common, from what SUMO says of the type and what the options set.

use super::sumo_type::SumoType;
use crate::braking::Brakes;
use crate::options::{BrakeSystem, Deceleration, Options, TypeOptions};
use crate::util::units::{Kilogram, Metre, MetrePerSecondSquared, Second};
use crate::{Error, Result};

/// What sort of road user it is, as far as the model distinguishes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Category {
    /// A vehicle (bicycles too): it brakes as its [`Brakes`] say.
    Vehicle,
    /// A person on foot: stops within a step. Two persons are no pair.
    Person,
    /// A static obstacle with a polygon for a shape and no heading of its own.
    Obstacle,
}

impl Category {
    /// How many there are.
    pub(crate) const COUNT: usize = 3;
}

/// What all road users of one type have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// SUMO's type id.
    pub name: String,
    /// Vehicle, person or obstacle.
    pub category: Category,
    /// Length in m, from front to rear bumper.
    pub length: Metre,
    /// Width in m.
    pub width: Metre,
    /// Length in m of what its heading is the direction of: the first carriage, or all of it.
    pub chord: Metre,
    /// Mass in kg.
    pub mass: Kilogram,
    /// How it brakes.
    pub brakes: Brakes,
}

/// Classes whose vehicles have air brakes.
const PNEUMATIC_CLASSES: [&str; 6] = ["truck", "trailer", "bus", "coach", "army", "delivery_truck"];

/// A person walks on for the step under way and then stands: with this deceleration within millimetres.
const PERSON_DECELERATION: MetrePerSecondSquared = 1e3;

/// The length of the first carriage of SUMO's articulated shapes, in m: SUMO's heading is the chord from its rear to
/// the front bumper, however long the rest. (Measured on a bend with SUMO 1.28.)
const FIRST_CARRIAGES: [(&str, Metre); 3] =
    [("truck/trailer", 9.25), ("truck/semitrailer", 2.5), ("bus/flexible", 8.25)];

fn chord(shape: &str, length: Metre) -> Metre {
    let carriage = FIRST_CARRIAGES.iter().find(|(known, _)| *known == shape);
    carriage.map_or(length, |(_, carriage)| carriage.min(length))
}

/// The name of a type of polygons among those of road users.
pub(crate) fn obstacle_name(polygon_type: &str) -> String {
    format!("polygon:{polygon_type}")
}

/// A type and those that it may have been made from: once a script sets a vehicle's length alone, SUMO calls the type
/// `TYPE@VEHICLE`, and either may itself have an @ in its id. The likeliest come first.
pub(crate) fn origins(name: &str) -> impl Iterator<Item = &str> {
    std::iter::once(name).chain(name.rmatch_indices('@').map(|(end, _)| &name[..end]))
}

fn settings(name: &str, options: &Options) -> TypeOptions {
    origins(name).find_map(|name| options.types.get(name)).cloned().unwrap_or_default()
}

impl Profile {
    /// Whether it is possible.
    ///
    /// # Errors
    /// [`Error::Value`] where a dimension, mass or brake value is not finite, negative, or a deceleration of 0.
    pub fn check(&self) -> Result<()> {
        let checks = [
            ("length", self.length, false),
            ("width", self.width, false),
            ("mass", self.mass, true),
            ("deceleration", self.brakes.deceleration, self.category == Category::Vehicle),
            ("response time", self.brakes.response, false),
            ("build-up time", self.brakes.build_up, false),
        ];
        for (what, value, must_be_positive) in checks {
            let bad = !value.is_finite() || value < 0.0 || (must_be_positive && value == 0.0);
            if bad {
                let (wanted, name) = (if must_be_positive { "above 0" } else { "0 or more" }, &self.name);
                return Err(Error::Value(format!(
                    "type \"{name}\": {what} is {value}, it must be finite and {wanted}"
                )));
            }
        }
        Ok(())
    }

    /// The profile of a vehicle type: `[type.NAME]` first, then the general settings, then SUMO.
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
        let length = set.length.unwrap_or(sumo.length);
        Self {
            name: sumo.name.clone(),
            category: Category::Vehicle,
            length,
            chord: chord(&sumo.shape, length),
            width: set.width.unwrap_or(sumo.width),
            mass: set.mass.unwrap_or(sumo.mass),
            brakes: Brakes {
                response: set.response_time.unwrap_or(options.response_time) + delay,
                build_up: set.build_up.unwrap_or(options.build_up),
                deceleration,
            },
        }
    }

    /// The profile of a person type: it stops within a step of `step_length` s.
    pub fn person(sumo: &SumoType, options: &Options, step_length: Second) -> Self {
        let set = settings(&sumo.name, options);
        Self {
            name: sumo.name.clone(),
            category: Category::Person,
            length: set.length.unwrap_or(sumo.length),
            chord: set.length.unwrap_or(sumo.length),
            width: set.width.unwrap_or(sumo.width),
            mass: set.mass.unwrap_or(sumo.mass),
            brakes: Brakes { response: step_length, build_up: 0.0, deceleration: PERSON_DECELERATION },
        }
    }

    /// The profile of all polygons of one type: they do not move.
    pub fn obstacle(polygon_type: &str) -> Self {
        Self {
            name: obstacle_name(polygon_type),
            category: Category::Obstacle,
            length: 0.0,
            chord: 0.0,
            width: 0.0,
            mass: f64::MAX,
            brakes: Brakes { response: 0.0, build_up: 0.0, deceleration: 1.0 },
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::traffic::profile::*;

    #[test]
    fn a_type_made_for_one_vehicle_has_the_settings_of_what_it_was_made_from_unless_it_has_its_own() {
        let mut options = Options::default();
        for (name, width) in [("car", 1.5), ("car@b", 3.0), ("car@wide", 2.5)] {
            options.types.insert(name.to_owned(), TypeOptions { width: Some(width), ..TypeOptions::default() });
        }
        let width = |name: &str| Profile::vehicle(&SumoType::car(name), &options).width;
        assert_eq!(["car", "car@a", "car@b", "carriage"].map(width), [1.5, 1.5, 3.0, 1.8]);
        // Neither the type's own id nor the vehicle's is free of @.
        assert_eq!(["car@wide@a", "car@wide@b@1", "car@c@1"].map(width), [2.5, 2.5, 1.5]);
    }
}
