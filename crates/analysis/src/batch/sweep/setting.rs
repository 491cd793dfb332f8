//! A setting of a sweep: options with a value each, the same for all seeds.

use super::vary::{Vary, plain};
use crate::logged::Label;

/// Options with a value each, which tell the runs of one setting from those of another.
#[derive(Clone, Debug, Default)]
pub struct Setting {
    /// The beginning of the names of its runs.
    pub(super) name: String,
    /// Its words for `closecall run`.
    pub(super) args: Vec<String>,
    /// Its words for SUMO.
    pub(super) for_sumo: Vec<String>,
    /// Its columns in the data set.
    pub labels: Vec<Label>,
    /// The names of its options.
    options: Vec<String>,
}

impl Setting {
    /// The setting with these values; a column for each option.
    pub fn of(chosen: &[(&Vary, &str)]) -> Self {
        let mut setting = Self::default();
        for (vary, value) in chosen {
            setting.name += &format!("{}-{}_", plain(&vary.parameter), plain(value));
            if vary.is_sumos() { &mut setting.for_sumo } else { &mut setting.args }.push(vary.word(value));
            setting.labels.push(vary.label(value));
            setting.options.push(vary.option().to_owned());
        }
        setting
    }

    /// The words for SUMO but for the options that this setting sets: SUMO refuses an option that is set twice.
    pub(super) fn without_its_options(&self, for_sumo: &[String]) -> Vec<String> {
        let is_value = |word: &String| !word.starts_with('-') || word.parse::<f64>().is_ok();
        let mut left = Vec::with_capacity(for_sumo.len());
        let mut args = for_sumo.iter().peekable();
        while let Some(word) = args.next() {
            let name = word.trim_start_matches('-');
            let (name, has_value) = name.split_once('=').map_or((name, false), |(name, _)| (name, true));
            if is_value(word) || !self.options.iter().any(|option| option == name) {
                left.push(word.clone());
            } else if !has_value {
                args.next_if(|next| is_value(next));
            }
        }
        left
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_setting_sets_is_not_set_twice() {
        let vary = "sumo:scale=2".parse::<Vary>().unwrap();
        let setting = Setting::of(&[(&vary, "2")]);
        let args = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
        for before in [
            "--no-warnings --scale 1.5 --end 9",
            "--no-warnings --scale=-1 --end 9",
            "--no-warnings --scale -1 --end 9",
        ] {
            assert_eq!(setting.without_its_options(&args(before)), args("--no-warnings --end 9"), "{before}");
        }
    }
}
