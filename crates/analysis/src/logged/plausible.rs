//! Whether a row is one that a run can have written: its values within their limits, its times in order, its id new.

use std::sync::LazyLock;

use closecall::util::limits::{ANGLE, DECELERATION, LENGTH, Limit, POSITION, SPEED, TIME, WIDTH};
use closecall_run::output::schema::{COLUMNS, Column, LoggedConflict, Value};

/// μ and gap of the fastest road user with the weakest brakes.
const DISTANCE: Limit = Limit { least: -1e9, most: 1e9, ..POSITION };
/// Times that follow from a speed just above 0 have no largest value.
const SPAN: Limit = Limit { least: 0.0, most: f64::MAX, ..TIME };
const CHANCE: Limit = Limit { unit: "", least: 0.0, most: 1.0, ..POSITION };

/// The columns whose numbers have limits.
static LIMITED: LazyLock<Vec<(&Column, &Limit)>> =
    LazyLock::new(|| COLUMNS.iter().filter_map(|column| Some((column, limit_of(column)?))).collect());

/// What the rows so far demand of the next.
#[derive(Debug, Default)]
pub(crate) struct PlausibleRows {
    /// Whether the log is of conflicts in the sense of margin < 0 only.
    pub margins_below_zero: bool,
    last_id: u64,
}

impl PlausibleRows {
    /// Checks the next row.
    ///
    /// # Errors
    /// What no run writes.
    pub fn check(&mut self, conflict: &LoggedConflict) -> Result<(), String> {
        let LoggedConflict { id, begin, time, end, margin, collision, ego_path, foe_path, .. } = conflict;
        for (column, limit) in LIMITED.iter() {
            if let Value::Number(number) = (column.get)(conflict) {
                limit.check(column.name, number)?;
            }
        }
        if !(begin <= time && time <= end) {
            return Err(format!("begin {begin}, time {time} and end {end} are not in this order"));
        }
        if self.margins_below_zero && *margin > 0.0 && !collision {
            return Err(format!("margin is {margin}, it must be below 0"));
        }
        if *id <= self.last_id {
            return Err(format!("id {id} follows {}", self.last_id));
        }
        self.last_id = *id;
        check_path("ego_path", ego_path)?;
        check_path("foe_path", foe_path)
    }
}

/// The limit of a column's numbers.
fn limit_of(column: &Column) -> Option<&'static Limit> {
    const OBSTACLE_OR: [Limit; 2] = [Limit { is_open: false, ..LENGTH }, Limit { is_open: false, ..WIDTH }];
    Some(match (column.name, column.unit()) {
        ("begin" | "time" | "end", _) => &TIME,
        (name, "m") if name.ends_with("length") => &OBSTACLE_OR[0],
        (name, "m") if name.ends_with("width") => &OBSTACLE_OR[1],
        ("x" | "y" | "ego_x" | "ego_y" | "foe_x" | "foe_y", _) => &POSITION,
        // What a speed loses in a step, or a depth over a time just above 0, has no largest value.
        ("br" | "dr" | "max_d" | "btn" | "stn" | "ta_level" | "ei", _) => return None,
        (_, "m") => &DISTANCE,
        (_, "s") => &SPAN,
        (_, "m/s") => &SPEED,
        (_, "m/s²") => &Limit { least: 0.0, ..DECELERATION },
        (_, "rad") => &ANGLE,
        (_, "1") => &CHANCE,
        _ => return None,
    })
}

fn check_path(name: &str, path: &str) -> Result<(), String> {
    let mut numbers = path.split_ascii_whitespace().map(|number| (number, number.parse().unwrap_or(f64::NAN)));
    match numbers.find(|(_, number)| !POSITION.holds(*number)) {
        Some((text, _)) => Err(format!("{name}: \"{text}\" must be {}", POSITION.range())),
        None => Ok(()),
    }
}
