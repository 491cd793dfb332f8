//! `study.md`: the answer in sentences, then the tables behind it.

use std::fmt::Write;

use super::comparison::{HEADLINE, SHOWN, Study};
use super::estimate::Estimate;
use super::plan::{Axis, Choice, WITHOUT_EFFECT};
use super::recommendation::{Verdict, verdict};
use super::richardson::Convergence;
use crate::study::machine::machine;
use crate::study::number::number;
use closecall_run::util::decimal::Written;

/// The page. Writing to a String does not fail.
pub(super) fn of(study: &Study, scenario: &str, answer: &str, charts: &[&str]) -> String {
    let mut text = format!("# Error against run time: {scenario}\n\n{answer}\n");
    let draw = |text: &mut String, name: &str| {
        if charts.contains(&name) {
            let _ = write!(text, "\n![error over processor time]({name}.svg)\n");
        }
    };
    if study.steps().is_some() {
        text += "\n## The step\n\nRelative errors are against the finest step of the same table, in pairs of runs with the same \
                 seed; their intervals include what the finest step itself may be off by. **Bold**: the recommended step; ●: on the Pareto front of processor time and error in conflicts.\n";
        draw(&mut text, "steps");
        for axis in study.plan.axes.iter().filter(|axis| axis.has_steps()) {
            steps(&mut text, study, axis);
        }
        convergence(&mut text, study);
    }
    if study.plan.axes.iter().any(|axis| !axis.has_steps()) {
        text += "\n## Other choices\n\nDifferences from the present setting, in pairs of runs with the same seed.\n";
        draw(&mut text, "choices");
        choices(&mut text, study);
    }
    if !study.left_out.is_empty() {
        let _ = writeln!(text, "\nLeft out, because a run failed: {}.", study.left_out.join("; "));
    }
    let _ = write!(
        text,
        "\n## How it was measured\n\nSeeds {}; brackets are 95 % intervals over seeds. Times are means per run, of processes \
         with one thread that ran side by side on: {}. [study.csv](study.csv) has every measure.\n",
        study.seeds,
        machine()
    );
    text
}

/// The answer: the step that the scenario needs and what it costs; the present setting; what should not matter.
pub(super) fn answer(study: &Study) -> String {
    let place = study.place(HEADLINE);
    let mut sentences = Vec::new();
    let found = |setting: usize| study.estimate(setting, place).map_or("–".to_owned(), |estimate| shown(&estimate));
    if let Some(axis) = study.steps() {
        sentences.extend(needed(study, axis));
        let own = axis.choices.iter().position(|choice| choice.setting == 0).unwrap_or_default();
        let error = study.errors(axis, place)[own].filter(|_| own > 0);
        let against = error.map_or(String::new(), |error| {
            format!(", {} against steps of {} s", signed(&error), axis.choices[0].value)
        });
        sentences.push(format!(
            "At the present setting (steps of {} s) a run finds {} conflicts per vehicle-hour{against}.",
            Written(study.plan.own_step),
            found(0)
        ));
    } else {
        sentences.push(format!("At the present setting a run finds {} conflicts per vehicle-hour.", found(0)));
    }
    for axis in study.plan.axes.iter().filter(|axis| WITHOUT_EFFECT.contains(&axis.name.as_str())) {
        for choice in &axis.choices[1..] {
            let is_same = (0..study.measures.len())
                .all(|measure| study.estimate(choice.setting, measure) == study.estimate(0, measure));
            let name = axis.name.trim_start_matches("sumo:");
            let value = &choice.value;
            sentences.push(match is_same {
                true => format!("{name}={value} changes nothing, as it should."),
                false => format!("{name}={value} changes the result, which it should not."),
            });
        }
    }
    sentences.join("\n")
}

