//! What is logged: a condition over the measures of a pair in a step, such as `ttc < 3 or drac > 3 or pet < 2`.
//!
//! Comparisons of a measure with a number are joined by `and` and `or`, with parentheses; `and` binds closer. A measure
//! that a pair lacks in a step meets no comparison. The PET is known only at the end of an event, so a step is given the
//! value that the PET has to be below for the step to meet the condition.

mod comparison;
mod look_ahead;
mod measure;
mod parse;
mod tree;

use std::fmt;
use std::str::FromStr;

use serde::{Serialize, Serializer};

use crate::util::units::Second;
use comparison::Comparison;
use parse::Parser;
use tree::Tree;

pub use look_ahead::LookAhead;
use look_ahead::USUAL_PET;
pub use measure::Measure;

/// Names of conditions: FHWA's SSAM (Gettman et al. 2008), SUMO's device.ssm, and the paper's.
const PRESETS: [(&str, &str); 3] =
    [("paper", "margin < 0"), ("ssam", "ttc <= 1.5 or pet <= 5"), ("ssm", "ttc < 3 or drac > 3 or pet < 2")];

/// A condition that a pair meets in a step, or does not.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    tree: Tree,
    look_ahead: LookAhead,
    is_default: bool,
}

impl Condition {
    /// The PET that an event has to be below so that a step with these measures meets the condition: infinite where the
    /// step meets it whatever the PET is, or without one; minus infinite where it meets it with none.
    pub fn pet_below(&self, measure: &impl Fn(Measure) -> Option<f64>, may_have_pet: bool) -> Second {
        self.tree.pet_below(measure, may_have_pet)
    }

    /// How far beyond where both stand pairs have to be looked for.
    pub fn look_ahead(&self) -> LookAhead {
        self.look_ahead
    }

    /// Whether it is `margin < 0`.
    pub fn is_default(&self) -> bool {
        self.is_default
    }

    /// Whether it asks for the PET.
    pub(crate) fn needs_pet(&self) -> bool {
        self.tree.needs_pet()
    }

    /// The longest PET that is looked for: 5 s, or the condition's own.
    pub(crate) fn longest_pet(&self) -> Second {
        self.tree.longest_pet().max(USUAL_PET)
    }

    fn new(tree: Tree) -> Result<Self, String> {
        let look_ahead = tree.look_ahead()?;
        let is_default = tree == Tree::Compare(Comparison::MARGIN);
        Ok(Self { tree, look_ahead, is_default })
    }
}

impl Default for Condition {
    fn default() -> Self {
        Self { tree: Tree::Compare(Comparison::MARGIN), look_ahead: LookAhead::NONE, is_default: true }
    }
}

impl FromStr for Condition {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let preset = PRESETS.iter().find(|(name, _)| *name == text.trim());
        let tree = Parser::new(preset.map_or(text, |(_, condition)| condition)).tree();
        tree.and_then(Self::new)
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.tree.fmt(f)
    }
}

impl Serialize for Condition {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn condition(text: &str) -> Condition {
        text.parse().unwrap()
    }

    /// The bound of the PET in a step with these measures.
    fn pet_below(text: &str, measures: &[(Measure, f64)]) -> Second {
        let value = |of: Measure| measures.iter().find(|(measure, _)| *measure == of).map(|(_, value)| *value);
        condition(text).pet_below(&value, true)
    }

    #[test]
    fn comparisons_are_joined_as_usual() {
        let meets = |text: &str, ttc: f64, drac: f64| {
            pet_below(text, &[(Measure::Ttc, ttc), (Measure::Drac, drac)]) == Second::INFINITY
        };
        for (text, [low, high_drac, high_ttc, none]) in [
            ("ttc < 3 or drac > 3", [true, true, true, false]),
            ("ttc < 3 and drac > 3", [false, true, false, false]),
            ("ttc<=3 and (drac>=3 or ttc<1)", [true, true, false, false]),
            ("ttc < 1 or ttc < 3 and drac > 3", [true, true, false, false]),
        ] {
            let found = [(0.5, 1.0), (2.0, 4.0), (5.0, 4.0), (5.0, 1.0)].map(|(ttc, drac)| meets(text, ttc, drac));
            assert_eq!(found, [low, high_drac, high_ttc, none], "{text}");
        }
    }

    #[test]
    fn a_measure_that_is_missing_meets_nothing() {
        assert_eq!(pet_below("ttc < 3", &[]), Second::NEG_INFINITY);
        assert_eq!(pet_below("ttc < 3 or margin < 0", &[(Measure::Margin, -1.0)]), Second::INFINITY);
    }

