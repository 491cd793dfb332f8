//! What a recording must hold: how many decimals, in f64 or f32, and how often.

use std::fs;
use std::path::Path;

use rustc_hash::FxHashSet;

use super::clock::median;
use super::measurement::{Axis, Measurement, Plan, Recorder};
use super::recorded::{
    GapsByStep, ROUNDING, RecordedScenario, conflicts, measure_each, share_without, with_decimals, with_numbers,
};
use closecall::options::Options;
use closecall::util::units::{Metre, Second};
use closecall_run::{Error, Result};

/// A quick study uses the first.
const NETS: [&str; 3] = ["left_turn", "roundabout", "signals"];
/// The period of the recordings from which the others are made.
const PERIOD: Second = 0.1;
/// Gaps are compared at these times only, which all recordings have.
const COMPARED: Second = 1.0;
/// What docs/replay.md asks for.
const DEFAULT: Kept = Kept::Decimals(6);
const METHODS: [Kept; 11] = [
    Kept::All,
    Kept::Decimals(1),
    Kept::Decimals(2),
    Kept::Decimals(3),
    Kept::Decimals(4),
    Kept::Decimals(5),
    DEFAULT,
    Kept::F32,
    Kept::Period(0.2),
    Kept::Period(0.5),
    Kept::Period(1.0),
];

/// What is kept of a recording.
#[derive(Clone, Copy, PartialEq)]
enum Kept {
    All,
    Decimals(usize),
    /// 24 bits of every number, as in SSAM's trajectories.
    F32,
    Period(Second),
}

impl Kept {
    fn of(self, text: &str) -> String {
        match self {
            Self::All => text.to_owned(),
            Self::Decimals(count) => with_decimals(text, count),
            Self::F32 => with_numbers(text, &|value| (value as f32).to_string()),
            Self::Period(period) => every(text, period),
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::All => "every 0.1 s, nine decimals",
            Self::Decimals(_) => "fewer decimals",
            Self::F32 => "f32",
            Self::Period(_) => "fewer steps",
        }
    }

    fn parameter(self) -> String {
        match self {
            Self::All | Self::F32 => String::new(),
            Self::Decimals(1) => ", 1 decimal".to_owned(),
            Self::Decimals(count) => format!(", {count} decimals"),
            Self::Period(period) => format!(", every {period} s"),
        }
    }

    fn period(self) -> Second {
        if let Self::Period(period) = self { period } else { PERIOD }
    }
}

/// A recording with this period, in s.
fn every(text: &str, period: Second) -> String {
    let mut is_kept = true;
    let mut kept = String::new();
    for line in text.split_inclusive('\n') {
        let step = line.trim_start().strip_prefix("<timestep time=\"").and_then(|rest| rest.split('"').next());
        if let Some(time) = step.and_then(|time| time.parse::<Second>().ok()) {
            is_kept = is_at(time, period);
        }
        if is_kept {
            kept += line;
        }
        // A step does not contain what follows it.
        is_kept |= line.trim_start().starts_with("</timestep>") || step.is_some() && line.trim_end().ends_with("/>");
    }
    kept
}

fn is_at(time: Second, period: Second) -> bool {
    let steps = time / period;
    (steps - steps.round()).abs() < 1e-6
}

pub(super) fn measure(plan: &Plan, record: &mut Recorder) -> Result<Vec<Measurement>> {
    let (nets, end, rounds) = if plan.quick { (&NETS[..1], 100.0, 3) } else { (&NETS[..], 300.0, 5) };
    measure_each(plan, nets, end, record, |scenario, scratch| measure_net(&scenario, scratch, rounds))
}

fn measure_net(scenario: &RecordedScenario, scratch: &Path, rounds: usize) -> Result<Vec<Measurement>> {
    let text = fs::read_to_string(&scenario.recording).map_err(|source| Error::file(&scenario.recording, source))?;
    let mut files = Vec::new();
    for (index, kept) in METHODS.into_iter().enumerate() {
        let file = scratch.join(format!("{}.{index}.fcd.xml", scenario.name));
        fs::write(&file, kept.of(&text)).map_err(|source| Error::file(&file, source))?;
        files.push(file);
    }
    let mut found = vec![GapsByStep::new(); METHODS.len()];
    let mut pairs = vec![FxHashSet::default(); METHODS.len()];
    let mut times = vec![Vec::new(); METHODS.len()];
    let mut seconds = vec![0.0; METHODS.len()];
    for round in 0..rounds {
        for (index, file) in files.iter().enumerate() {
            let timed = scenario.replay(file, &Options::default(), &mut |run| {
                if round == 0 {
                    let gaps = conflicts(run);
                    pairs[index].extend(gaps.keys().cloned());
                    if is_at(run.frame.time, COMPARED) {
                        found[index].push(gaps);
                    }
                }
            })?;
            seconds[index] = timed.rows as f64 * METHODS[index].period();
            times[index].push(timed.lasts * 1e9 / seconds[index].max(1.0));
        }
    }
    let mut rows = Vec::new();
    for (index, kept) in METHODS.into_iter().enumerate() {
        let [missed, invented] = [share_without(&pairs[0], &pairs[index]), share_without(&pairs[index], &pairs[0])];
        let gap_error = gap_error(&found[index], &found[0]);
        let ns_per_item = median(&mut times[index]);
        let name = scenario.name;
        let errors = [
            ("share of pairs in conflict missed or invented", missed + invented, name.to_owned()),
            ("median error of the gap, m", gap_error, format!("{name}, gap")),
        ];
        rows.extend(errors.map(|(error_name, error, scene)| Measurement {
            axis: Axis::Recording,
            method: kept.name(),
            parameter: format!("{name}{}", kept.parameter()),
            error_name,
            error,
            false_negative_rate: missed,
            false_positive_rate: invented,
            ns_per_item,
            items: seconds[index] as usize,
            on_pareto_front: false,
            scene,
            default: kept == DEFAULT,
        }));
    }
    Ok(rows)
}

/// The median difference of the gaps of pairs that are in conflict in both.
fn gap_error(found: &GapsByStep, truth: &GapsByStep) -> Metre {
    let both = found.iter().zip(truth).flat_map(|(found, truth)| {
        found.iter().filter_map(|(pair, gap)| truth.get(pair).map(|truth| (gap - truth).abs()))
    });
    let mut off = both.map(|off| if off < ROUNDING { 0.0 } else { off }).collect::<Vec<_>>();
    if off.is_empty() { 0.0 } else { median(&mut off) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "<fcd-export>\n    <timestep time=\"0.00\">\n        <vehicle id=\"1.25\" x=\"3.14159\" speed=\"2.71828\"/>\n    \
                        </timestep>\n    <timestep time=\"0.10\"/>\n    <timestep time=\"0.20\">\n    </timestep>\n</fcd-export>\n";

    #[test]
    fn numbers_are_rounded_and_names_are_not() {
        let changed = Kept::Decimals(1).of(TEXT);
        assert!(changed.contains("id=\"1.25\" x=\"3.1\" speed=\"2.7\"/>"), "{changed}");
        assert!(Kept::F32.of(TEXT).contains("x=\"3.14159\""));
    }

    #[test]
    fn a_longer_period_keeps_whole_steps() {
        let kept = Kept::Period(0.2).of(TEXT);
        assert_eq!(kept, TEXT.replace("    <timestep time=\"0.10\"/>\n", ""));
        assert!(Kept::Period(0.5).of(TEXT).ends_with("</timestep>\n</fcd-export>\n"));
    }
}
