//! The limits of everything that closecall reads, each with its reason: one table for all readers.
//!
//! A value beyond them is a mistake in the file, and its results mean nothing: a vehicle 10¹⁵ m wide meets every
//! other. Each reader refuses it with the file, the line, the value and the limit. docs/limits.md has the same table.

/// The least and the most of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// What it limits.
    pub of: &'static str,
    /// The unit of its bounds.
    pub unit: &'static str,
    /// The least value.
    pub least: f64,
    /// Whether the least value itself is beyond the limit.
    pub is_open: bool,
    /// The largest value.
    pub most: f64,
    /// Why values beyond it are impossible.
    pub reason: &'static str,
}

const fn between(of: &'static str, unit: &'static str, [least, most]: [f64; 2], reason: &'static str) -> Limit {
    Limit { of, unit, least, is_open: false, most, reason }
}

const fn above_zero(of: &'static str, unit: &'static str, most: f64, reason: &'static str) -> Limit {
    Limit { is_open: true, ..between(of, unit, [0.0, most], reason) }
}

/// x and y.
pub const POSITION: Limit = between(
    "coordinates",
    "m",
    [-1e8, 1e8],
    "grid coordinates that begin with their zone's number reach 6.1e7 m (Gauss–Krüger)",
);
/// z.
pub const HEIGHT: Limit = between("heights", "m", [-1e5, 1e5], "space begins at 100 km");
/// Angles, which may have been added up over many turns.
pub const ANGLE: Limit = between("angles", "rad or °", [-1e6, 1e6], "a day of turning once a second");
/// Speeds.
pub const SPEED: Limit = between("speeds", "m/s", [0.0, 1e3], "the land speed record is 341 m/s (1997)");
/// A speed this little below 0, in m/s, is the noise of a measurement: the road user stands.
const SPEED_NOISE: f64 = 0.1;
/// Decelerations with which a road user brakes.
pub const DECELERATION: Limit = between(
    "decelerations",
    "m/s²",
    [0.01, 1e3],
    "rolling alone slows a train by 0.01 m/s²; a rocket sled reached 453 m/s² (1954)",
);
/// Points in time.
pub const TIME: Limit = between("times", "s", [-1e10, 1e10], "seconds since 1970 reach it in 2286");
/// Response times, delays and thresholds of time.
pub const DURATION: Limit = between("durations", "s", [0.0, 3600.0], "a driver who takes an hour does not drive");
/// Lengths of road users.
pub const LENGTH: Limit = above_zero("lengths", "m", 1e4, "the longest train had 7,353 m (2001)");
/// Widths of road users.
pub const WIDTH: Limit = above_zero("widths", "m", 200.0, "the widest ship has 124 m");
/// Masses of road users.
pub const MASS: Limit = above_zero("masses", "kg", 1e9, "the largest ship weighed 6.6e8 kg laden");
/// Lengths of lanes, and positions along them.
pub const LANE_LENGTH: Limit = between("lengths of lanes", "m", [0.0, 1e7], "from pole to equator are 1e7 m");
/// Widths of lanes.
pub const LANE_WIDTH: Limit = between("widths of lanes", "m", [0.0, 1e4], "a fairway or a square is narrower");
/// Distances that options set: ε, the contact tolerance.
pub const RESERVE: Limit = between("reserves", "m", [0.0, 1e3], "a larger reserve is a stopping distance");
/// Bytes of an id.
pub const NAME: Limit = between("ids", "bytes", [0.0, 1024.0], "SUMO's longest are those of routes, below 200 bytes");
/// Bytes of a row of a table.
pub const LINE: Limit = between("lines of a table", "bytes", [0.0, 65_536.0], "a quotation mark that is not closed");
/// Bytes of a tag, comment or text of an XML file.
pub const ELEMENT: Limit =
    between("tags of an XML file", "bytes", [0.0, 1_048_576.0], "a route of 50,000 edges has as many");
/// Bytes of a text that is read at once.
pub const TEXT: Limit =
    between("options, filters, run.json", "bytes", [0.0, 67_108_864.0], "a filter of 10⁶ edges is smaller");
/// How many times its size a gzipped net or demand file may have when it is unpacked.
pub const INFLATION: Limit =
    between("unpacked size of a gzipped file", "times its size", [0.0, 25.0], "nets and demands shrink by 5 to 20");
