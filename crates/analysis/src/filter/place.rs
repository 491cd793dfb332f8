//! A place on the map, as `--where` takes it: a circle, or the id of a junction, edge or lane.

use std::fmt;
use std::str::FromStr;

use strum::{Display, EnumString, VariantArray};

use closecall::geometry::Point;
use closecall::util::units::Metre;
use closecall_run::output::schema::LoggedConflict;

/// A place on the map.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// Within a distance of a point.
    Circle {
        /// Its centre.
        centre: Point,
        /// Its radius.
        radius: Metre,
    },
    /// A part of the net.
    Named {
        /// Which part; none for any that has the id.
        part: Option<Part>,
        /// SUMO's id.
        id: String,
    },
}

/// A part of the net that has an id.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Display, EnumString, VariantArray)]
#[strum(serialize_all = "snake_case")]
pub enum Part {
    /// A junction.
    Junction,
    /// An edge.
    Edge,
    /// A lane.
    Lane,
}

impl Part {
    fn of(self, conflict: &LoggedConflict) -> &str {
        match self {
            Self::Junction => conflict.junction(),
            Self::Edge => conflict.edge(),
            Self::Lane => &conflict.lane,
        }
    }
}

impl Place {
    /// The columns that it needs.
    pub fn columns(&self) -> &'static [&'static str] {
        match self {
            Self::Circle { .. } => &["x", "y"],
            Self::Named { .. } => &["lane"],
        }
    }

    /// Whether the conflict point is there.
    pub fn holds(&self, conflict: &LoggedConflict) -> bool {
        match self {
            Self::Circle { centre, radius } => (Point::new(conflict.x, conflict.y) - centre).norm() <= *radius,
            Self::Named { part: Some(part), id } => part.of(conflict) == id,
            Self::Named { part: None, id } => Part::VARIANTS.iter().any(|part| part.of(conflict) == id),
        }
    }
}

impl FromStr for Place {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        // No id in SUMO has a comma.
        if text.contains(',') {
            let numbers =
                text.split(',').map(|number| number.trim().parse::<f64>().ok().filter(|number| number.is_finite()));
            return match numbers.collect::<Option<Vec<_>>>().as_deref() {
                Some(&[x, y, radius]) if radius > 0.0 => Ok(Self::Circle { centre: Point::new(x, y), radius }),
                _ => Err("a circle must be x,y,radius: three numbers in m, the radius above 0".to_owned()),
            };
        }
        let named = text.split_once(':').and_then(|(part, id)| Some((part.parse().ok()?, id)));
        let (part, id) = named.map_or((None, text), |(part, id)| (Some(part), id));
        if id.is_empty() {
            return Err("it must be x,y,radius or the id of a junction, edge or lane".to_owned());
        }
        Ok(Self::Named { part, id: id.to_owned() })
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Circle { centre, radius } => write!(f, "{},{},{radius}", centre.x, centre.y),
            Self::Named { part: Some(part), id } => write!(f, "{part}:{id}"),
            Self::Named { part: None, id } => f.write_str(id),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_written_as_it_is_read() {
        for text in ["10,-20.5,30", "junction:B1", "edge:-a#2", "lane:a_0", "B1", ":B1_3_0", "edgeless"] {
            assert_eq!(text.parse::<Place>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn what_is_no_place_is_refused() {
        for text in ["", "junction:", "1,2", "1,2,0", "1,2,-3", "1,2,x", "nan,0,1", "1,2,3,4", ","] {
            assert!(text.parse::<Place>().is_err(), "{text}");
        }
    }
}
