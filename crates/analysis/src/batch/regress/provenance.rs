//! Changes since the blessing in versions, options and input files.

use std::collections::BTreeSet;

use serde_json::Value;

use super::outcome::RunsSummary;
use closecall_run::util::decimal::Written;

/// The differences in how the runs were made, one line each.
pub fn changes(before: &RunsSummary, now: &RunsSummary) -> Vec<String> {
    let mut changes = Vec::new();
    for (what, old, new) in [
        ("SUMO", &before.sumo, &now.sumo),
        ("closecall", &before.closecall, &now.closecall),
        ("platform", &before.platform, &now.platform),
    ] {
        if old != new {
            changes.push(format!("{what} {old} → {new}"));
        }
    }
    for file in &now.inputs {
        match before.inputs.iter().find(|old| old.path == file.path) {
            Some(old) => changes.extend(old.changes(file)),
            None => changes.push(format!("{}: new", file.path)),
        }
    }
    let is_gone = |path: &str| now.inputs.iter().all(|file| file.path != path);
    changes.extend(
        before.inputs.iter().filter(|old| is_gone(&old.path)).map(|old| format!("{}: no longer read", old.path)),
    );
    option_changes("option ", &before.options, &now.options, &mut changes);
    if before.step_length.to_bits() != now.step_length.to_bits() {
        changes.push(format!("step length {} s → {} s", Written(before.step_length), Written(now.step_length)));
    }
    let old = sorted(&before.sumo_options);
    let new = sorted(&now.sumo_options);
    changes.extend(old.difference(&new).map(|option| format!("SUMO option {option}: gone")));
    changes.extend(new.difference(&old).map(|option| format!("SUMO option {option}: new")));
    changes
}

/// Adds the options that differ, each by its name in `closecall.toml`.
fn option_changes(name: &str, before: &Value, now: &Value, changes: &mut Vec<String>) {
    match (before, now) {
        (Value::Object(old), Value::Object(new)) => {
            let keys = old.keys().chain(new.keys()).collect::<BTreeSet<_>>();
            for key in keys {
                let inner = if name.ends_with(' ') { format!("{name}{key}") } else { format!("{name}.{key}") };
                let value = |options: &serde_json::Map<String, Value>| options.get(key).cloned().unwrap_or_default();
                option_changes(&inner, &value(old), &value(new), changes);
            }
        }
        _ if before != now => changes.push(format!("{name} {before} → {now}")),
        _ => {}
    }
}

fn sorted(options: &[String]) -> BTreeSet<&String> {
    options.iter().collect()
}

#[cfg(test)]
mod tests {
    use crate::batch::regress::provenance::*;

    #[test]
    fn a_changed_option_is_named_with_both_values() {
        let options = |epsilon: f64, tau: f64| serde_json::json!({"epsilon": epsilon, "types": {"car": {"tau": tau}}});
        let mut changes = Vec::new();
        option_changes("option ", &options(0.5, 1.0), &options(1.0, 2.0), &mut changes);
        assert_eq!(changes, ["option epsilon 0.5 → 1.0", "option types.car.tau 1.0 → 2.0"]);
    }
}
