//! The schema of a conflict: one row per column of `conflicts.csv`.
//!
//! The log, both readers, the Parquet files of a sweep, the report's data and Python's `Conflict` loop over [`COLUMNS`];
//! a test compares the table in docs/log.md and the Python stub with it. The columns of measures that only logs of runs have
//! that ask for them follow from the table of measures, [`closecall::chosen_measures`].

use ecow::EcoString;
use serde::ser::{Serialize, SerializeMap, Serializer};

use super::context::path;
use super::logged_measures::LoggedMeasures;
use super::place::{edge_of, junction_of};
use super::value::Field;
use closecall::detection::kind::{Kind, Severity};
use closecall::detection::measures::headway::headway;
use closecall::events::{Artefact, Conflict, Manoeuvre};
use closecall::options::measures::{ChosenMeasure, Measures};
use closecall::traffic::lane_change::LaneChangeReason;
use closecall::util::units::{
    Degree, Metre, MetrePerSecond, MetrePerSecondSquared, MetreSquaredPerSecondCubed, Probability, Radian, Ratio,
    Second, SecondSquared,
};

pub use super::context::Context;
pub use super::value::{ColumnType, Value};

/// A text that may be missing: it is empty then.
pub(crate) type OptionalText = EcoString;

macro_rules! column {
    ($name:ident: $type:ty, $presence:ident, $($meaning:literal)+) => {
        Column {
            name: stringify!($name),
            meaning: concat!($($meaning),+),
            presence: Presence::$presence,
            column_type: <$type as Field>::TYPE,
            rust_type: stringify!($type),
            get: |conflict| conflict.$name.value(),
            set: |conflict, value| conflict.$name.set(value),
        }
    };
}