/// Which step is needed, and what it costs.
fn needed(study: &Study, axis: &Axis) -> Vec<String> {
    let place = study.place(HEADLINE);
    let errors = study.errors(axis, place);
    let finest = &axis.choices[0];
    if study.estimate(finest.setting, place).is_none_or(|estimate| estimate.value == 0.0) {
        return vec![format!("Steps of {} s give no conflict, so no error can be stated.", finest.value)];
    }
    let at = study.recommended(axis, place);
    let chosen = &axis.choices[at];
    let accuracy = Written(100.0 * study.accuracy);
    let times = |choice: &Choice| study.run_time(choice.setting).cpu / study.run_time(0).cpu;
    let costs = match chosen.setting {
        0 => "which is the present setting".to_owned(),
        setting => format!(
            "which costs {} s of processor time per run, {} times that of the present setting",
            number(study.run_time(setting).cpu),
            number(times(chosen))
        ),
    };
    let next = axis.choices.get(at + 1).zip(errors.get(at + 1).copied().flatten());
    let coarser = next.map(|(choice, error)| {
        let may = if verdict(&error, study.accuracy) == Verdict::Refuted {
            ""
        } else {
            "; more seeds could show it to be enough"
        };
        format!("the next, {} s, differs from {} s by {}{may}", choice.value, finest.value, signed(&error))
    });
    let mut sentences = Vec::new();
    let how = match errors[at] {
        Some(error) if at > 0 => {
            let shown = match verdict(&error, study.accuracy) {
                Verdict::Shown => "",
                _ => ", which these seeds make likely, but do not show",
            };
            format!("it differs from {} s by {}{shown}", finest.value, signed(&error))
        }
        _ => "no coarser step has it".to_owned(),
    };
    let why = [Some(how), coarser].into_iter().flatten().collect::<Vec<_>>().join("; ");
    sentences.push(format!(
        "For {accuracy} % in conflicts per vehicle-hour this scenario needs steps of {} s, {costs}: {why}.",
        chosen.value
    ));
    sentences.extend(left_at_the_finest(study, axis));
    let serious = study.place(SHOWN[1]);
    let count = study.estimate(finest.setting, serious).map_or(0.0, |estimate| estimate.value);
    let for_serious = study.recommended(axis, serious);
    if count > 0.0 && for_serious < at {
        let value = &axis.choices[for_serious].value;
        sentences.push(format!("For {accuracy} % in serious and critical conflicts it needs steps of {value} s."));
    }
    sentences
}

/// What the finest step itself is off by, if the steps have an order, or that nothing tells where it matters.
fn left_at_the_finest(study: &Study, axis: &Axis) -> Option<String> {
    let place = study.place(HEADLINE);
    let finest = &axis.choices[0];
    let convergence = study.convergence(axis, place);
    let value = &finest.value;
    let own = study.own_error(axis, place)?;
    let enough = if own > study.accuracy { "; finer steps are needed to be sure" } else { "" };
    let Convergence::Order { order, limit, half_width } = convergence else {
        return Some(format!(
            "These runs show no order of convergence ({}); by three times what its neighbours differ from it, {value} s itself \
             may be off by {:.0} %, which the intervals include{enough}.",
            convergence.why_none().trim_start_matches("none: "),
            100.0 * own
        ));
    };
    let found = study.estimate(finest.setting, place)?.value;
    Some(format!(
        "Extrapolated to a step of 0 with the observed order {} it is {} ± {} conflicts per vehicle-hour, against which {value} s \
         itself is off by {}; the intervals include this{enough}.",
        number(order),
        number(limit),
        number(half_width),
        per_cent(found / limit - 1.0)
    ))
}

fn steps(text: &mut String, study: &Study, axis: &Axis) {
    let with = axis.name.split_once(", ").map_or("the present integration", |(_, with)| with);
    let _ = write!(text, "\nSteps with {with}:\n\n| step, s |{TABLE}");
    let place = study.place(HEADLINE);
    let (front, recommended) = (study.front(axis, place), study.recommended(axis, place));
    for (at, choice) in axis.choices.iter().enumerate() {
        let own = if choice.setting == 0 { " (present)" } else { "" };
        let value =
            if at == recommended { format!("**{}**{own}", choice.value) } else { format!("{}{own}", choice.value) };
        let dot = if front[at] { "●" } else { "" };
        let _ = writeln!(text, "| {value} |{} {dot} |", figures(study, choice, axis.choices[0].setting, Some(axis)));
    }
    let own = study.plan.axes[0].choices[0].setting;
    if let Some(error) = study.error(axis.choices[0].setting, own, place).filter(|_| axis.choices[0].setting != own) {
        let _ = writeln!(
            text,
            "\nAt {} s this differs from the present integration by {} in conflicts per vehicle-hour.",
            axis.choices[0].value,
            signed(&error)
        );
    }
}

