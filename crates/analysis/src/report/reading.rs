//! "How to read this page": the sentences that name thresholds, made of the thresholds themselves. Words between asterisks
//! are set in bold.

use serde_json::{Value, json};

use closecall::detection::kind::Severity;
use closecall::detection::severity::{
    AT_SPEED, Consequence, EVASIVE, FULL, LIKELY, LIKELY_CLEARANCE, LIKELY_PET, MODERATE, NEAR_CERTAIN, NearnessLevel,
    SEVERE, table,
};
use closecall::options::thresholds::SeverityThresholds;
use closecall::options::{Options, SeverityRule};
use strum::VariantArray;

/// The sentences for runs with these records, each once.
pub fn json(records: &[Value]) -> Value {
    let options = records.iter().filter_map(|record| record.get("options")).map(thresholds).collect::<Vec<_>>();
    let options = if options.is_empty() { vec![Options::default()] } else { options };
    let each = |text: fn(&Options) -> String| {
        let mut texts = options.iter().map(text).collect::<Vec<_>>();
        texts.sort();
        texts.dedup();
        texts
    };
    json!({ "severity": each(of_severity), "kind": each(of_kind) })
}

/// The thresholds among a run's options; the defaults for those that an earlier version did not have.
fn thresholds(record: &Value) -> Options {
    let or = |name: &str, default: f64| record.get(name).and_then(Value::as_f64).unwrap_or(default);
    let default = Options::default();
    // Logs of earlier versions have the rule as "severity".
    let rule = record.get("severity_rule").or_else(|| record.get("severity")).and_then(Value::as_str);
    Options {
        severity_rule: match rule {
            Some("time-left") => SeverityRule::TimeLeft,
            Some("fhwa") => SeverityRule::Fhwa,
            Some("ssm") => SeverityRule::Ssm,
            _ => SeverityRule::Levels,
        },
        serious_probability: or("serious_probability", default.serious_probability),
        serious_delta_v: or("serious_delta_v", default.serious_delta_v),
        serious_ttc: or("serious_ttc", default.serious_ttc),
        serious_drac: or("serious_drac", default.serious_drac),
        rear_end_below: or("rear_end_below", default.rear_end_below),
        frontal_above: or("frontal_above", default.frontal_above),
        ..default
    }
}

fn of_kind(options: &Options) -> String {
    let [below, above] = [options.rear_end_below, options.frontal_above].map(|angle| number(angle.to_degrees()));
    format!(
        "The *kind* is the angle between the ways of the two where they meet: *rear-end* below {below}°, *frontal* above \
         {above}°, *side* between them. It does not say which parts touch."
    )
}

fn of_severity(options: &Options) -> String {
    match options.severity_thresholds() {
        SeverityThresholds::Levels => of_levels(),
        SeverityThresholds::TimeLeft { probability, delta_v } => format!(
            "A conflict is *critical* if the two touched, or even full braking at once would have been too late; *serious* if \
             a driver brakes too late with a probability of {} or more, and a crash would have changed a speed by {} or more; \
             a *caution* otherwise.",
            percent(probability),
            kmh(delta_v)
        ),
        SeverityThresholds::Measures { ttc, drac } => format!(
            "A conflict is *critical* if the two touched, or if avoiding it took more than the ego can brake; *serious* if the \
             time to collision was below {} s, or the braking that would have avoided it above {} m/s²; a *caution* otherwise.",
            number(ttc),
            number(drac)
        ),
    }
}

fn of_levels() -> String {
    let near_certain = format!(
        "*near certain*: they touched, even full braking at once would have been too late, a driver brakes too late with a \
         probability of {} or more, or braking by {} m/s² or more was needed, or was used where a crash would have changed a \
         speed by less than {}",
        percent(NEAR_CERTAIN),
        number(FULL),
        kmh(MODERATE)
    );
    let likely = format!(
        "*likely*: that probability is {} or more, braking by {} m/s² or more was needed, or by {} m/s² was used with a contact \
         ahead, or the second of two whose ways cross came less than {} s after the first, or passed it with less than {} m of \
         room at {} or more",
        percent(LIKELY),
        number(EVASIVE),
        number(FULL),
        number(LIKELY_PET),
        number(LIKELY_CLEARANCE),
        kmh(AT_SPEED)
    );
    let consequence = format!(
        "*severe*: a fatal injury with a probability of {} or more; *moderate*: a change of speed by {} or more; *minor*: less",
        percent(SEVERE),
        kmh(MODERATE)
    );
    format!(
        "Two questions make a conflict *critical*, *serious* or a *caution*. How near was a crash? {near_certain}; {likely}; \
         *possible*: the rest. What would it have meant? {consequence}. {}.",
        of_table()
    )
}