/// Points of a polygon.
pub const CORNERS: Limit = between(
    "points of an obstacle",
    "points",
    [3.0, 1000.0],
    "more detail is for coasts, which do not obstruct traffic",
);
/// Pairs of road users near each other in one step, for each road user; never fewer than `FEWEST_PAIRS`.
pub const PAIRS: Limit =
    between("pairs near each other", "per road user", [0.0, 64.0], "a vehicle in a jam is near 10 to 20 others");
/// Pairs that would meet, in one step, for each road user; never fewer than `FEWEST_ENCOUNTERS`.
pub const ENCOUNTERS: Limit =
    between("pairs that would meet", "per road user", [0.0, 32.0], "a vehicle follows one and meets a few others");

/// The number of pairs near each other that a step of any size may have.
pub(crate) const FEWEST_PAIRS: usize = 1 << 21;
/// The number of pairs that would meet that a step of any size may have.
pub(crate) const FEWEST_ENCOUNTERS: usize = 1 << 17;

/// Whether a speed in m/s is below 0, but only as noise makes it; it is read as 0 then, and counted.
pub fn is_noise(speed: f64) -> bool {
    (-SPEED_NOISE..0.0).contains(&speed)
}

/// A line on such speeds.
pub fn said_of_noise(rows: u64) -> Option<String> {
    (rows > 0).then(|| {
        format!("speeds: {rows} are below 0 by at most {SPEED_NOISE} m/s, which is noise, so they are read as 0")
    })
}

/// All limits, in the order of docs/limits.md.
pub const ALL: [Limit; 21] = [
    POSITION,
    HEIGHT,
    ANGLE,
    SPEED,
    DECELERATION,
    TIME,
    DURATION,
    LENGTH,
    WIDTH,
    MASS,
    LANE_LENGTH,
    LANE_WIDTH,
    RESERVE,
    NAME,
    LINE,
    ELEMENT,
    TEXT,
    INFLATION,
    CORNERS,
    PAIRS,
    ENCOUNTERS,
];

impl Limit {
    /// Whether a value is within it; NaN is not.
    #[inline]
    pub const fn holds(&self, value: f64) -> bool {
        value <= self.most && (value > self.least || (value == self.least && !self.is_open))
    }

    /// The value, if it is within the limit.
    ///
    /// # Errors
    /// A message that says what `name` is and what it must be.
    pub fn check(&self, name: &str, value: f64) -> Result<f64, String> {
        if self.holds(value) { Ok(value) } else { Err(self.refused(name, value)) }
    }

    /// What is wrong with a value beyond the limit.
    #[cold]
    pub fn refused(&self, name: &str, value: f64) -> String {
        format!("{name} is {}, it must be {}", shown(value), self.range())
    }

    /// The bounds with their unit, as messages and docs/limits.md have them.
    pub fn range(&self) -> String {
        let (least, most, unit) = (shown(self.least), shown(self.most), self.unit);
        match (self.is_open, self.least) {
            (true, 0.0) => format!("above 0 and at most {most} {unit}"),
            _ => format!("{least} to {most} {unit}"),
        }
    }

    /// The largest count.
    pub const fn count(&self) -> usize {
        self.most as usize
    }
}

/// A number in few digits.
fn shown(value: f64) -> String {
    let (plain, short) = (value.to_string(), format!("{value:e}"));
    if plain.len() <= short.len().clamp(8, 12) { plain } else { short }
}

#[cfg(test)]
mod tests {
    use crate::util::limits::*;

    #[test]
    fn nothing_that_is_no_number_or_endless_is_within_a_limit() {
        for limit in ALL {
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300] {
                assert!(!limit.holds(value), "{} {value}", limit.of);
            }
            assert!(limit.holds(limit.most) && limit.holds(limit.least) != limit.is_open, "{}", limit.of);
        }
    }

    #[test]
    fn a_message_names_value_and_limit() {
        let message = |limit: Limit, value| limit.check("width", value).unwrap_err();
        assert_eq!(message(WIDTH, 1e15), "width is 1e15, it must be above 0 and at most 200 m");
        assert_eq!(message(WIDTH, 0.0), "width is 0, it must be above 0 and at most 200 m");
        assert_eq!(message(POSITION, f64::NAN), "width is NaN, it must be -1e8 to 1e8 m");
        assert_eq!(SPEED.check("speed", 30.0), Ok(30.0));
    }

    #[test]
    fn the_table_in_the_docs_is_that_of_the_program() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/limits.md");
        let text = std::fs::read_to_string(path).unwrap();
        for limit in ALL {
            let row = format!("| {} | {} | {} |", limit.of, limit.range(), limit.reason);
            assert!(text.contains(&row), "docs/limits.md lacks the row\n{row}");
        }
    }
}
