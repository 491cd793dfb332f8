//! SUMO's types of road users, and its defaults by vehicle class.

use crate::util::units::{Kilogram, Metre, MetrePerSecondSquared, Second};

/// A vehicle or person type, as SUMO describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct SumoType {
    /// The type's id.
    pub name: String,
    /// SUMO's `vClass`.
    pub vehicle_class: String,
    /// SUMO's `guiShape`.
    pub shape: String,
    /// Length in m.
    pub length: Metre,
    /// Width in m.
    pub width: Metre,
    /// Mass in kg.
    pub mass: Kilogram,
    /// `emergencyDecel` in m/s².
    pub emergency_decel: MetrePerSecondSquared,
    /// `decel` in m/s².
    pub decel: MetrePerSecondSquared,
    /// `tau` in s: the headway that its drivers keep.
    pub tau: Second,
    /// `minGap` in m: the room that they keep besides.
    pub min_gap: Metre,
    /// `actionStepLength` in s: how often they act; 0 for in every step.
    pub action_step: Second,
}

impl SumoType {
    /// A type with the defaults of a vehicle class; those of a passenger car where SUMO does not have the class.
    pub fn of_class(name: &str, class: &str) -> Self {
        let known = CLASSES.iter().find(|(known, ..)| *known == class).unwrap_or(&CLASSES[0]);
        let (_, length, width, mass, emergency_decel, decel) = *known;
        let shape = match class {
            "trailer" => "truck/trailer",
            "tram" | "rail_urban" | "subway" => "rail/railcar",
            "rail" | "rail_electric" | "rail_fast" => "rail",
            _ => class,
        };
        Self {
            name: name.to_owned(),
            vehicle_class: class.to_owned(),
            shape: shape.to_owned(),
            length,
            width,
            mass,
            emergency_decel,
            decel,
            tau: TAU,
            min_gap: min_gap(class),
            action_step: 0.0,
        }
    }

    /// Mass in kg on the road. SUMO's default for a class that is ridden is the vehicle's alone; a rider is added.
    pub(crate) fn mass_on_the_road(&self) -> Kilogram {
        let is_default =
            CLASSES.iter().any(|(class, _, _, mass, ..)| *class == self.vehicle_class && *mass == self.mass);
        if is_default && RIDDEN.contains(&self.vehicle_class.as_str()) { self.mass + RIDER } else { self.mass }
    }

    /// A passenger car.
    pub fn car(name: &str) -> Self {
        Self::of_class(name, CLASSES[0].0)
    }
}

/// Classes whose vehicles are ridden.
const RIDDEN: [&str; 4] = ["bicycle", "scooter", "moped", "motorcycle"];
/// The mass of a rider in kg, by Regulation (EU) No 168/2013, article 5 (2).
const RIDER: Kilogram = 75.0;

/// SUMO's default `tau`.
const TAU: Second = 1.0;

/// SUMO 1.28's default `minGap` of a vehicle class.
fn min_gap(class: &str) -> Metre {
    match class {
        "pedestrian" => 0.25,
        "bicycle" | "scooter" | "wheelchair" => 0.5,
        "rail_urban" | "rail" | "rail_electric" | "rail_fast" | "subway" => 5.0,
        _ => 2.5,
    }
}

/// SUMO 1.28's defaults by vehicle class: length and width in m, mass in kg, `emergencyDecel` and
/// `decel` in m/s². Other classes have those of the first.
const CLASSES: [(&str, f64, f64, f64, f64, f64); 23] = [
    ("passenger", 5.0, 1.8, 1500.0, 9.0, 4.5),
    ("emergency", 6.5, 2.16, 5000.0, 9.0, 4.5),
    ("pedestrian", 0.215, 0.478, 70.0, 5.0, 2.0),
    ("bus", 12.0, 2.5, 12000.0, 7.0, 4.0),
    ("coach", 14.0, 2.6, 25000.0, 7.0, 4.0),
    ("delivery", 6.5, 2.16, 5000.0, 9.0, 4.5),
    ("truck", 7.1, 2.4, 4500.0, 7.0, 4.0),
    ("trailer", 16.5, 2.55, 13000.0, 7.0, 4.0),
    ("tram", 22.0, 2.4, 37900.0, 7.0, 3.0),
    ("rail_urban", 109.5, 3.0, 59000.0, 7.0, 3.0),
    ("rail", 135.0, 2.84, 79500.0, 5.0, 1.3),
    ("rail_electric", 200.0, 2.95, 83000.0, 5.0, 1.3),
    ("rail_fast", 200.0, 2.95, 409000.0, 5.0, 1.3),
    ("motorcycle", 2.2, 0.9, 200.0, 10.0, 10.0),
    ("moped", 2.1, 0.78, 80.0, 10.0, 7.0),
    ("bicycle", 1.6, 0.65, 10.0, 7.0, 3.0),
    ("ship", 17.0, 4.0, 100000.0, 1.0, 0.15),
    ("container", 6.096, 2.438, 1500.0, 9.0, 4.5),
    ("subway", 109.5, 3.0, 59000.0, 9.0, 4.5),
    ("aircraft", 72.7, 79.8, 1500.0, 9.0, 4.5),
    ("wheelchair", 1.2, 0.72, 90.0, 5.0, 2.0),
    ("scooter", 1.2, 0.5, 10.0, 7.0, 3.0),
    ("drone", 0.5, 0.5, 1500.0, 9.0, 4.5),
];