/// Makes [`LoggedConflict`] and [`COLUMNS`] of the rows below and those of the table of measures. A row is the meaning; which
/// logs have the column; its name; its type, which names the unit; how to get the value from a [`Conflict`] and its [`Context`].
macro_rules! columns {
    (|$conflict:ident, $context:ident| $(
        $(#[doc = $meaning:literal])+
        [$presence:ident] $name:ident: $type:ty = $value:expr;
    )+ chosen: $(
        $(#[doc = $chosen_meaning:literal])+
        $variant:ident $chosen:ident: $unit:ty, $over:ident = $formula:expr;
    )+) => {
        /// A conflict as a log has it: one field per column.
        #[derive(Clone, Debug, PartialEq)]
        pub struct LoggedConflict {
            $( $(#[doc = $meaning])+ pub $name: $type, )+
            /// The measures that its run was told to log.
            pub chosen: LoggedMeasures,
        }

        /// The columns of `conflicts.csv`, in their order.
        pub static COLUMNS: [Column; [$(stringify!($name),)+ $(stringify!($chosen)),+].len()] = [
            $( column!($name: $type, $presence, $($meaning)+), )+
            $( Column {
                name: stringify!($chosen),
                meaning: concat!($($chosen_meaning),+),
                presence: Presence::Chosen,
                column_type: ColumnType::Number,
                rust_type: stringify!(Option<$unit>),
                get: |conflict| conflict.chosen.of(ChosenMeasure::$variant).map_or(Value::Missing, Value::Number),
                set: |conflict, value| Ok(conflict.chosen.set(ChosenMeasure::$variant, Field::from_value(value)?)),
            }, )+
        ];

        impl LoggedConflict {
            /// The log's row of a conflict.
            pub fn new($conflict: &Conflict, $context: Context) -> Self {
                let mut chosen = LoggedMeasures::default();
                ChosenMeasure::ALL.into_iter().for_each(|measure| chosen.set(measure, $conflict.chosen(measure)));
                Self { $( $name: $value, )+ chosen }
            }

            /// A conflict from its cells; `cell` gets the place of a column and returns what is there.
            ///
            /// # Errors
            /// What `cell` returns, or which value does not fit its column.
            pub fn from_cells<'a>(cell: impl Fn(usize) -> Result<Value<'a>, String>) -> Result<Self, String> {
                let mut columns = COLUMNS.iter().enumerate();
                Ok(Self {
                    $( $name: next_field(&mut columns, &cell)?, )+
                    chosen: {
                        let mut chosen = LoggedMeasures::default();
                        $( chosen.set(ChosenMeasure::$variant, next_field::<Option<$unit>>(&mut columns, &cell)?); )+
                        chosen
                    },
                })
            }
        }
    };
}

closecall::chosen_measures! { columns! |conflict, context|
    /// 1, 2, 3, … in the file's order
    [Required] id: u64 = context.number;
    /// SUMO's id of the ego: the one farther from the conflict point
    [Required] ego: EcoString = conflict.ego.clone();
    /// SUMO's id of the foe
    [Required] foe: EcoString = conflict.foe.clone();
    /// `rear_end`, `frontal`, `side`: by the angle at the conflict point
    [Required] kind: Kind = conflict.kind;
    /// `critical`, `serious`, `caution`: by [a table](numbers.md#severity) of `nearness` and `consequence`; the worst of all
    /// steps
    [Required] severity: Severity = conflict.severity;
    /// how near to a crash it was: `possible`, `likely`, `near_certain`
    [Optional] nearness: OptionalText = conflict.nearness.name().into();
    /// what a crash would have meant: `minor`, `moderate`, `severe`
    [Optional] consequence: OptionalText = conflict.consequence.name().into();
    /// why it is not traffic's and not counted: `drawn_overlap`, `appeared`, `stopped_at_once`, `jumped`, `tracking`
    /// ([rules](artefacts.md)); empty for the rest
    [Optional] artefact: OptionalText = conflict.artefact.map(Artefact::name).unwrap_or_default().into();
    /// first step that meets the log's condition
    [Required] begin: Second = conflict.begin;
    /// last such step
    [Required] end: Second = conflict.end;
    /// first step with the smallest margin. Unless they say otherwise, the columns below describe it; minima and maxima are of
    /// all steps
    [Required] time: Second = conflict.time;
    /// the room that is left
    [Required] gap: Metre = conflict.gap;
    /// the minimal collision distance
    [Required] mu: Metre = conflict.mu;
    /// `gap` − `mu`
    [Required] margin: Metre = conflict.margin;
    /// minimum distance between the rectangles, also between steps
    [Required] clearance: Metre = conflict.clearance;
    /// minimum time to collision at constant speeds along the paths
    [Required] ttc: Option<Second> = conflict.values.ttc();
    /// maximum of the least constant deceleration with which the ego (or both, if the foe comes towards it) just avoids
    /// contact; at most 12.68 m/s²
    [Required] drac: Option<MetrePerSecondSquared> = conflict.values.drac();
    /// whether in any step before contact no deceleration would have avoided it
    [Optional] unavoidable: Option<bool> = Some(conflict.unavoidable);
    /// from the first leaving to the second entering the conflict area, as driven; empty for followers
    [Required] pet: Option<Second> = conflict.pet;
    /// speed change of the ego in a fully inelastic collision
    [Required] ego_delta_v: MetrePerSecond = conflict.ego_delta_v;
    /// speed change of the foe
    [Optional] foe_delta_v: Option<MetrePerSecond> = Some(conflict.foe_delta_v);
    /// speed of the ego
    [Required] ego_speed: MetrePerSecond = conflict.ego_speed;
    /// speed of the foe
    [Required] foe_speed: MetrePerSecond = conflict.foe_speed;
    /// between the headings at the conflict point, 0 to π
    [Required] angle: Radian = conflict.angle;
    /// the ego's front bumper at the conflict point, or the front of the carriage that touches
    [Required] x: Metre = conflict.x;
    /// as `x`
    [Required] y: Metre = conflict.y;
    /// the lane of the conflict point
    [Required] lane: OptionalText = context.lane(conflict).into();
    /// whether the rectangles overlapped by more than the contact tolerance, also between steps
    [Required] collision: bool = conflict.collision;
    /// whether SUMO reported a collision of the two during the conflict; empty for a recording
    [Optional] collision_sumo: Option<bool> = conflict.collision_sumo;
    /// SUMO's type of the ego
    [Optional] ego_type: OptionalText = context.type_name(conflict.ego_profile);
    /// SUMO's type of the foe; `polygon:` and its type for an obstacle
    [Optional] foe_type: OptionalText = context.type_name(conflict.foe_profile);
    /// the ego's front bumper
    [Snapshot] ego_x: Option<Metre> = Some(conflict.ego_snapshot.front.x);
    /// as `ego_x`
    [Snapshot] ego_y: Option<Metre> = Some(conflict.ego_snapshot.front.y);
    /// from rear to front bumper, counter-clockwise from +x
    [Snapshot] ego_heading: Option<Radian> = Some(conflict.ego_snapshot.heading);
    /// length of the ego
    [Snapshot] ego_length: Option<Metre> = Some(conflict.ego_snapshot.length);
    /// width of the ego
    [Snapshot] ego_width: Option<Metre> = Some(conflict.ego_snapshot.width);
    /// where the ego's front bumper would go until it stands, and ε (the reserve) further: `x y x y …`, to the centimetre;
    /// empty if it stands
    [Snapshot] ego_path: OptionalText = path(&conflict.ego_snapshot).into();
    /// the foe's front bumper; a corner of an obstacle
    [Snapshot] foe_x: Option<Metre> = Some(conflict.foe_snapshot.front.x);
    /// as `foe_x`
    [Snapshot] foe_y: Option<Metre> = Some(conflict.foe_snapshot.front.y);
    /// as `ego_heading`
    [Snapshot] foe_heading: Option<Radian> = Some(conflict.foe_snapshot.heading);
    /// length of the foe; 0 for an obstacle
    [Snapshot] foe_length: Option<Metre> = Some(conflict.foe_snapshot.length);
    /// width of the foe; 0 for an obstacle
    [Snapshot] foe_width: Option<Metre> = Some(conflict.foe_snapshot.width);
    /// as `ego_path`, of the foe
    [Snapshot] foe_path: OptionalText = path(&conflict.foe_snapshot).into();
    /// time headway: the room to the foe's rear over the ego's speed; rear-end only
    [Optional] headway: Option<Second> = headway(conflict.kind, conflict.gap, conflict.ego_speed);
    /// maximum overlap, also between steps: the shortest displacement that parts the rectangles; 0 if none
    [Optional] overlap: Option<Metre> = Some(conflict.overlap);
    /// minimum remaining response time: the longest t1 + t2 with which μ fits into the gap, if the foe brakes fully now; 0 if
    /// too late; empty if the ego stood
    [Optional] response_left: Option<Second> = conflict.values.response_left();
    /// time to brake: minimum of the longest wait before full braking that avoids contact, if the foe goes on as now; 0 if too
    /// late; empty without contact
    [Optional] ttb: Option<Second> = conflict.values.ttb();
    /// maximum probability that the driver brakes too late, if the foe goes on as now
    [Optional] crash_probability: Option<Probability> = conflict.values.crash_probability();
    /// the same if the foe brakes fully now
    [Optional] crash_probability_braking: Option<Probability> = conflict.values.crash_probability_braking();
    /// probability of a fatal injury of the one worse off: of occupants at their ΔV, of others at `ego_delta_v` + `foe_delta_v`
    [Optional] injury_probability: Option<Probability> = Some(conflict.injury_probability);
    /// extended ΔV: maximum of the larger ΔV, if each brakes with 8 m/s² until they touch; empty without contact
    [Optional] extended_delta_v: Option<MetrePerSecond> = conflict.values.extended_delta_v();
    /// what the two were doing: `following`, `cut_in`, `lane_change`, `side_by_side`, `merge`, `crossing`, `left_turn_across`,
    /// `right_turn_across`, `turn_into`, `overtaking_oncoming`, `head_on`, `person_crossing`, `person_along`,
    /// `person_standing`, `object` ([rules](causes.md)); empty if their lanes are unknown
    [Optional] manoeuvre: OptionalText = conflict.manoeuvre.map(Manoeuvre::name).unwrap_or_default().into();
    /// why it came about, strongest evidence first, separated by spaces: `ran_red`, `late_amber`, `did_not_yield`,
    /// `changed_lane`, `overtook`, `outside_crossing`, `stood`, `behind_curve`, `leader_braked`, `too_close`, `too_fast`,
    /// `appeared` ([rules](causes.md)); empty if none is known
    [Optional] cause: OptionalText = conflict.causes.to_string().into();
    /// SUMO's lane-change reason: `traci` (a script), `strategic`, `cooperative`, `speed_gain`, `keep_right`, `sublane`; empty
    /// without the cause `changed_lane`, and if unknown, as in a replay
    [Optional] lane_change_reason: OptionalText =
        conflict.lane_change_reason.map(LaneChangeReason::name).unwrap_or_default().into();
    /// lane of the ego's front bumper; the nearest if its path is unknown
    [Optional] ego_lane: OptionalText = context.on_lane(conflict, 0).map(|(lane, _)| lane.into()).unwrap_or_default();
    /// how far along that lane, in SUMO's metres
    [Optional] ego_lane_position: Option<Metre> = context.on_lane(conflict, 0).map(|(_, position)| position);
    /// lane of the foe's front bumper, or of an obstacle's corner
    [Optional] foe_lane: OptionalText = context.on_lane(conflict, 1).map(|(lane, _)| lane.into()).unwrap_or_default();
    /// how far along that lane
    [Optional] foe_lane_position: Option<Metre> = context.on_lane(conflict, 1).map(|(_, position)| position);
    /// the edge of `lane`
    [Optional] edge: OptionalText = edge_of(context.lane(conflict)).into();
    /// the junction that `lane` is within; empty outside junctions
    [Optional] junction: OptionalText = junction_of(context.lane(conflict)).into();
    /// longitude of `x` and `y` by the net's projection, as SUMO converts it; empty without one
    [Optional] lon: Option<Degree> = context.degrees(conflict).map(|degrees| degrees[0]);
    /// latitude of `x` and `y`
    [Optional] lat: Option<Degree> = context.degrees(conflict).map(|degrees| degrees[1]);
    chosen:
}

impl LoggedConflict {
    /// The edge of the conflict point; empty without a lane. Logs of earlier versions have no column for it.
    pub fn edge(&self) -> &str {
        edge_of(&self.lane)
    }

    /// The junction of the conflict point; empty where it is not within one.
    pub fn junction(&self) -> &str {
        junction_of(&self.lane)
    }

    /// Whether it is between the two of these ids, whichever is the ego.
    pub fn is_between(&self, a: &str, b: &str) -> bool {
        [(a, b), (b, a)].contains(&(&*self.ego, &*self.foe))
    }

    /// ΔV of the one whose speed changes most in a collision; the ego's where the log does not have the foe's.
    pub fn delta_v(&self) -> MetrePerSecond {
        self.foe_delta_v.map_or(self.ego_delta_v, |foe| foe.max(self.ego_delta_v))
    }
}

/// One column of the log.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Its name.
    pub name: &'static str,
    /// What its values are, for docs/log.md.
    pub meaning: &'static str,
    /// Which logs have it.
    pub presence: Presence,
    /// How its values are stored.
    pub column_type: ColumnType,
    /// The field's type, which names the unit.
    rust_type: &'static str,
    /// Its value in a conflict.
    pub get: fn(&LoggedConflict) -> Value,
    /// Changes its value in a conflict; an error where it does not fit.
    pub set: fn(&mut LoggedConflict, Value) -> Result<(), String>,
}

/// Which logs have a column, and when it is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Presence {
    /// Every log: a file without it is not a log.
    Required,
    /// Not the logs of earlier versions; its value is missing there.
    Optional,
    /// The same; read only on request, as drawings need it and statistics do not.
    Snapshot,
    /// Only logs whose run was told to add it.
    Chosen,
}

/// Columns that logs of earlier versions have under another name: the name now, and the one then.
const RENAMED: [(&str, &str); 1] = [("ego_delta_v", "delta_v")];

impl Column {
    /// The column of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        COLUMNS.iter().find(|column| column.is_named(name))
    }

    /// The same column under another name.
    pub fn renamed(self, name: &'static str) -> Self {
        Self { name, ..self }
    }

    /// Whether a log has this column under this name.
    pub fn is_named(&self, name: &str) -> bool {
        self.name == name || RENAMED.contains(&(self.name, name))
    }

    /// The unit of its values; empty where they have none.
    pub fn unit(&self) -> &'static str {
        let within = self.rust_type.trim_start_matches("Option").trim_matches(['<', '>', ' ']);
        match within {
            "Second" => "s",
            "Metre" => "m",
            "MetrePerSecond" => "m/s",
            "MetrePerSecondSquared" => "m/s²",
            "Radian" => "rad",
            "Degree" => "°",
            "SecondSquared" => "s²",
            "MetreSquaredPerSecondCubed" => "m²/s³",
            "Probability" | "Ratio" => "1",
            _ => "",
        }
    }

    /// Whether the log of a run with these measures has it.
    pub fn is_in(&self, measures: Measures) -> bool {
        self.presence != Presence::Chosen || measures.chosen().any(|measure| measure.name() == self.name)
    }

    /// Whether a value may be missing: the type is an `Option` or `OptionalText`.
    pub fn is_optional(&self) -> bool {
        self.rust_type.starts_with("Option")
    }
}

