//! The page's first table: for each axis what closecall's choice costs and buys, beside the fastest and the most exact of
//! the others.

use std::fmt::Write;

use super::measurement::{Axis, Measurement};
use closecall_analysis::study::number::number;

/// One line per axis, on the set of items on which closecall's choice errs most.
pub(super) fn table(text: &mut String, rows: &[Measurement]) {
    // Writing to a String does not fail.
    let _ = write!(
        text,
        "\n## In short\n\nFor each choice the items on which closecall errs most, the last of equal ones: its error and its time, \
         beside the fastest of the other methods, and the one with the least error.\n\n\
         | choice | items | error | closecall | fastest other | most exact other |\n|---|---|---|---|---|---|\n"
    );
    for axis in Axis::ALL {
        let defaults = rows.iter().filter(|row| row.axis == axis && row.default);
        let Some(own) = defaults.max_by(|a, b| a.error.total_cmp(&b.error)) else { continue };
        let others = || rows.iter().filter(|row| row.axis == axis && row.scene == own.scene && !row.default);
        let fastest = others().min_by(|a, b| a.ns_per_item.total_cmp(&b.ns_per_item));
        let by_error = |a: &&Measurement, b: &&Measurement| {
            a.error.total_cmp(&b.error).then(a.ns_per_item.total_cmp(&b.ns_per_item))
        };
        let exact = others().min_by(by_error);
        let [fastest, exact] = [fastest, exact].map(|other| other.map_or(String::new(), said));
        let name = axis.name();
        let _ = writeln!(
            text,
            "| [{name}](#{name}) | {} | {} | **{}** | {fastest} | {exact} |",
            own.scene,
            own.error_name,
            said(own)
        );
    }
}

/// A method with its own parameter, its error and its time.
fn said(row: &Measurement) -> String {
    let own = row.parameter.strip_prefix(row.scene.trim_end_matches(", gap")).unwrap_or_default();
    format!("{}{own}: {} in {}", row.method, number(row.error), time(row.ns_per_item))
}

/// A time in ns with a unit that keeps it short.
fn time(ns: f64) -> String {
    match ns {
        _ if ns < 1e3 => format!("{ns:.0} ns"),
        _ if ns < 1e6 => format!("{:.1} µs", ns / 1e3),
        _ if ns < 1e9 => format!("{:.1} ms", ns / 1e6),
        _ => format!("{:.1} s", ns / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_axis_has_a_line_of_its_choice_and_the_best_others() {
        let row = |method, error: f64, ns_per_item: f64, default| Measurement {
            axis: Axis::Late,
            method,
            parameter: "left".to_owned(),
            error_name: "error",
            error,
            false_negative_rate: 0.0,
            false_positive_rate: 0.0,
            ns_per_item,
            items: 1,
            on_pareto_front: false,
            scene: "left".to_owned(),
            default,
        };
        let rows = [row("own", 0.5, 30.0, true), row("fast", 2.0, 10.0, false), row("exact", 0.25, 4e6, false)];
        let mut text = String::new();
        table(&mut text, &rows);
        let line =
            "| [late](#late) | left | error | **own: 0.500 in 30 ns** | fast: 2.00 in 10 ns | exact: 0.250 in 4.0 ms |";
        assert_eq!(text.lines().last(), Some(line));
    }
}
