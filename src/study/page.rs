//! `study.md`: every axis as a table, the default marked, and what to read from it.

use std::fmt::Write;

use super::clock::machine;
use super::measurement::{Axis, Measurement, scenes};

/// What an axis asks, and against what its errors are.
fn question(axis: Axis) -> [&'static str; 2] {
    match axis {
        Axis::Volume => ["Do two rectangles touch?", "exact arithmetic on the same f64 inputs"],
        Axis::Candidates => ["Which road users are near each other?", "every pair (from 10⁵ on: the sweep along x)"],
        Axis::Time => ["When do two that move first touch?", "separating axes in 300-bit arithmetic"],
        Axis::Braking => ["How much room does the ego need?", "the braking equations solved in 300-bit arithmetic"],
        Axis::Numbers => ["Which numbers, seen from where?", "exact arithmetic on the same f64 inputs"],
        Axis::Path => ["Where will a road user go?", "where the recorded vehicles really drove"],
    }
}

pub(super) fn of(rows: &[Measurement]) -> String {
    // Writing to a String does not fail.
    let mut text = format!("# Error against run time\n\nMeasured on: {}.\n", machine());
    for axis in Axis::ALL {
        let of_axis = rows.iter().filter(|row| row.axis == axis).collect::<Vec<_>>();
        if of_axis.is_empty() {
            continue;
        }
        let [asks, against] = question(axis);
        let name = axis.name();
        let _ = write!(
            text,
            "\n## {name}: {asks}\n\nErrors against {against}. **Bold**: what closecall does; ●: on the Pareto front of \
             its items.\n\n![{name}]({name}.svg)\n\n| items | method | {} | missed | false | ns per item | |\n\
             |---|---|---|---|---|---|---|\n",
            error_names(&of_axis)
        );
        for row in &of_axis {
            let _ = writeln!(text, "{}", line(row));
        }
        if axis == Axis::Candidates {
            growth(&mut text, rows);
        }
        let dominated = of_axis.iter().filter(|row| row.default && !row.on_pareto_front).collect::<Vec<_>>();
        for row in dominated {
            let _ = writeln!(text, "\nThe default is off the front of \"{}\".", row.scene);
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

fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if (0.01..1e6).contains(&size) => {
            let digits = (2 - size.log10().floor() as i32).max(0) as usize;
            format!("{value:.digits$}")
        }
        _ => format!("{value:.1e}"),
    }
}

fn share(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{} %", number(100.0 * value)) }
}

/// How the time per step grows with the number of road users, from one decade to the next.
fn growth(text: &mut String, rows: &[Measurement]) {
    let _ = write!(
        text,
        "\nTime per step grows with the number of road users to the power of:\n\n| items | method | from | to | exponent |\n|---|---|---|---|---|\n"
    );
    let of_axis = rows.iter().filter(|row| row.axis == Axis::Candidates).cloned().collect::<Vec<_>>();
    let mut kinds = scenes(&of_axis).iter().filter_map(|scene| scene.split(", ").next()).collect::<Vec<_>>();
    kinds.dedup();
    for kind in kinds {
        let mut methods = Vec::new();
        for row in of_axis.iter().filter(|row| row.scene.starts_with(kind)) {
            if !methods.contains(&row.method) {
                methods.push(row.method);
            }
        }
        for method in methods {
            let same = of_axis.iter().filter(|row| row.method == method && row.scene.starts_with(kind));
            let same = same.collect::<Vec<_>>();
            if let [.., before, last] = same[..] {
                let total = |row: &Measurement| row.ns_per_item * row.items as f64;
                let exponent = (total(last) / total(before)).ln() / (last.items as f64 / before.items as f64).ln();
                let _ = writeln!(text, "| {kind} | {method} | {} | {} | {exponent:.2} |", before.items, last.items);
            }
        }
    }
}
