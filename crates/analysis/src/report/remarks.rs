//! The remarks of all runs for the box under the title: those of one code once, with the number of runs that have it.

use serde_json::{Value, json};

use closecall::util::remark::Remark;

/// The remarks in these records, in the order in which they come first. Runs of one net say the same of it; what is counted,
/// such as road users of a type, differs from run to run, and one run stands for the others.
pub fn json(records: &[Value]) -> Value {
    let mut found = Vec::<(Remark, usize, bool)>::new();
    for record in records {
        let of_run = record["summary"]["remarks"].as_array().into_iter().flatten();
        let of_run = of_run.filter_map(|remark| serde_json::from_value::<Remark>(remark.clone()).ok());
        let of_run = of_run.collect::<Vec<_>>();
        for (place, remark) in of_run.iter().enumerate() {
            // Several remarks of one code differ in their order.
            let nth = of_run[..place].iter().filter(|before| before.code == remark.code).count();
            let known = found.iter_mut().filter(|(known, ..)| known.code == remark.code).nth(nth);
            match known {
                Some((known, runs, is_same)) => {
                    *runs += 1;
                    *is_same &= known.text == remark.text;
                }
                None => found.push((remark.clone(), 1, true)),
            }
        }
    }
    let remark = |(Remark { code, text }, runs, is_same): (Remark, usize, bool)| {
        let of = match (runs, records.len()) {
            (runs, all) if runs == all && is_same => String::new(),
            (runs, all) if is_same => format!(" ({runs} of {all} runs)"),
            (runs, all) => format!(" (so in one run; {runs} of {all} have such a remark)"),
        };
        json!({ "code": code.name(), "text": text + &of })
    };
    found.into_iter().map(remark).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_that_say_the_same_say_it_once() {
        let run = |lines: &[(&str, &str)]| {
            let remarks = lines.iter().map(|(code, text)| json!({ "code": code, "text": text })).collect::<Vec<_>>();
            json!({ "summary": { "remarks": remarks } })
        };
        let texts = |records: &[Value]| {
            let found = json(records);
            let texts = found.as_array().unwrap().iter().map(|remark| remark["text"].as_str().unwrap().to_owned());
            texts.collect::<Vec<_>>()
        };
        let long = ("long_steps", "steps of 0.2 s are long");
        let faults = |times: &'static str| [("net_faults", times), ("net_faults", "the worst is a")];
        let [one, other] = [faults("1 time"), faults("2 times")];
        assert_eq!(texts(&[run(&[long]), run(&[long])]), ["steps of 0.2 s are long"]);
        assert_eq!(texts(&[run(&[long]), run(&[])]), ["steps of 0.2 s are long (1 of 2 runs)"]);
        assert_eq!(
            texts(&[run(&one), run(&other)]),
            ["1 time (so in one run; 2 of 2 have such a remark)", "the worst is a"]
        );
        // Logs of earlier versions, and runs that were killed, have none.
        assert!(texts(&[json!({}), Value::Null]).is_empty());
    }
}