/// The next field of a conflict whose fields are read in the order of the columns.
fn next_field<'a, T: Field>(
    columns: &mut impl Iterator<Item = (usize, &'static Column)>,
    cell: &impl Fn(usize) -> Result<Value<'a>, String>,
) -> Result<T, String> {
    let (place, column) = columns.next().ok_or("a conflict has no more columns")?;
    cell(place).and_then(T::from_value).map_err(|why| format!("{}: {why}", column.name))
}

/// Without the snapshots, and without what the run was not told to add.
impl Serialize for LoggedConflict {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for column in COLUMNS.iter().filter(|column| column.presence != Presence::Snapshot) {
            let value = (column.get)(self);
            if column.presence != Presence::Chosen || value != Value::Missing {
                map.serialize_entry(column.name, &value)?;
            }
        }
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::output::schema::*;

    /// The variable with which the tests write what they otherwise compare.
    const BLESS: &str = "BLESS_SCHEMA";

    /// Compares a part of a file with what follows from the schema, or writes it.
    fn follows(file: &str, begin: &str, end: &str, expected: &str) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(file);
        let text = std::fs::read_to_string(&path).unwrap();
        let (before, rest) = text.split_once(begin).unwrap();
        let (part, after) = rest.split_at(rest.find(end).unwrap());
        if std::env::var_os(BLESS).is_some() {
            std::fs::write(&path, format!("{before}{begin}{expected}{after}")).unwrap();
        } else {
            assert!(part == expected, "{file} lags behind the schema: {BLESS}=1 cargo test --lib schema writes it");
        }
    }

    #[test]
    fn the_table_in_the_documentation_has_every_column() {
        let row = |column: &Column| format!("| `{}` | {} |{} |", column.name, column.unit(), column.meaning);
        let rows = COLUMNS.iter().map(row).collect::<Vec<_>>().join("\n");
        follows("docs/log.md", "| column | unit | meaning |\n|---|---|---|\n", "\n\n", &rows);
    }

    #[test]
    fn the_python_stub_has_every_column() {
        let property = |column: &Column| {
            let python = match column.column_type {
                ColumnType::Count => "int",
                ColumnType::Text => "str",
                ColumnType::Number => "float",
                ColumnType::Flag => "bool",
            };
            let or_none = if column.is_optional() { " | None" } else { "" };
            format!("    @property\n    def {}(self) -> {python}{or_none}: ...", column.name)
        };
        let properties = COLUMNS.iter().map(property).collect::<Vec<_>>().join("\n");
        follows("bridge/python/closecall/_closecall.pyi", "class Conflict:\n", "\n\n@", &properties);
    }

    #[test]
    fn what_a_log_may_lack_may_be_missing() {
        let may_lack = |column: &&Column| column.presence != Presence::Required;
        assert!(COLUMNS.iter().filter(may_lack).all(Column::is_optional));
    }

    #[test]
    fn what_may_be_added_is_a_column_in_this_order() {
        let chosen = COLUMNS.iter().filter(|column| column.presence == Presence::Chosen).map(|column| column.name);
        assert_eq!(chosen.collect::<Vec<_>>(), ChosenMeasure::ALL.map(ChosenMeasure::name));
        let in_log = |measures: &str| COLUMNS.iter().filter(|column| column.is_in(measures.parse().unwrap())).count();
        let all = COLUMNS.len();
        assert_eq!(
            ["all", "default", "t2"].map(in_log),
            [all, all - ChosenMeasure::ALL.len(), all - ChosenMeasure::ALL.len() + 1]
        );
    }

    #[test]
    fn every_number_has_a_unit() {
        let is_number = |column: &&Column| column.column_type == ColumnType::Number;
        assert!(COLUMNS.iter().filter(is_number).all(|column| !column.unit().is_empty()));
    }
}
