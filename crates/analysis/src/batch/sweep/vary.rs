//! A varied option: `epsilon=0.5,1` for `closecall run`, `sumo:scale=1,1.2` for SUMO.

use std::str::FromStr;

use crate::logged::{Label, LabelValue};

/// The prefix of SUMO's options.
const SUMO: &str = "sumo:";

/// An option and its values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vary {
    /// The option's name without dashes, with the prefix `sumo:` if it is for SUMO.
    pub parameter: String,
    /// The values, without repetitions.
    pub values: Vec<String>,
}

impl FromStr for Vary {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (parameter, values) = text.split_once('=').ok_or("it has no values: NAME=A,B,…")?;
        let (prefix, name) = match parameter.strip_prefix(SUMO) {
            Some(name) => (SUMO, name.to_owned()),
            // The keys of a settings file may have underscores, too.
            None => ("", parameter.replace('_', "-")),
        };
        if name.is_empty() || name.starts_with('-') {
            return Err(format!("\"{parameter}\" is not the name of an option (without dashes)"));
        }
        let values = values.split(',').map(str::to_owned).collect::<Vec<_>>();
        for (place, value) in values.iter().enumerate() {
            if value.is_empty() {
                return Err("a value is empty".to_owned());
            }
            if values[..place].contains(value) {
                return Err(format!("the value {value} is repeated"));
            }
        }
        Ok(Self { parameter: format!("{prefix}{name}"), values })
    }
}

impl Vary {
    /// Whether the option is for SUMO.
    pub fn is_sumos(&self) -> bool {
        self.parameter.starts_with(SUMO)
    }

    /// The option's name without the prefix.
    pub fn option(&self) -> &str {
        self.parameter.strip_prefix(SUMO).unwrap_or(&self.parameter)
    }

    /// The word of the command line that sets the option.
    pub(super) fn word(&self, value: &str) -> String {
        format!("--{}={value}", self.option())
    }

    /// The name of its column, with a prefix, because a log already has columns such as `mu`.
    pub(super) fn column(&self) -> String {
        let whose = if self.is_sumos() { "sumo" } else { "option" };
        format!("{whose}_{}", self.option().replace(['-', '.', ':'], "_"))
    }

    /// The column with one of the values: a number if all values are numbers.
    pub(super) fn label(&self, value: &str) -> Label {
        let number = |text: &str| text.parse::<f64>().ok().filter(|number| number.is_finite());
        let value = match number(value) {
            Some(value) if self.values.iter().all(|value| number(value).is_some()) => LabelValue::Number(value),
            _ => LabelValue::Text(value.to_owned()),
        };
        Label { name: self.column(), value }
    }
}

/// All combinations of the values; a single empty one if nothing is varied.
pub(super) fn product(varied: &[Vary]) -> Vec<Vec<(&Vary, &str)>> {
    let mut all = vec![Vec::new()];
    for vary in varied {
        let with = |before: Vec<(_, _)>| {
            vary.values.iter().map(move |value| {
                let mut chosen = before.clone();
                chosen.push((vary, value.as_str()));
                chosen
            })
        };
        all = all.into_iter().flat_map(with).collect();
    }
    all
}

/// A text as part of a folder's name.
pub(super) fn plain(text: &str) -> String {
    let is_plain = |sign: char| sign.is_alphanumeric() || ['.', '-', '+'].contains(&sign);
    text.chars().map(|sign| if is_plain(sign) { sign } else { '.' }).collect()
}

#[cfg(test)]
mod tests {
    use crate::batch::sweep::vary::*;

    #[test]
    fn an_option_is_for_closecall_or_for_sumo() {
        let own = "serious_ttc=1,2.5".parse::<Vary>().unwrap();
        assert_eq!(
            (own.is_sumos(), own.word("1"), own.column()),
            (false, "--serious-ttc=1".into(), "option_serious_ttc".into())
        );
        assert_eq!(own.label("2.5").value, LabelValue::Number(2.5));
        let sumo = "sumo:collision.action=warn,1".parse::<Vary>().unwrap();
        assert_eq!(
            (sumo.is_sumos(), sumo.option(), sumo.column()),
            (true, "collision.action", "sumo_collision_action".into())
        );
        assert_eq!(sumo.label("1").value, LabelValue::Text("1".to_owned()));
        for wrong in ["mu", "mu=", "mu=a,", "=a", "--mu=a", "sumo:=a", "mu=a,a"] {
            assert!(wrong.parse::<Vary>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn every_combination_of_values_occurs_once() {
        let varied = ["a=1,2".parse().unwrap(), "b=x,y,z".parse().unwrap()];
        let all = product(&varied);
        assert_eq!(all.len(), 6);
        assert_eq!(all[1].iter().map(|(_, value)| *value).collect::<Vec<_>>(), ["1", "y"]);
        assert_eq!(product(&[]).len(), 1);
    }
}
