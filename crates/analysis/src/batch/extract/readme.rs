//! What a cut-out says about itself: a README, and a test for pytest.

use serde_json::Value;

use crate::logged::LoggedConflict;
use closecall::util::units::Second;
use closecall_run::util::decimal::Written;

/// What the words are about.
pub struct Readme<'a> {
    /// The conflict.
    pub conflict: &'a LoggedConflict,
    /// The name of the scenario that it was found in.
    pub scenario: String,
    /// SUMO's version then.
    pub sumo: &'a str,
    /// When the scenario begins with a state of SUMO; none where it begins as the run did.
    pub from: Option<Second>,
    /// When it ends.
    pub until: Second,
}

impl Readme<'_> {
    /// A few lines for a reader.
    pub(crate) fn readme(&self) -> String {
        let LoggedConflict { id, margin, .. } = self.conflict;
        let Self { scenario, sumo, .. } = self;
        let begins = self.from.map_or_else(
            || "begins where the run did".to_owned(),
            |from| format!("begins at {} s, from a state that SUMO saved", Written(from)),
        );
        format!(
            "# Conflict {id} of {scenario}\n\n\
             {}, with a margin of {margin} m, in a run of {sumo}.\n\
             `conflict.sumocfg` {begins}, and ends at {} s; its net is the whole one. Other versions of SUMO may drive otherwise.\n\
             `closecall run conflict.sumocfg --config closecall.toml` finds it again; `--gui` shows it in sumo-gui.\n\
             `pytest` runs `test_conflict.py`, which fails when kind or margin change; `closecall regress .` compares all conflicts \
             with those in `expected/`.\n",
            self.what(),
            Written(self.until)
        )
    }

    /// A test that the conflict is still there.
    pub fn test(&self, configuration: &str) -> String {
        let LoggedConflict { ego, foe, kind, time, margin, .. } = self.conflict;
        let [ego, foe] = [ego, foe].map(|id| Value::from(id.as_str()));
        let kind = kind.name();
        format!(
            "\"\"\"A conflict that closecall extract has cut out.\"\"\"\n\n\
             import pytest\n\n\
             EGO, FOE, TIME = {ego}, {foe}, {time:?}\n\n\n\
             def test_the_conflict_is_still_there(closecall_scenario):\n    \
                 run = closecall_scenario(\"{configuration}\")\n    \
                 logged = run.conflicts + run.set_aside\n    \
                 pair = [conflict for conflict in logged if (conflict.ego, conflict.foe) == (EGO, FOE)]\n    \
                 found = [(conflict.kind, conflict.margin) for conflict in pair if abs(conflict.time - TIME) < 1e-3]\n    \
                 assert found == [(\"{kind}\", pytest.approx({margin:?}, abs=1e-6))]\n"
        )
    }

    fn what(&self) -> String {
        let LoggedConflict { ego, foe, kind, severity, time, .. } = self.conflict;
        let kind = kind.name().replace('_', "-");
        format!("A {kind} conflict, {}, of `{ego}` with `{foe}` at {} s", severity.name(), Written(*time))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use closecall_run::output::sample_conflict::sample;

    /// A critical side conflict of a with b at 30 s.
    fn conflict() -> LoggedConflict {
        sample(&[("ego", "a\"\\"), ("foe", "b"), ("severity", "critical"), ("time", "30"), ("margin", "-2.5")]).unwrap()
    }

    #[test]
    fn the_test_names_the_pair_as_python_does() {
        let conflict = conflict();
        let scenario = "town".to_owned();
        let words = Readme { conflict: &conflict, scenario, sumo: "SUMO 1.28.0", from: Some(19.5), until: 36.0 };
        let test = words.test("c.sumocfg");
        assert!(test.contains("EGO, FOE, TIME = \"a\\\"\\\\\", \"b\", 30.0\n"), "{test}");
        assert!(test.contains("    assert found == [(\"side\", pytest.approx(-2.5, abs=1e-6))]\n"), "{test}");
        let readme = words.readme();
        assert!(readme.contains("begins at 19.5 s") && readme.contains("A side conflict, critical, of"), "{readme}");
    }
}
