//! What each measure that is logged only if chosen costs, and how far a recording with two decimals changes it.

use std::fs;

use ecow::EcoString;
use rustc_hash::FxHashMap;

use super::clock::median;
use super::measurement::{Axis, Measurement, Plan, Recorder};
use super::recorded::{RecordedScenario, measure_each, with_decimals};
use closecall::events::Conflict;
use closecall::options::Options;
use closecall::options::measures::{ChosenMeasure, Measures};
use closecall_run::{Error, Result};

/// A quick study uses the first.
const NETS: [&str; 3] = ["left_turn", "roundabout", "signals"];
/// SUMO's default precision.
const DECIMALS: usize = 2;
/// Differences that are smaller, relative to the value, are rounding.
const ROUNDING: f64 = 1e-6;

/// What is logged besides the default measures.
#[derive(Clone, Copy, PartialEq)]
enum Method {
    Nothing,
    One(ChosenMeasure),
    All,
}

impl Method {
    fn measures(self) -> Measures {
        match self {
            Self::Nothing => Measures::default(),
            Self::One(measure) => measure.into(),
            Self::All => Measures::ALL,
        }
    }

    /// Measures of a kind have a colour in common.
    fn name(self) -> &'static str {
        use ChosenMeasure::{
            Br, ConflictingSpeed, Cpi, CrashIndex, DeltaS, Dr, MaxD, MaxS, Mdrac, Mttc, RssDistance,
            RssLateralDistance, RssViolation, Sgap, T2, Ta, TaLevel, Tadv, Tet, Thw, Tit,
        };
        match self {
            Self::Nothing => "none added (its TTC)",
            Self::All => "all",
            Self::One(Tadv | T2) => "time advantage",
            Self::One(RssDistance | RssLateralDistance | RssViolation) => "RSS",
            Self::One(Thw | Sgap | MaxS | DeltaS | Ta | ConflictingSpeed | TaLevel) => "gaps and speeds",
            Self::One(Br | Mdrac | Mttc | CrashIndex | Dr | MaxD) => "accelerations",
            Self::One(Tet | Tit | Cpi) => "exposure, potential",
            Self::One(_) => "threat, emergency",
        }
    }

    fn parameter(self) -> String {
        if let Self::One(measure) = self { format!(", {}", measure.name()) } else { String::new() }
    }

    /// The value of a conflict that is compared.
    fn value(self, conflict: &Conflict) -> Option<f64> {
        if let Self::One(measure) = self { conflict.chosen(measure) } else { conflict.values.ttc() }
    }
}

pub(super) fn measure(plan: &Plan, record: &mut Recorder) -> Result<Vec<Measurement>> {
    let (nets, end, rounds) = if plan.quick { (&NETS[..1], 100.0, 3) } else { (&NETS[..], 300.0, 9) };
    measure_each(plan, nets, end, record, |scenario, _| measure_net(&scenario, rounds))
}

fn measure_net(scenario: &RecordedScenario, rounds: usize) -> Result<Vec<Measurement>> {
    let exact = &scenario.recording;
    let rounded = exact.with_extension("rounded.fcd.xml");
    let text = fs::read_to_string(exact).map_err(|source| Error::file(exact, source))?;
    fs::write(&rounded, with_decimals(&text, DECIMALS)).map_err(|source| Error::file(&rounded, source))?;
    let each = ChosenMeasure::ALL.map(Method::One);
    let methods = [Method::Nothing].into_iter().chain(each).chain([Method::All]).collect::<Vec<_>>();
    let mut times = vec![Vec::new(); methods.len()];
    let mut items = 0;
    for _ in 0..rounds {
        for (method, times) in methods.iter().zip(&mut times) {
            let options = Options { measures: method.measures(), ..Options::default() };
            let timed = scenario.replay(exact, &options, &mut |_| {})?;
            items = timed.rows;
            times.push(timed.lasts * 1e9 / items.max(1) as f64);
        }
    }
    let all = Options { measures: Measures::ALL, ..Options::default() };
    let [truth, found] = [exact, &rounded].map(|file| scenario.replay(file, &all, &mut |_| {}));
    let [truth, found] = [truth?.conflicts, found?.conflicts];
    let errors = methods.iter().map(|method| Off::of(*method, &truth, &found)).collect::<Vec<_>>();
    let largest = errors.iter().map(|off| off.error).fold(0.0, f64::max);
    let row = |((method, off), times): ((&Method, &Off), &mut Vec<f64>)| Measurement {
        axis: Axis::Measures,
        method: method.name(),
        parameter: format!("{}{}", scenario.name, method.parameter()),
        error_name: "median relative error with two decimals",
        error: if *method == Method::All { largest } else { off.error },
        false_negative_rate: off.missed,
        false_positive_rate: off.invented,
        ns_per_item: median(times),
        items,
        on_pareto_front: false,
        scene: scenario.name.to_owned(),
        default: *method == Method::Nothing,
    };
    Ok(methods.iter().zip(&errors).zip(&mut times).map(row).collect())
}

/// How far the values of a measure differ.
struct Off {
    error: f64,
    /// Shares of the pairs that have a value in one of both recordings only.
    missed: f64,
    invented: f64,
}

impl Off {
    fn of(method: Method, truth: &[Conflict], found: &[Conflict]) -> Self {
        let [truth, found] = [truth, found].map(|conflicts| values(method, conflicts));
        let both = truth.iter().filter_map(|(pair, truth)| Some((truth, found.get(pair)?)));
        let off = both.map(|(truth, found)| match (truth - found).abs() {
            off if off <= ROUNDING * truth.abs() => 0.0,
            off => off / truth.abs().max(found.abs()),
        });
        let mut off = off.collect::<Vec<_>>();
        let without = |these: &Values, others: &Values| {
            these.keys().filter(|pair| !others.contains_key(*pair)).count() as f64 / these.len().max(1) as f64
        };
        let [missed, invented] = [without(&truth, &found), without(&found, &truth)];
        Self { error: if off.is_empty() { 0.0 } else { median(&mut off) }, missed, invented }
    }
}

type Values = FxHashMap<[EcoString; 2], f64>;

/// The value of each pair's first conflict.
fn values(method: Method, conflicts: &[Conflict]) -> Values {
    let mut values = Values::default();
    for conflict in conflicts {
        if let Some(value) = method.value(conflict) {
            values.entry([conflict.ego.clone(), conflict.foe.clone()]).or_insert(value);
        }
    }
    values
}
