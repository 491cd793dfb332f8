//! The road users of a table, and assumptions about them, counted and reported.

use rustc_hash::{FxHashMap, FxHashSet};

use super::classes::Class;
use super::mapping::Mapping;
use super::said::Said;

/// Names that a remark has at most.
const NAMED: usize = 5;
/// The number of a class of things other than road users.
const NONE: u32 = u32::MAX;

/// What is known of the road users beside their rows.
#[derive(Default)]
pub(super) struct Users {
    ids: Vec<String>,
    /// By what tells them apart.
    numbers: FxHashMap<String, u32>,
    /// How many road users have an id.
    of_id: FxHashMap<String, u32>,
    /// By the number that a row has: SUMO's class.
    classes: Vec<&'static str>,
    /// The number of each name of a class in the file that is read.
    known: FxHashMap<String, u32>,
    pub counts: Counts,
}

/// How many rows lacked what, or were left out.
#[derive(Default)]
pub(super) struct Counts {
    /// All rows of road users.
    pub rows: u64,
    pub headings: u64,
    pub speeds: u64,
    pub lengths: u64,
    pub widths: u64,
    pub classes: u64,
    left_out: u64,
    /// The first [`NAMED`] names of unknown classes, and of things other than road users.
    unknown: Vec<String>,
    things: Vec<String>,
    /// Road users that the file with the classes lacks.
    pub unclassed: FxHashSet<String>,
}

impl Users {
    /// The number of the road user with this key; a new one gets this id.
    pub fn number(&mut self, key: &str, id: &str) -> u32 {
        match self.numbers.get(key) {
            Some(known) => *known,
            None => {
                let number = self.ids.len() as u32;
                self.numbers.insert(key.to_owned(), number);
                self.ids.push(id.to_owned());
                number
            }
        }
    }

    /// As [`Users::number`], for data whose ids are used again: the second road user with the id 5 is 5#2.
    pub(crate) fn number_of_reused(&mut self, key: &str, id: &str) -> u32 {
        match self.numbers.get(key) {
            Some(known) => *known,
            None => {
                let number = self.again(id);
                self.numbers.insert(key.to_owned(), number);
                number
            }
        }
    }

    /// Another road user that has the id of this one.
    pub(crate) fn again_as(&mut self, known: u32) -> u32 {
        let id = self.original(known).to_owned();
        self.again(&id)
    }

    /// The number of one more road user with this id.
    pub fn again(&mut self, id: &str) -> u32 {
        let count = self.of_id.entry(id.to_owned()).or_default();
        *count += 1;
        self.ids.push(if *count == 1 { id.to_owned() } else { format!("{id}#{count}") });
        self.ids.len() as u32 - 1
    }

    /// The id of a road user.
    pub fn id(&self, user: u32) -> &str {
        self.ids.get(user as usize).map_or("", String::as_str)
    }

    /// The id of a road user as the file has it.
    pub fn original(&self, user: u32) -> &str {
        let id = self.id(user);
        id.rsplit_once('#').filter(|(before, _)| self.of_id.contains_key(*before)).map_or(id, |(before, _)| before)
    }

    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// Begins another file: its names of classes may mean something else.
    pub(crate) fn begin_file(&mut self) {
        self.known.clear();
    }

    /// The number of a class by its name; none for things other than road users, which are counted.
    pub fn class(&mut self, name: &str, mapping: &Mapping) -> Option<u32> {
        let number = match self.known.get(name) {
            Some(number) => *number,
            None => {
                let number = self.new_class(name, mapping);
                self.known.insert(name.to_owned(), number);
                number
            }
        };
        self.counts.left_out += u64::from(number == NONE);
        (number != NONE).then_some(number)
    }

    fn new_class(&mut self, name: &str, mapping: &Mapping) -> u32 {
        let lower = name.to_lowercase();
        let code = mapping.classes.iter().find(|(known, _)| *known == lower);
        let class = match code.map_or_else(|| Class::of(name), |(_, class)| Class::Known(class)) {
            Class::Known(class) => class,
            Class::NoRoadUser => {
                note(&mut self.counts.things, name);
                return NONE;
            }
            Class::Unknown => {
                note(&mut self.counts.unknown, name);
                "passenger"
            }
        };
        let place = self.classes.iter().position(|known| *known == class).unwrap_or_else(|| {
            self.classes.push(class);
            self.classes.len() - 1
        });
        place as u32
    }

    /// SUMO's class with this number.
    pub(crate) fn class_name(&self, class: u32) -> &'static str {
        self.classes.get(class as usize).copied().unwrap_or("passenger")
    }
}

fn note(names: &mut Vec<String>, name: &str) {
    if !name.is_empty() && names.len() < NAMED && !names.iter().any(|known| known == name) {
        names.push(name.to_owned());
    }
}

impl Counts {
    /// Says what was assumed.
    pub fn note_assumed(&self, said: &mut Said) {
        for (what, rows, instead) in [
            ("headings", self.headings, "they follow from how the road user moved"),
            ("speeds", self.speeds, "they follow from how far the road user moved"),
            ("lengths", self.lengths, "they are those of SUMO's classes"),
            ("widths", self.widths, "they are those of SUMO's classes"),
            ("classes", self.classes, "they are cars"),
        ] {
            if rows > 0 {
                let have = if rows == 1 { "row has" } else { "rows have" };
                let said = if rows == self.rows { &mut said.missing } else { &mut said.doubtful };
                said.push(format!("{what}: {rows} {have} none, so {instead}"));
            }
        }
        let quoted = |names: &[String]| names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
        if !self.unknown.is_empty() {
            said.doubtful.push(format!("classes: {} are unknown, so they are cars", quoted(&self.unknown)));
        }
        if self.left_out > 0 {
            let (rows, names) = (self.left_out, quoted(&self.things));
            said.doubtful.push(format!("classes: {names} are not road users, so their rows are left out: {rows}"));
        }
    }
}
