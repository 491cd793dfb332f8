//! Counts of the detector's work.

/// Counts since the run began: what each part of the detector did, and what it left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Work {
    /// Road users, summed over the steps.
    pub rows: u64,
    /// Pairs that pass the broad phase.
    pub pairs: u64,
    /// Pairs left out because they are too far apart to meet before both stand.
    pub areas_apart: u64,
    /// Pairs that pass, but are left out because one was not there yet at the moment of the step.
    pub not_there_yet: u64,
    /// Left out because both stand.
    pub both_stand: u64,
    /// Left out because one is on a bridge above the other.
    pub other_level: u64,
    /// Left out because both are persons.
    pub both_persons: u64,
    /// Left out because the boxes around both paths are apart.
    pub paths_apart: u64,
    /// Settled in one dimension.
    pub in_line: u64,
    /// Swept.
    pub swept: u64,
    /// Tested for a frontal encounter: opposed in one dimension, or met at such an angle.
    pub frontal: u64,
    /// Met at an angle of a side encounter.
    pub side: u64,
    /// Road users that were still on the path built before.
    pub known_paths: u64,
    /// Crash probabilities that were not worked out.
    pub known_chances: u64,
    /// Steps in which the areas of all road users were sorted anew, not only those that had changed places.
    pub sorted_anew: u64,
}

impl std::ops::AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.rows += other.rows;
        self.pairs += other.pairs;
        self.areas_apart += other.areas_apart;
        self.not_there_yet += other.not_there_yet;
        self.both_stand += other.both_stand;
        self.other_level += other.other_level;
        self.both_persons += other.both_persons;
        self.paths_apart += other.paths_apart;
        self.in_line += other.in_line;
        self.swept += other.swept;
        self.frontal += other.frontal;
        self.side += other.side;
        self.known_paths += other.known_paths;
        self.known_chances += other.known_chances;
        self.sorted_anew += other.sorted_anew;
    }
}