/// The head of a table of settings, after its first column.
const TABLE: &str = " conflicts per run | per vehicle-hour | error | serious or critical per vehicle-hour | error | risk \
                     index per vehicle-km | error | time, s | processor time, s | |\n|---|---|---|---|---|---|---|---|---|---|---|\n";

/// The cells of a setting in such a table; on an axis of steps their errors include what the finest may be off by.
fn figures(study: &Study, choice: &Choice, reference: usize, steps: Option<&Axis>) -> String {
    let cell = |estimate: Option<Estimate>| estimate.map_or("–".to_owned(), |estimate| shown(&estimate));
    let mut text = format!(" {} |", cell(study.estimate(choice.setting, study.place("conflicts"))));
    for measure in SHOWN.map(|measure| study.place(measure)) {
        let own = steps.and_then(|axis| study.own_error(axis, measure)).unwrap_or_default();
        let error = study.error(choice.setting, reference, measure).filter(|_| choice.setting != reference);
        let error = error.map(|error| error.widened(own)).map_or("–".to_owned(), |error| signed(&error));
        let _ = write!(text, " {} | {error} |", cell(study.estimate(choice.setting, measure)));
    }
    let time = study.run_time(choice.setting);
    let _ = write!(text, " {} | {} |", number(time.wall), number(time.cpu));
    text
}

/// The order, the limit and the step needed, for every measure that some step has.
fn convergence(text: &mut String, study: &Study) {
    for axis in study.plan.axes.iter().filter(|axis| axis.has_steps()) {
        let with = axis.name.split_once(", ").map_or("the present integration", |(_, with)| with);
        let _ = write!(
            text,
            "\nEach measure with {with}, at the finest step ({} s), at the coarsest ({} s), and extrapolated to 0:\n\n\
             | measure | finest | coarsest | order | extrapolated | step for {} % |\n|---|---|---|---|---|---|\n",
            axis.choices[0].value,
            axis.choices[axis.choices.len() - 1].value,
            Written(100.0 * study.accuracy)
        );
        for (place, measure) in study.measures.iter().enumerate().filter(|(_, measure)| !measure.has_rate()) {
            let [finest, .., coarsest] = &axis.choices[..] else { continue };
            let both = [finest, coarsest].map(|choice| study.estimate(choice.setting, place));
            let [Some(finest), Some(coarsest)] = both else { continue };
            if finest.value == 0.0 {
                continue;
            }
            let (order, limit) = match study.convergence(axis, place) {
                Convergence::Order { order, limit, half_width } => {
                    (number(order), format!("{} ± {}", number(limit), number(half_width)))
                }
                none => (none.why_none().to_owned(), "–".to_owned()),
            };
            let _ = writeln!(
                text,
                "| `{}` | {} | {} | {order} | {limit} | {} |",
                measure.name,
                shown(&finest),
                shown(&coarsest),
                axis.choices[study.recommended(axis, place)].value
            );
        }
    }
}

fn choices(text: &mut String, study: &Study) {
    let _ = write!(text, "\n| choice |{TABLE}");
    let own = Choice { value: String::new(), setting: 0, step: None };
    let _ = writeln!(text, "| present setting |{} |", figures(study, &own, 0, None));
    for axis in study.plan.axes.iter().filter(|axis| !axis.has_steps()) {
        for choice in &axis.choices[1..] {
            let name = axis.name.trim_start_matches("sumo:");
            let _ = writeln!(text, "| {name}={} |{} |", choice.value, figures(study, choice, 0, None));
        }
    }
}

/// A value with its interval.
fn shown(estimate: &Estimate) -> String {
    let interval = estimate.interval.map(|[low, high]| format!(" [{}, {}]", number(low), number(high)));
    format!("{}{}", number(estimate.value), interval.unwrap_or_default())
}

/// A relative error with its interval, in per cent.
fn signed(error: &Estimate) -> String {
    if error.value == 0.0 && error.interval.is_none_or(|ends| ends == [0.0; 2]) {
        return "0".to_owned();
    }
    let interval = error.interval.map(|[low, high]| format!(" [{}, {}]", per_cent(low), per_cent(high)));
    format!("{}{}", per_cent(error.value), interval.unwrap_or_default())
}

/// To one digit after the point below 10 %.
fn per_cent(share: f64) -> String {
    let value = 100.0 * share;
    let digits = usize::from(value.abs() < 9.95);
    format!("{value:+.digits$} %").replace('-', "−")
}
