//! The overlaps of a run, and how many of them SUMO counts as collisions, in a sentence.

use closecall::events::{Artefact, Conflict};
use closecall::traffic::profile::Category;
use closecall::traffic::roster::Roster;

use serde::{Deserialize, Serialize};

/// The collisions that SUMO itself reported.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SumoCollisions {
    /// The pairs that SUMO reported.
    pub reported: u64,
    /// The conflicts whose pair SUMO reported while they were open.
    pub in_conflict: u64,
}

/// What the rectangles that overlapped have in common.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Overlaps {
    /// Those that count.
    pub all: u64,
    /// Those of them with a person.
    pub with_persons: u64,
    /// Those of them that SUMO reported.
    pub in_sumo: u64,
    /// Those that are set aside because lanes overlap only as drawn.
    pub drawn: u64,
}

impl Overlaps {
    /// Counts a conflict that counts, or is set aside.
    pub(super) fn add(&mut self, conflict: &Conflict, is_set_aside: bool, roster: &Roster) {
        if !conflict.collision {
            return;
        }
        if is_set_aside {
            self.drawn += u64::from(conflict.artefact == Some(Artefact::DrawnOverlap));
            return;
        }
        let is_person = |profile| roster.profile_at(profile).category == Category::Person;
        self.all += 1;
        self.with_persons += u64::from(is_person(conflict.ego_profile) || is_person(conflict.foe_profile));
        self.in_sumo += u64::from(conflict.collision_sumo == Some(true));
    }

    /// The sentence; `sumo` is what SUMO itself reported, where it was asked.
    pub(super) fn in_words(self, sumo: Option<SumoCollisions>) -> String {
        let Self { all, with_persons, drawn, .. } = self;
        let mut words = match all {
            0 => "no overlap".to_owned(),
            1 => "1 overlap".to_owned(),
            _ => format!("{all} overlaps"),
        };
        words += &match with_persons {
            0 => String::new(),
            1 if all == 1 => ", with a person".to_owned(),
            _ if with_persons == all => ", all with persons".to_owned(),
            _ => format!(", {with_persons} of them with persons"),
        };
        if drawn > 0 {
            words += &format!(" (and {drawn} only as drawn, set aside)");
        }
        words + &sumo.map(|sumo| format!("; {}", self.beside(sumo))).unwrap_or_default()
    }

    /// What SUMO counts, beside these.
    fn beside(self, sumo: SumoCollisions) -> String {
        let SumoCollisions { reported, in_conflict } = sumo;
        let why = "(docs/log.md says why)";
        match reported {
            0 if self.all == 0 => "SUMO counts none either".to_owned(),
            0 => format!("SUMO counts none {why}"),
            _ if in_conflict == 0 => format!("SUMO counts {reported}, elsewhere {why}"),
            _ if self.all == reported && self.in_sumo == reported => "SUMO counts the same".to_owned(),
            _ if self.in_sumo == reported => format!("SUMO counts {reported} of them {why}"),
            _ => format!("SUMO counts {reported}, of which conflicts have {in_conflict} {why}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(overlaps: [u64; 4], sumo: Option<[u64; 2]>) -> String {
        let [all, with_persons, in_sumo, drawn] = overlaps;
        let sumo = sumo.map(|[reported, in_conflict]| SumoCollisions { reported, in_conflict });
        Overlaps { all, with_persons, in_sumo, drawn }.in_words(sumo)
    }

    #[test]
    fn the_sentence_says_who_overlaps_and_what_sumo_counts() {
        for (overlaps, sumo, words) in [
            ([0, 0, 0, 0], None, "no overlap"),
            ([0, 0, 0, 0], Some([0, 0]), "no overlap; SUMO counts none either"),
            ([1, 1, 0, 0], Some([0, 0]), "1 overlap, with a person; SUMO counts none (docs/log.md says why)"),
            ([2, 0, 2, 0], Some([2, 2]), "2 overlaps; SUMO counts the same"),
            (
                [3, 1, 2, 0],
                Some([2, 2]),
                "3 overlaps, 1 of them with persons; SUMO counts 2 of them (docs/log.md says why)",
            ),
            (
                [10, 10, 0, 0],
                Some([1, 0]),
                "10 overlaps, all with persons; SUMO counts 1, elsewhere (docs/log.md says why)",
            ),
            ([0, 0, 0, 4], None, "no overlap (and 4 only as drawn, set aside)"),
            ([2, 0, 1, 0], Some([3, 2]), "2 overlaps; SUMO counts 3, of which conflicts have 2 (docs/log.md says why)"),
        ] {
            assert_eq!(said(overlaps, sumo), words);
        }
    }
}