    #[test]
    fn the_pet_that_a_step_still_needs_is_told() {
        for (text, ttc, expected) in [
            ("pet < 2 or ttc < 1", 0.5, Second::INFINITY),
            ("pet < 2 or ttc < 1", 5.0, 2.0),
            ("pet <= 2", 5.0, 2.0_f64.next_up()),
            ("pet < 2 and ttc < 1", 5.0, Second::NEG_INFINITY),
            ("pet < 2 and ttc < 1", 0.5, 2.0),
            ("pet < 1 or pet < 4 and ttc < 1", 0.5, 4.0),
        ] {
            assert_eq!(pet_below(text, &[(Measure::Ttc, ttc)]), expected, "{text} {ttc}");
        }
        let follower = condition("pet < 2").pet_below(&|_| None, false);
        assert_eq!(follower, Second::NEG_INFINITY);
    }

    #[test]
    fn a_condition_is_written_as_it_is_read() {
        for text in ["margin < 0", "ttc < 3 or (drac > 3.5 and margin <= -1)", "(ttc < 1 or pet < 2) and angle > 1"] {
            assert_eq!(condition(text).to_string(), text);
        }
        assert_eq!(condition("ssm").to_string(), "ttc < 3 or drac > 3 or pet < 2");
        assert_eq!(condition("ssam").to_string(), "ttc <= 1.5 or pet <= 5");
        assert_eq!(condition("paper"), Condition::default());
        assert_eq!(condition(" ((margin<0.0)) "), Condition::default());
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, said) in [
            ("tcc < 3", "unknown measure \"tcc\"; did you mean \"ttc\"?"),
            ("speed < 3", "unknown measure \"speed\"; did you mean \"ego_speed\"?"),
            ("colour < 3", "unknown measure \"colour\"; known are gap, mu, margin, clearance, ttc, drac"),
            ("ttc = 3", "expected <, <=, > or >= instead of \"= 3\""),
            ("ttc < x", "expected a number instead of \"x\""),
            ("ttc < inf", "expected a number instead of \"inf\""),
            ("ttc < 3 drac > 3", "expected \"and\" or \"or\" instead of \"drac > 3\""),
            ("(ttc < 3", "expected \")\" at the end"),
            ("ttc < 3 or", "expected a measure at the end"),
            ("", "expected a measure at the end"),
            ("3 > ttc", "expected a measure instead of \"3 > ttc\""),
        ] {
            let error = text.parse::<Condition>().unwrap_err();
            assert!(error.starts_with(said), "{text}: {error}");
        }
    }

    #[test]
    fn nesting_without_end_is_refused() {
        let error = "(".repeat(100_000).parse::<Condition>().unwrap_err();
        assert_eq!(error, "parentheses are nested too deeply");
    }

    #[test]
    fn what_holds_however_far_away_is_refused() {
        for text in [
            "ttc > 3",
            "ego_speed < 5",
            "margin < 0 or mu > 4",
            "drac < 2",
            "clearance < 1",
            "overlap >= 0",
            "ttb > 1",
            "crash_probability >= 0",
            "crash_probability_braking > 0.5",
        ] {
            let error = text.parse::<Condition>().unwrap_err();
            assert!(error.contains("however far ahead they meet"), "{text}: {error}");
        }
        assert!("pet > 1".parse::<Condition>().unwrap_err().contains("bounded above"));
        assert!("pet < 61".parse::<Condition>().unwrap_err().contains("60 s"));
        for text in ["ttc > 3 and ttc < 4", "ego_speed < 5 and margin < 0", "overlap > 0 or clearance < 1 and gap < 9"]
        {
            condition(text);
        }
    }

    #[test]
    fn the_longest_pet_is_that_which_is_asked_for() {
        for (text, expected) in [("ttc < 3", 5.0), ("pet < 2", 5.0), ("ttc < 1 or pet <= 10 and ttc < 5", 10.0)] {
            assert_eq!(condition(text).longest_pet(), expected, "{text}");
        }
    }

    #[test]
    fn a_condition_looks_as_far_as_its_parts_need() {
        let look = |text: &str| condition(text).look_ahead();
        assert_eq!(look("margin < 0"), LookAhead::NONE);
        assert_eq!(look("margin < -1 or overlap > 0.5"), LookAhead::NONE);
        assert_eq!(look("ttc < 3 or ttc < 2"), LookAhead { seconds: 3.0, ..LookAhead::NONE });
        assert_eq!(look("ttc < 3 and margin < 0"), LookAhead::NONE);
        assert_eq!(look("gap < 4 or pet <= 2"), LookAhead { metres: 4.0, pet: 2.0, ..LookAhead::NONE });
        assert_eq!(look("response_left < 1.5"), LookAhead { response: 1.5, ..LookAhead::NONE });
        for text in ["drac > 3", "ttb <= 0.5", "crash_probability > 0", "extended_delta_v > 5"] {
            assert_eq!(look(text), LookAhead { seconds: Second::INFINITY, ..LookAhead::NONE }, "{text}");
        }
    }
}
