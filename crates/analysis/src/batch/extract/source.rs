//! The run that a conflict is cut out of: whether SUMO can run it again, and from when until when.

use serde_json::Value;

use crate::logged::LoggedRun;
use closecall::util::units::{SAME_MOMENT, Second};

/// How long before the conflict a cut-out begins.
const BEFORE: Second = 10.0;
/// How long after it a cut-out ends.
const AFTER: Second = 5.0;

/// Checks that SUMO can run it again; returns its seed.
///
/// # Errors
/// Why not.
pub(crate) fn check_can_be_run(run: &LoggedRun) -> std::result::Result<u32, String> {
    if run.versions.sumo.is_none() {
        return Err(
            "SUMO did not drive what is in this log, and cannot drive it again; closecall clip draws a conflict".into(),
        );
    }
    if run.sumo_words.is_empty() {
        return Err(
            "a script started SUMO, so that its options are not known; the logs of closecall run have them".into()
        );
    }
    if run.summary.steps == 0 {
        return Err("its run was killed, so that it is not known when it began".into());
    }
    let mut files = std::iter::once(&run.scenario).chain(run.inputs.iter().map(|input| &input.path));
    if let Some(gone) = files.find(|path| !path.is_file()) {
        let gone = gone.display();
        return Err(format!("{gone}, which its run read, is gone; a relative path begins where the run was started"));
    }
    let seed = run.seed.as_deref().and_then(|seed| seed.parse().ok());
    seed.ok_or_else(|| "SUMO chose its seed itself (option random), so that it is not known".into())
}

/// When a cut-out begins and ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Period {
    /// The first step.
    pub from: Second,
    /// SUMO's option `end`.
    pub end: Second,
    /// How long nothing is logged from there on, as in the run.
    pub warm_up: Second,
    /// The same from the begin of the run on, such that the log begins at `from`.
    pub warm_up_of_run: Second,
    /// Whether the run began before.
    pub is_within: bool,
}

impl Period {
    /// That of a conflict from `begin` to `end`, with what is before and after it.
    pub fn of(run: &LoggedRun, begin: Second, end: Second) -> Self {
        Self::around(run, [begin, end], [BEFORE, AFTER])
    }

    /// The same, with other times before and after it.
    pub(in crate::batch) fn around(run: &LoggedRun, [begin, end]: [Second; 2], [before, after]: [Second; 2]) -> Self {
        let step = run.step_length.unwrap_or(1.0);
        let counted = run.summary.begin;
        let warm_up = run.options.get("warmup").and_then(Value::as_f64).unwrap_or_default();
        let steps = ((begin - before - counted + SAME_MOMENT) / step).floor();
        let from = milliseconds(counted + steps * step);
        Self {
            from,
            end: milliseconds((end + after).min(run.summary.end) + step),
            warm_up: milliseconds((counted - from).max(0.0)),
            warm_up_of_run: milliseconds(warm_up + (from - counted).max(0.0)),
            is_within: from > counted - warm_up + step / 2.0,
        }
    }
}

/// SUMO's times are milliseconds.
fn milliseconds(time: Second) -> Second {
    (time * 1e3).round() / 1e3
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;

    /// A run of 0.1 s steps.
    fn run(begin: Second, end: Second, warm_up: Second) -> LoggedRun {
        let text = format!(
            "{{\"versions\": {{\"closecall\": \"0\", \"sumo\": \"SUMO\"}}, \"scenario\": \"a.sumocfg\", \"seed\": \"7\",
              \"step_length\": 0.1, \"sumo_words\": [\"-c\", \"a.sumocfg\"], \"inputs\": [], \"complete\": true,
              \"options\": {{\"warmup\": {warm_up}}}, \"summary\": {{\"begin\": {begin}, \"end\": {end}, \"steps\": 1,
              \"conflicts\": [], \"collisions\": 0, \"exposure\":
              {{\"vehicles\": 0, \"persons\": 0, \"vehicle_kilometres\": 0, \"vehicle_hours\": 0}}}}}}"
        );
        LoggedRun::parse(Path::new("run.json"), &text).unwrap()
    }

    #[test]
    fn a_cut_out_begins_10_s_before_and_ends_5_s_after() {
        let long = run(0.0, 100.0, 0.0);
        let found = Period::of(&long, 30.3, 31.7);
        assert_eq!((found.from, found.end, found.warm_up, found.warm_up_of_run), (20.3, 36.8, 0.0, 20.3));
        assert!(found.is_within);
        assert!(!Period::of(&long, 10.0, 11.0).is_within && Period::of(&long, 10.1, 11.0).is_within);
        assert_eq!(Period::of(&long, 96.0, 99.0).end, 100.1);
    }

    #[test]
    fn a_conflict_at_the_end_of_a_warm_up_begins_there_again() {
        let found = Period::of(&run(60.0, 100.0, 50.0), 60.0, 61.0);
        assert_eq!((found.from, found.warm_up, found.warm_up_of_run), (50.0, 10.0, 50.0));
        assert!(found.is_within && !Period::of(&run(60.0, 100.0, 5.0), 60.0, 61.0).is_within);
    }

    #[test]
    fn what_cannot_be_run_again_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let scenario = folder.path().join("a.sumocfg");
        let known = LoggedRun { scenario: scenario.clone(), ..run(0.0, 9.0, 0.0) };
        let said = |run: &LoggedRun| check_can_be_run(run).unwrap_err();
        assert!(said(&known).contains("a.sumocfg, which its run read, is gone"), "{}", said(&known));
        fs::write(&scenario, "<configuration/>").unwrap();
        assert_eq!(check_can_be_run(&known), Ok(7));
        assert!(said(&LoggedRun { seed: None, ..known.clone() }).contains("option random"));
        assert!(said(&LoggedRun { sumo_words: Vec::new(), ..known.clone() }).contains("a script started SUMO"));
        let mut recording = known;
        recording.versions.sumo = None;
        assert!(said(&recording).contains("closecall clip"));
    }
}
