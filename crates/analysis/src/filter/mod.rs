//! Which conflicts count: the same filter in statistics, pictures and the report.

mod named_places;
mod place;

use std::fmt;

use super::logged::{LoggedConflict, LoggedRun};
use crate::{Error, Result};
use closecall::detection::kind::{Kind, Severity};
use closecall::events::{Cause, Manoeuvre};
use closecall::util::units::Second;
use closecall_run::output::summary::{Exposure, SetAside, in_words};

pub use named_places::{NamedPlace, NamedPlaces};
pub use place::Place;

/// Which conflicts count: those that match every part. An empty part matches all.
#[derive(Clone, Debug, Default, PartialEq, clap::Args)]
#[command(next_help_heading = "Filter: which conflicts count (several values: a,b)")]
pub struct ConflictFilter {
    /// Only these kinds.
    #[arg(long = "kind", value_enum, value_name = "KIND", value_delimiter = ',')]
    pub kinds: Vec<Kind>,
    /// Only these severities.
    #[arg(long = "severity", value_enum, value_name = "SEVERITY", value_delimiter = ',')]
    pub severities: Vec<Severity>,
    /// Only these manoeuvres.
    #[arg(long = "manoeuvre", value_enum, value_name = "MANOEUVRE", value_delimiter = ',')]
    pub manoeuvres: Vec<Manoeuvre>,
    /// Only those with one of these causes.
    #[arg(long = "cause", value_enum, value_name = "CAUSE", value_delimiter = ',')]
    pub causes: Vec<Cause>,
    /// Only those with an ego or a foe of one of these vehicle types.
    #[arg(long = "type", value_name = "TYPE", value_delimiter = ',')]
    pub types: Vec<String>,
    /// Only from this time on, in s.
    #[arg(long, value_name = "S", value_parser = time)]
    pub from: Option<Second>,
    /// Only until this time, in s.
    #[arg(long, value_name = "S", value_parser = time)]
    pub to: Option<Second>,
    /// Only here: x,y,radius in m, the id of a junction, edge or lane, or a name of --places; junction:ID, edge:ID and lane:ID
    /// name the part too. May be given several times.
    #[arg(long = "where", value_name = "PLACE")]
    pub places: Vec<Place>,
    /// TOML file of places with names of their own: areas, and groups of edges and junctions (docs/report.md).
    #[arg(long = "places", value_name = "FILE")]
    pub named: Option<NamedPlaces>,
    /// Also artefacts, made by SUMO or a tracker, not traffic.
    #[arg(long)]
    pub artefacts: bool,
}

fn time(text: &str) -> std::result::Result<Second, String> {
    text.parse::<Second>().ok().filter(|time| time.is_finite()).ok_or_else(|| "it must be a time in s".to_owned())
}

/// How many conflicts are not counted, why, and what counts them; none where all are.
pub(crate) fn set_aside_in_words(set_aside: &SetAside) -> Option<String> {
    in_words(set_aside).map(|words| format!("{words} (--artefacts includes them)"))
}

/// Whether one of these matches, or none is set.
fn any<T>(wanted: &[T], is_met: impl Fn(&T) -> bool) -> bool {
    wanted.is_empty() || wanted.iter().any(is_met)
}

impl ConflictFilter {
    /// Checks that the parts do not contradict each other.
    ///
    /// # Errors
    /// [`Error::EmptyPeriod`] if the period ends before it begins.
    pub fn check(&self) -> Result<()> {
        match (self.from, self.to) {
            (Some(from), Some(to)) if from > to => Err(Error::EmptyPeriod(from, to)),
            _ => Ok(()),
        }
    }

    /// Whether a place has a name of its own, and the conflict is there.
    fn is_at(&self, place: &Place, conflict: &LoggedConflict) -> bool {
        let Place::Named { part: None, id } = place else { return false };
        self.named.as_ref().and_then(|named| named.named(id)).is_some_and(|named| named.holds(conflict))
    }

    /// Whether every conflict counts.
    pub fn is_empty(&self) -> bool {
        *self == Self { named: self.named.clone(), ..Self::default() }
    }

    /// Whether a conflict is traffic's, or others count, too: no other is among those that the rest of the filter sees.
    pub fn counts(&self, conflict: &LoggedConflict) -> bool {
        self.artefacts || conflict.artefact.is_empty()
    }

    /// The same; if it does not count, it is added to those set aside.
    pub(crate) fn sets_aside(&self, conflict: &LoggedConflict, set_aside: &mut SetAside) -> bool {
        let counts = self.counts(conflict);
        if !counts {
            *set_aside.entry(conflict.artefact.to_string()).or_default() += 1;
        }
        !counts
    }

    /// Whether a conflict counts.
    pub fn passes(&self, conflict: &LoggedConflict) -> bool {
        let is_of = |known: &str, wanted: &str| known == wanted || known.split('@').next() == Some(wanted);
        let types = [&conflict.ego_type, &conflict.foe_type];
        self.counts(conflict)
            && self.from.is_none_or(|from| conflict.time >= from)
            && self.to.is_none_or(|to| conflict.time <= to)
            && any(&self.kinds, |kind| *kind == conflict.kind)
            && any(&self.severities, |severity| *severity == conflict.severity)
            && any(&self.manoeuvres, |manoeuvre| manoeuvre.name() == conflict.manoeuvre)
            && any(&self.causes, |cause| conflict.cause.split(' ').any(|known| known == cause.name()))
            && any(&self.types, |wanted| types.iter().any(|known| is_of(known, wanted)))
            && any(&self.places, |place| place.holds(conflict) || self.is_at(place, conflict))
    }

