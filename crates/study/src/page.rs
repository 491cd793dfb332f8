//! `study.md`: every axis as a table with closecall's choice marked.

use std::fmt::Write;

use super::coverage;
use super::in_short;
use super::measurement::{Axis, Measurement};
use closecall_analysis::study::error_over_time::distinct;
use closecall_analysis::study::machine::machine;
use closecall_analysis::study::number::number;

/// The question of an axis, and the reference of its errors.
fn question(axis: Axis) -> [&'static str; 2] {
    match axis {
        Axis::Volume => ["Do two rectangles touch?", "exact arithmetic on the same f64 inputs"],
        Axis::Candidates => ["Which road users are near each other?", "every pair (from 10⁵ on: the sweep along x)"],
        Axis::Time => ["When do two moving cars first touch?", "separating axes in 300-bit arithmetic"],
        Axis::Braking => ["How much room does the ego need?", "the braking equations solved in 300-bit arithmetic"],
        Axis::Late => ["How long can the driver wait?", "the motion of both solved in 300-bit arithmetic"],
        Axis::Probability => ["How likely is it that the driver brakes too late?", "Simpson's rule with 256 intervals"],
        Axis::RollOuts => ["By the formula, or by roll-outs in SUMO?", "the integral, with the contact tolerance"],
        Axis::Numbers => ["Which type of number, and which origin?", "exact arithmetic on the same f64 inputs"],
        Axis::Turning => ["How exactly is a turn swept?", "both ways halved until nothing between can hide a contact"],
        Axis::Curvature => ["How long a past tells the curvature?", "the way that was driven"],
        Axis::Recording => ["What must be recorded?", "a recording of every 0.1 s with nine decimals"],
        Axis::Tolerance => ["How deep an overlap is a collision?", "the pairs that SUMO reports as colliding"],
        Axis::Measures => ["What do the added measures cost?", "a recording with nine decimals"],
        Axis::Coverage => ["Do intervals hold what they say?", "known processes"],
        Axis::Path => ["Where will a road user go?", "where the recorded vehicles really drove"],
    }
}

pub(super) fn of(rows: &[Measurement], quick: bool) -> String {
    // Writing to a String does not fail.
    let extent = if quick { ", with few items (--quick)" } else { "" };
    let mut text = format!("# Error against run time\n\nMeasured on: {}{extent}.\n", machine());
    in_short::table(&mut text, rows);
    for axis in Axis::ALL {
        let of_axis = rows.iter().filter(|row| row.axis == axis).collect::<Vec<_>>();
        if of_axis.is_empty() {
            continue;
        }
        let [question, reference] = question(axis);
        let name = axis.name();
        if axis == Axis::Coverage {
            let _ = writeln!(
                text,
                "\n## {name}\n\n{question} On {reference}: too low, the whole interval is below the truth, or a test finds nothing."
            );
            coverage::table(&mut text, &of_axis);
            continue;
        }
        let _ = write!(
            text,
            "\n## {name}\n\n{question} Errors against {reference}. **Bold**: closecall's choice; ●: on the Pareto front of \
             its items.\n\n![{name}]({name}.svg)\n\n| items | method | {} | missed | false | ns per item | |\n\
             |---|---|---|---|---|---|---|\n",
            error_names(&of_axis)
        );
        for row in &of_axis {
            let _ = writeln!(text, "{}", line(row));
        }
        if axis == Axis::Candidates {
            growth(&mut text, &of_axis);
        }
        let dominated = of_axis.iter().filter(|row| row.default && !row.on_pareto_front).collect::<Vec<_>>();
        for row in dominated {
            let _ = writeln!(text, "\nclosecall's choice is not on the front of \"{}\".", row.scene);
        }
    }
    text
}

fn error_names(rows: &[&Measurement]) -> String {
    let mut names = rows.iter().map(|row| row.error_name).collect::<Vec<_>>();
    names.dedup();
    names.truncate(2);
    names.join(" / ")
}

fn line(row: &Measurement) -> String {
    let method = if row.default { format!("**{}**", row.method) } else { row.method.to_owned() };
    format!(
        "| {} | {method} | {} | {} | {} | {} | {} |",
        row.parameter,
        number(row.error),
        share(row.false_negative_rate),
        share(row.false_positive_rate),
        number(row.ns_per_item),
        if row.on_pareto_front { "●" } else { "" }
    )
}

fn share(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{} %", number(100.0 * value)) }
}

/// The growth of the time per step with the number of road users, between the two largest numbers of each method.
fn growth(text: &mut String, rows: &[&Measurement]) {
    let _ = write!(
        text,
        "\nTime per step grows with the number of road users to the power of:\n\n| items | method | from | to | exponent |\n|---|---|---|---|---|\n"
    );
    for traffic in distinct(rows.iter().map(|row| row.traffic())) {
        let of_traffic = rows.iter().filter(|row| row.traffic() == traffic);
        for method in distinct(of_traffic.clone().map(|row| row.method)) {
            let mut sizes = of_traffic.clone().filter(|row| row.method == method).collect::<Vec<_>>();
            sizes.sort_by_key(|row| row.items);
            sizes.dedup_by_key(|row| row.items);
            if let [.., before, last] = sizes[..] {
                let total = |row: &Measurement| row.ns_per_item * row.items as f64;
                let exponent = (total(last) / total(before)).ln() / (last.items as f64 / before.items as f64).ln();
                let _ = writeln!(text, "| {traffic} | {method} | {} | {} | {exponent:.2} |", before.items, last.items);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::page::*;

    #[test]
    fn growth_has_one_line_per_traffic_and_method() {
        let row = |method, items: usize| Measurement {
            axis: Axis::Candidates,
            method,
            parameter: String::new(),
            error_name: "",
            error: 0.0,
            false_negative_rate: 0.0,
            false_positive_rate: 0.0,
            ns_per_item: items as f64,
            items,
            on_pareto_front: false,
            scene: format!("jam, {items}"),
            default: false,
        };
        // The first method was too slow for 10⁴; the sizes of the second are out of order and one is repeated.
        let rows = [row("a", 100), row("b", 10_000), row("a", 1000), row("b", 100), row("b", 1000), row("b", 10_000)];
        let mut text = String::new();
        growth(&mut text, &rows.iter().collect::<Vec<_>>());
        let lines = text.lines().filter(|line| line.starts_with("| jam")).collect::<Vec<_>>();
        assert_eq!(lines, ["| jam | a | 100 | 1000 | 2.00 |", "| jam | b | 1000 | 10000 | 2.00 |"]);
    }
}
