//! How much work each part of the detector had.

/// How much each part of the detector had to do since the run began, and what it could leave out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Work {
    /// Road users, counted in every step.
    pub rows: u64,
    /// Pairs that phase 1 lets through.
    pub pairs: u64,
    /// Pairs left out because they are too far apart to meet before both stand.
    pub areas_apart: u64,
    /// Of the others, left out because both stand.
    pub both_stand: u64,
    /// Left out because one is on a bridge above the other.
    pub other_level: u64,
    /// Left out because both are persons.
    pub both_persons: u64,
    /// Left out because the boxes around both ways do not meet.
    pub paths_apart: u64,
    /// Settled in one dimension.
    pub in_line: u64,
    /// Swept.
    pub swept: u64,
    /// Looked at for a frontal encounter: in one dimension and opposed, or met at such an angle.
    pub frontal: u64,
    /// Met at an angle of a side encounter.
    pub side: u64,
    /// Road users that were still on the path laid before.
    pub known_paths: u64,
}

impl std::ops::AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.rows += other.rows;
        self.pairs += other.pairs;
        self.areas_apart += other.areas_apart;
        self.both_stand += other.both_stand;
        self.other_level += other.other_level;
        self.both_persons += other.both_persons;
        self.paths_apart += other.paths_apart;
        self.in_line += other.in_line;
        self.swept += other.swept;
        self.frontal += other.frontal;
        self.side += other.side;
        self.known_paths += other.known_paths;
    }
}
