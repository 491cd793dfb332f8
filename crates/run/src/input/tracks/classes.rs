//! What the names of classes in public data mean.

use super::fcd_row::PEDESTRIAN;

/// What the name of a class means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Class {
    /// One of SUMO's classes.
    Known(&'static str),
    /// Things without a driver.
    NoRoadUser,
    Unknown,
}

const CLASSES: [(&str, &str); 29] = [
    ("car", "passenger"),
    ("passenger", "passenger"),
    ("vehicle", "passenger"),
    ("auto", "passenger"),
    ("van", "passenger"),
    ("suv", "passenger"),
    ("mv", "passenger"),
    ("truck", "truck"),
    ("lorry", "truck"),
    ("hgv", "truck"),
    ("truck_bus", "truck"),
    ("vehicle.construction", "truck"),
    ("trailer", "trailer"),
    ("bus", "bus"),
    ("tram", "tram"),
    ("motorcycle", "motorcycle"),
    ("motorcyclist", "motorcycle"),
    ("motorbike", "motorcycle"),
    ("moped", "moped"),
    ("bicycle", "bicycle"),
    ("bicyclist", "bicycle"),
    ("cyclist", "bicycle"),
    ("bike", "bicycle"),
    ("tricycle", "bicycle"),
    ("pedestrian", PEDESTRIAN),
    ("person", PEDESTRIAN),
    ("people", PEDESTRIAN),
    ("pedestrian/bicycle", PEDESTRIAN),
    ("animal", PEDESTRIAN),
];

/// Of Argoverse, nuScenes, KITTI and CARLA.
const NO_ROAD_USERS: [&str; 35] = [
    "static",
    "background",
    "construction",
    "riderless_bicycle",
    "static_object",
    "movable_object",
    "bicycle_rack",
    "barrier",
    "barricade",
    "bollard",
    "cone",
    "construction_cone",
    "construction_barrel",
    "traffic_cone",
    "trafficcone",
    "traffic_sign",
    "traffic_light",
    "sign",
    "stop_sign",
    "message_board_trailer",
    "mobile_pedestrian_crossing_sign",
    "pushable_pullable",
    "debris",
    "obstacle",
    "building",
    "fence",
    "wall",
    "pole",
    "tree",
    "vegetation",
    "road",
    "ground",
    "dontcare",
    "dont_care",
    "ignore",
];

impl Class {
    /// What a name means; nuScenes puts the general before the particular (`vehicle.bus.rigid`).
    pub fn of(name: &str) -> Self {
        let name = name.to_lowercase().replace([' ', '-'], "_");
        let mut parts = name.rsplit('.').map(Self::of_part);
        match Self::of_part(&name) {
            Self::Unknown => parts.find(|class| *class != Self::Unknown).unwrap_or(Self::Unknown),
            class => class,
        }
    }

    fn of_part(name: &str) -> Self {
        match CLASSES.iter().find(|(known, _)| *known == name) {
            Some((_, class)) => Self::Known(class),
            None if NO_ROAD_USERS.contains(&name) => Self::NoRoadUser,
            None => Self::Unknown,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn things_are_no_road_users_and_other_names_are_unknown() {
        for (name, class) in [
            ("Car", Class::Known("passenger")),
            ("Truck-Bus", Class::Known("truck")),
            ("vehicle.bus.rigid", Class::Known("bus")),
            ("vehicle.construction", Class::Known("truck")),
            ("human.pedestrian.construction_worker", Class::Known(PEDESTRIAN)),
            ("STATIC", Class::NoRoadUser),
            ("movable_object.trafficcone", Class::NoRoadUser),
            ("Traffic Cone", Class::NoRoadUser),
            ("hovercraft", Class::Unknown),
            ("", Class::Unknown),
        ] {
            assert_eq!(Class::of(name), class, "{name}");
        }
    }
}