/// Which answers make a conflict critical, and which serious.
fn of_table() -> String {
    let of = |severity: Severity| {
        let words = NearnessLevel::VARIANTS.iter().rev().filter_map(|nearness| {
            let meant = Consequence::VARIANTS.iter().filter(|meant| table(*nearness, **meant) == severity);
            let meant = meant.map(|meant| meant.name()).collect::<Vec<_>>();
            (!meant.is_empty()).then(|| format!("{} and {}", nearness.name().replace('_', " "), meant.join(" or ")))
        });
        words.collect::<Vec<_>>().join(", or ")
    };
    format!(
        "Critical is what is {}; serious is what is {}; the rest is a caution, mostly ordinary following at short distance, \
         which this page leaves out at first if there is more",
        of(Severity::Critical),
        of(Severity::Serious)
    )
}

/// A number with as many decimals as it needs, three at most.
fn number(value: f64) -> String {
    let rounded = (value * 1e3).round() / 1e3;
    rounded.to_string()
}

fn percent(share: f64) -> String {
    format!("{} %", number(100.0 * share))
}

fn kmh(speed: f64) -> String {
    format!("{} km/h", number(3.6 * speed))
}

#[cfg(test)]
mod tests {
    use super::*;
    use closecall::detection::severity::{Assessment, SeverityInputs};

    const FAR: SeverityInputs = SeverityInputs {
        ttc: Some(2.0),
        drac: Some(2.0),
        ego_deceleration: 9.0,
        ttb: Some(1.0),
        crash_probability: 0.0,
        braking: 0.0,
        delta_v: 1.0,
        injury_probability: 0.0,
        collision: false,
    };

    /// The number before a unit, the nearest after a word.
    fn said(text: &str, after: &str, unit: &str) -> f64 {
        let rest = text.split_once(after).unwrap().1;
        let before = rest.split_once(unit).unwrap().0;
        before.split(' ').next_back().unwrap().parse().unwrap()
    }

    #[test]
    fn the_page_names_the_thresholds_at_which_the_assessment_changes() {
        let text = of_levels();
        let assess = |inputs: &SeverityInputs| Assessment::of(inputs, SeverityThresholds::Levels);
        let steps = |nearness: NearnessLevel, word: &str| {
            for (unit, input) in [(" %", 0), (" m/s²", 1)] {
                let threshold = said(&text, word, unit);
                let of = |value: f64| match input {
                    0 => SeverityInputs { crash_probability: value / 100.0, ..FAR },
                    _ => SeverityInputs { braking: value, drac: Some(value), ttc: None, ..FAR },
                };
                assert!(assess(&of(threshold)).nearness >= nearness, "{word} {threshold}{unit}");
                assert!(assess(&of(threshold - 0.01)).nearness < nearness, "{word} below {threshold}{unit}");
            }
        };
        steps(NearnessLevel::NearCertain, "*near certain*");
        steps(NearnessLevel::Likely, "*likely*");
        let [severe, moderate] = [said(&text, "*severe*", " %") / 100.0, said(&text, "*moderate*", " km/h") / 3.6];
        assert_eq!(Consequence::of(0.0, severe), Consequence::Severe);
        assert_eq!(Consequence::of(moderate + 1e-9, severe - 1e-9), Consequence::Moderate);
        assert_eq!(Consequence::of(moderate - 1e-9, severe - 1e-9), Consequence::Minor);
        assert!(text.contains("Critical is what is near certain and moderate or severe; serious is what is near certain and minor, or likely and moderate or severe;"), "{text}");
    }

    #[test]
    fn each_rule_is_told_with_its_own_thresholds() {
        let told = |options: Value| json(&[json!({ "options": options })])["severity"][0].as_str().unwrap().to_owned();
        let time_left =
            told(json!({ "severity_rule": "time-left", "serious_probability": 0.2, "serious_delta_v": 5.0 }));
        assert!(time_left.contains("20 % or more") && time_left.contains("18 km/h"), "{time_left}");
        let fhwa = told(json!({ "severity_rule": "fhwa", "serious_ttc": 1.25, "serious_drac": 3.0 }));
        assert!(fhwa.contains("below 1.25 s") && fhwa.contains("above 3 m/s²"), "{fhwa}");
        assert!(told(json!({ "severity": "ssm" })).contains("below 3 s"));
        assert_eq!(told(json!({})), of_levels());
    }

    #[test]
    fn runs_with_different_angles_are_told_apart() {
        let kinds = |angles: &[f64]| {
            let records = angles.iter().map(|angle| json!({ "options": { "rear_end_below": angle.to_radians() } }));
            json(&records.collect::<Vec<_>>())["kind"].as_array().unwrap().len()
        };
        assert_eq!((kinds(&[30.0, 30.0]), kinds(&[30.0, 40.0]), kinds(&[])), (1, 2, 1));
    }
}