    /// The columns that it needs.
    pub fn columns(&self) -> Vec<&'static str> {
        let parts: [(bool, &[&str]); 7] = [
            (!self.artefacts, &["artefact"]),
            (self.has_period(), &["time"]),
            (!self.kinds.is_empty(), &["kind"]),
            (!self.severities.is_empty(), &["severity"]),
            (!self.manoeuvres.is_empty(), &["manoeuvre"]),
            (!self.causes.is_empty(), &["cause"]),
            (!self.types.is_empty(), &["ego_type", "foe_type"]),
        ];
        let of_named: &[&str] = if self.named.is_some() { &["lane", "x", "y"] } else { &[] };
        let places = self.places.iter().flat_map(Place::columns).chain(of_named);
        parts
            .into_iter()
            .filter(|(is_used, _)| *is_used)
            .flat_map(|(_, columns)| columns)
            .chain(places)
            .copied()
            .collect()
    }

    /// Whether it selects a period.
    pub(crate) fn has_period(&self) -> bool {
        self.from.is_some() || self.to.is_some()
    }

    /// Shortens a run to the period. How much of the traffic was in it is not known: only the hours are left.
    pub fn clip(&self, run: &mut LoggedRun) {
        if !self.has_period() {
            return;
        }
        let summary = &mut run.summary;
        let none = -run.step_length.unwrap_or_default();
        summary.begin = self.from.map_or(summary.begin, |from| from.max(summary.begin));
        summary.end = self.to.map_or(summary.end, |to| to.min(summary.end)).max(summary.begin + none);
        summary.exposure = Exposure::default();
        summary.entered.clear();
    }
}

/// As the words of a command line.
impl fmt::Display for ConflictFilter {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let lists = [
            ("kind", self.kinds.iter().map(|one| one.name().to_owned()).collect::<Vec<_>>()),
            ("severity", self.severities.iter().map(|one| one.name().to_owned()).collect()),
            ("manoeuvre", self.manoeuvres.iter().map(|one| one.name().to_owned()).collect()),
            ("cause", self.causes.iter().map(|one| one.name().to_owned()).collect()),
            ("type", self.types.clone()),
        ];
        let lists = lists.into_iter().filter(|(_, values)| !values.is_empty());
        let lists = lists.map(|(name, values)| format!("--{name} {}", values.join(",")));
        let times = [("from", self.from), ("to", self.to)];
        let times = times.into_iter().filter_map(|(name, time)| Some(format!("--{name} {}", time?)));
        let places = self.places.iter().map(|place| format!("--where {place}"));
        let named = self.named.iter().filter(|_| !self.places.is_empty());
        let named = named.map(|named| format!("--places {}", named.path().display()));
        let artefacts = self.artefacts.then(|| "--artefacts".to_owned());
        f.write_str(&lists.chain(times).chain(places).chain(named).chain(artefacts).collect::<Vec<_>>().join(" "))
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;
    use closecall_run::output::sample_conflict::sample;

    #[derive(Parser)]
    struct Words {
        #[command(flatten)]
        filter: ConflictFilter,
    }

    fn filter(words: &str) -> ConflictFilter {
        Words::try_parse_from(["closecall"].into_iter().chain(words.split_whitespace())).unwrap().filter
    }

    /// A critical side conflict of a car with a bus at 30 s, in the junction B1 at (10, 20).
    fn conflict() -> LoggedConflict {
        sample(&[
            ("severity", "critical"),
            ("manoeuvre", "crossing"),
            ("cause", "ran_red too_fast"),
            ("ego_type", "car@a.1"),
            ("foe_type", "bus"),
            ("lane", ":B1_4_0"),
            ("time", "30"),
            ("x", "10"),
            ("y", "20"),
        ])
        .unwrap()
    }

    #[test]
    fn each_part_has_to_be_met() {
        let conflict = conflict();
        for (words, passes) in [
            ("", true),
            ("--kind side,frontal", true),
            ("--kind rear_end", false),
            ("--severity critical", true),
            ("--severity caution --severity serious", false),
            ("--manoeuvre crossing,merge", true),
            ("--manoeuvre merge", false),
            ("--cause too_fast", true),
            ("--cause did_not_yield", false),
            ("--type bus", true),
            ("--type car", true),
            ("--type ca", false),
            ("--from 30 --to 30", true),
            ("--from 30.1", false),
            ("--to 29.9", false),
            ("--where B1", true),
            ("--where junction:B1", true),
            ("--where edge:B1", false),
            ("--where lane::B1_4_0", true),
            ("--where 13,24,5", true),
            ("--where 13,24,4.9", false),
            ("--where C1 --where B1", true),
            ("--kind side --severity caution", false),
        ] {
            assert_eq!(filter(words).passes(&conflict), passes, "{words}");
        }
    }

    #[test]
    fn a_filter_is_written_as_it_is_read() {
        let words = "--kind side,frontal --severity critical --manoeuvre merge --cause ran_red --type car,bus --from 1.5 \
                     --to 60 --where B1 --where 1,2,3";
        assert_eq!(filter(words).to_string(), words.split_whitespace().collect::<Vec<_>>().join(" "));
        assert!(filter("").is_empty() && !filter("--to 0").is_empty());
    }

    #[test]
    fn a_period_that_ends_before_it_begins_is_refused() {
        let error = filter("--from 60 --to 30").check().unwrap_err().to_string();
        assert!(error.contains("--from 60 is after --to 30"), "{error}");
        assert!(filter("--from 30 --to 30").check().is_ok());
    }
}
