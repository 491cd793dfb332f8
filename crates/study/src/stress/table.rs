//! The results of a stress run as text: one line each, followed by the inputs if a bound was exceeded.

use std::fmt::Write;

use super::tally::{PropertyResult, Unit};

pub(super) fn of(rows: &[PropertyResult]) -> String {
    const HEADINGS: [&str; 9] = ["group", "case", "property", "inputs", "worst", "unit", "ulps", "bound", ""];
    let mut text = String::new();
    let mut lines = vec![HEADINGS.map(str::to_owned)];
    lines.extend(rows.iter().map(cells));
    let mut widths = [0; 9];
    for line in &lines {
        for (width, cell) in widths.iter_mut().zip(line) {
            *width = (*width).max(cell.chars().count());
        }
    }
    for (line, row) in lines.iter().zip(std::iter::once(None).chain(rows.iter().map(Some))) {
        for (column, (cell, width)) in line.iter().zip(widths).enumerate() {
            let written = if matches!(column, 3 | 4 | 6 | 7) {
                write!(text, "{cell:>width$}  ")
            } else {
                write!(text, "{cell:<width$}  ")
            };
            // Writing to a String does not fail.
            let _ = written;
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
        if let Some(row) = row.filter(|row| !row.holds()) {
            let _ = writeln!(text, "    at {}", row.at);
        }
    }
    text
}

fn cells(row: &PropertyResult) -> [String; 9] {
    let group = format!("{:?}", row.group).to_lowercase();
    let number = |value: f64| match row.property.unit {
        Unit::Violations => format!("{value:.0}"),
        _ if value == 0.0 => "0".to_owned(),
        _ => format!("{value:.1e}"),
    };
    [
        group,
        row.case.to_owned(),
        row.property.name.to_owned(),
        row.inputs.to_string(),
        number(row.worst),
        row.property.unit.name().to_owned(),
        row.ulps.map_or(String::new(), |ulps| format!("{ulps:.1}")),
        number(row.property.bound),
        if row.holds() { "ok" } else { "EXCEEDED" }.to_owned(),
    ]
}
