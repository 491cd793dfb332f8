//! The tests that a run skipped, how often and why.
//!
//! Skipping them changes no result. Pairs that cannot be encounters by definition (one was not there yet, both stand,
//! both are persons, on different levels) are only counted.

use std::fmt;

use serde::Serialize;

use super::shortcuts::Shortcuts;
use super::work_counts::Work;

/// A kind of test that was skipped.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// The tests.
    pub what: &'static str,
    /// Why the result is the same without them.
    pub why: &'static str,
    /// How many were skipped; none if the whole run did without them.
    pub times: Option<u64>,
}

impl LeftOut {
    /// Tests that the whole run did without.
    pub fn altogether(what: &'static str, why: &'static str) -> Self {
        Self { what, why, times: None }
    }
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { what, why, times } = self;
        match times {
            Some(times) => write!(f, "{what} skipped: {} ({why})", grouped(*times)),
            None => write!(f, "{what} skipped altogether ({why})"),
        }
    }
}

/// A number with commas between its thousands.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let comma = |place: usize| if place > 0 && (digits.len() - place).is_multiple_of(3) { "," } else { "" };
    digits.char_indices().map(|(place, digit)| format!("{}{digit}", comma(place))).collect()
}

/// The tests that the detector skipped while it did this work.
pub(super) fn left_out(work: &Work, shortcuts: Shortcuts) -> Vec<LeftOut> {
    let tests = [
        ("frontal tests", "no opposing paths within reach", work.frontal == 0),
        ("side tests", "no crossing or bending paths within reach", work.side + work.swept == 0),
    ];
    let unneeded = tests.into_iter().filter(|(.., unneeded)| *unneeded && shortcuts.in_line);
    let counted = [
        ("pair tests", "too far apart to meet before both stand", work.areas_apart),
        ("pair tests", "one was not there yet", work.not_there_yet),
        ("pair tests", "both stand", work.both_stand),
        ("pair tests", "on different levels", work.other_level),
        ("pair tests", "both are persons", work.both_persons),
        ("narrow-phase tests", "the boxes around the two paths do not meet", work.paths_apart),
        ("sweeps", "both drive straight ahead in parallel, so one dimension is enough", work.in_line),
        ("lane lookups", "vehicle still on its predicted path", work.known_paths),
        ("crash probabilities", "an upper bound shows that they decide nothing", work.known_chances),
    ];
    let done_without = counted.into_iter().filter(|(_, _, times)| *times > 0);
    let done_without = done_without.map(|(what, why, times)| LeftOut { what, why, times: Some(times) });
    unneeded.map(|(what, why, _)| LeftOut::altogether(what, why)).chain(done_without).collect()
}

#[cfg(test)]
mod tests {
    use crate::detection::detector::left_out::*;

    #[test]
    fn a_skipped_test_is_listed_with_its_number_and_reason() {
        let skipped = |times| LeftOut { what: "lane lookups", why: "vehicle still on its predicted path", times };
        for (times, text) in [(7, "7"), (999, "999"), (1000, "1,000"), (1_234_567, "1,234,567")] {
            let expected = format!("lane lookups skipped: {text} (vehicle still on its predicted path)");
            assert_eq!(skipped(Some(times)).to_string(), expected);
        }
        assert!(skipped(None).to_string().starts_with("lane lookups skipped altogether ("));
    }
}
