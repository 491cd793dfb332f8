//! What the detector left out, why, and how often.

use super::Detector;
use super::exclusions::LeftOut;

impl Detector {
    /// What this run left out.
    pub fn left_out(&self) -> Vec<LeftOut> {
        let work = self.work();
        let tests = [
            ("frontal", "no opposing ways within reach", work.frontal == 0),
            ("side", "no crossing or bending ways within reach", work.side + work.swept == 0),
        ];
        let unneeded = tests.into_iter().filter(|(.., unneeded)| *unneeded && self.leaves_out().in_line);
        let counted = [
            ("pairs", "too far apart to meet before both stand", work.circles_apart),
            ("pairs", "both stand", work.both_stand),
            ("pairs", "more than 2.5 m apart in height", work.other_level),
            ("pairs", "both are persons", work.both_persons),
            ("accurate tests", "the boxes around both ways do not meet", work.ways_apart),
            ("sweeps", "both drive straight on in parallel: one dimension is enough", work.in_line),
            ("lanes asked for", "still on the path laid before, and nobody's route changes", work.known_paths),
        ];
        let done_without = counted.into_iter().filter(|(_, _, times)| *times > 0);
        let done_without = done_without.map(|(what, why, times)| LeftOut { what, why, times: Some(times) });
        unneeded.map(|(what, why, _)| LeftOut::altogether(what, why)).chain(done_without).collect()
    }
}
