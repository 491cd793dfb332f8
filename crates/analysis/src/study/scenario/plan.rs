//! Which settings a study runs: one choice at a time around the user's own, the step together with the integration.
//!
//! A setting is a list of changes to the user's own, so that two axes that meet share their runs.

use crate::batch::sweep::{Setting, Vary};
use crate::logged::{Label, LabelValue};
use crate::{Error, Result};
use closecall::util::units::Second;

/// The name of the axis of step lengths.
pub const STEP: &str = "step-length";
/// Whether SUMO moves a vehicle by its mean speed of a step instead of that at its end.
pub(crate) const BALLISTIC: &str = "sumo:step-method.ballistic";
const ACTION_STEP: &str = "sumo:default.action-step-length";

/// SUMO's defaults of options on the default axes.
const DEFAULTS: [(&str, &str); 5] = [
    (STEP, "1"),
    (BALLISTIC, "false"),
    (ACTION_STEP, "0"),
    ("sumo:lateral-resolution", "-1"),
    ("sumo:device.rerouting.threads", "0"),
];
/// The default axes besides those of the step and of the drivers' action step.
const AXES: [(&str, &[&str]); 5] = [
    ("sumo:lateral-resolution", &["0.8"]),
    ("path", &["lanes", "arc", "straight"]),
    ("mu", &["minimal", "at-rest", "paper"]),
    ("sumo:device.rerouting.threads", &["2"]),
    ("threads", &["2"]),
];
/// Options that must not change a result.
pub(crate) const WITHOUT_EFFECT: [&str; 2] = ["sumo:device.rerouting.threads", "threads"];
const STEPS: &str = "1,0.5,0.2,0.1,0.05";
/// Those of a quick study, which is not to take long.
const QUICK_STEPS: &str = "1,0.5,0.2,0.1";

/// Changes to the user's own setting.
type Changes = Vec<(Vary, String)>;

/// A value on an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The value as it was asked for.
    pub value: String,
    /// The place of its setting in the plan.
    pub setting: usize,
    /// The step length, on an axis of steps.
    pub step: Option<Second>,
}

/// The values of one option, everything else being the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The option's name; for steps with another integration than the user's own, with that.
    pub name: String,
    /// The values. Steps begin with the finest; other axes with the user's own value. The others are compared with the
    /// first.
    pub choices: Vec<Choice>,
}

impl Axis {
    /// Whether its values are step lengths.
    pub(crate) fn has_steps(&self) -> bool {
        self.choices.iter().all(|choice| choice.step.is_some())
    }
}

/// The settings and the axes that they are on.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// The changes of each setting; the first has none.
    settings: Vec<Changes>,
    /// The axes; where steps are varied, the first is that with the user's own integration.
    pub axes: Vec<Axis>,
    /// The user's own step length.
    pub own_step: Second,
}

impl Plan {
    /// The plan for these options, or for the default axes if there are none. `own` tells the value that an option has in
    /// the user's own setting, if it is set anywhere.
    ///
    /// # Errors
    /// [`Error::Value`] if a step length is not a number above 0, [`Error::VariedTwice`].
    pub fn of(varied: &[Vary], quick: bool, own: &dyn Fn(&Vary) -> Option<String>) -> Result<Self> {
        let own = |vary: &Vary| {
            let default =
                DEFAULTS.iter().find(|(name, _)| *name == vary.parameter).map(|(_, value)| (*value).to_owned());
            own(vary).or(default)
        };
        let step = vary(STEP, if quick { QUICK_STEPS } else { STEPS });
        let own_step = own(&step).unwrap_or_default();
        let mut plan = Self { settings: vec![Vec::new()], axes: Vec::new(), own_step: seconds(&own_step)? };
        let varied = if varied.is_empty() { default_axes(step, plan.own_step, quick, &own) } else { as_given(varied)? };
        let named = |name: &str| varied.iter().find(|vary| vary.parameter == name);
        if let Some(steps) = named(STEP) {
            plan.add_steps(steps, &own_step, None)?;
            for method in named(BALLISTIC).into_iter().flat_map(|method| others(method, &own)) {
                plan.add_steps(steps, &own_step, Some(method))?;
            }
        }
        for vary in varied.iter().filter(|vary| vary.parameter != STEP) {
            plan.add_axis(vary, own(vary), &own);
        }
        Ok(plan)
    }

    /// Adds the axis of steps with a change of the integration, or without one.
    fn add_steps(&mut self, steps: &Vary, own: &str, method: Option<(Vary, String)>) -> Result<()> {
        let mut values =
            steps.values.iter().map(|value| Ok((seconds(value)?, value.clone()))).collect::<Result<Vec<_>>>()?;
        if values.iter().all(|(step, _)| *step != self.own_step) {
            values.push((self.own_step, own.to_owned()));
        }
        values.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        values.dedup_by(|(a, _), (b, _)| a == b);
        let mut choices = Vec::with_capacity(values.len());
        for (step, value) in values {
            let change = (step != self.own_step).then(|| (steps.clone(), value.clone()));
            let setting = self.add(change.into_iter().chain(method.clone()).collect());
            choices.push(Choice { value, setting, step: Some(step) });
        }
        let name = method.map_or(STEP.to_owned(), |(method, value)| format!("{STEP}, {}={value}", method.option()));
        self.axes.push(Axis { name, choices });
        Ok(())
    }

    fn add_axis(&mut self, vary: &Vary, value: Option<String>, own: &dyn Fn(&Vary) -> Option<String>) {
        let value = value.unwrap_or_else(|| "own".to_owned());
        let mut choices = vec![Choice { value, setting: 0, step: None }];
        for (vary, value) in others(vary, own) {
            choices.push(Choice { setting: self.add(vec![(vary, value.clone())]), value, step: None });
        }
        if choices.len() > 1 {
            self.axes.push(Axis { name: vary.parameter.clone(), choices });
        }
    }

    /// The place of the setting with these changes.
    fn add(&mut self, changes: Changes) -> usize {
        let known = self.settings.iter().position(|known| *known == changes);
        known.unwrap_or_else(|| {
            self.settings.push(changes);
            self.settings.len() - 1
        })
    }

    /// The settings for a sweep. They have one column, as all runs of a data set must have the same.
    pub fn settings(&self) -> Vec<Setting> {
        let of = |changes: &Changes| {
            let mut setting =
                Setting::of(&changes.iter().map(|(vary, value)| (vary, value.as_str())).collect::<Vec<_>>());
            setting.labels = vec![Label { name: "setting".to_owned(), value: LabelValue::Text(in_words(changes)) }];
            setting
        };
        self.settings.iter().map(of).collect()
    }

    /// The changes of a setting in words.
    pub fn name(&self, setting: usize) -> String {
        in_words(&self.settings[setting])
    }
}

fn in_words(changes: &Changes) -> String {
    if changes.is_empty() {
        return "own".to_owned();
    }
    changes.iter().map(|(vary, value)| format!("{}={value}", vary.parameter)).collect::<Vec<_>>().join(" ")
}

/// The default axes: with `quick`, one other value each besides the steps.
fn default_axes(step: Vary, own_step: Second, quick: bool, own: &dyn Fn(&Vary) -> Option<String>) -> Vec<Vary> {
    // Drivers cannot act more often than the simulation steps.
    let slower = [1.0, 2.0 * own_step].map(|action| (action > own_step).then(|| action.to_string()));
    let mut action = slower.into_iter().flatten().collect::<Vec<_>>();
    action.dedup();
    let axes = AXES.iter().map(|(name, values)| vary(name, &values.join(",")));
    let mut axes = [vary(BALLISTIC, "false,true"), vary(ACTION_STEP, &action.join(","))]
        .into_iter()
        .chain(axes)
        .collect::<Vec<_>>();
    for axis in axes.iter_mut().filter(|_| quick) {
        axis.values = others(axis, own).into_iter().map(|(_, value)| value).take(1).collect();
    }
    axes.insert(0, step);
    axes
}

/// The user's axes, each once. `sumo:step-length` is the same as `step-length`.
fn as_given(varied: &[Vary]) -> Result<Vec<Vary>> {
    let mut axes = Vec::<Vary>::new();
    for vary in varied {
        let parameter = if vary.option() == STEP { STEP.to_owned() } else { vary.parameter.clone() };
        if axes.iter().any(|known| known.parameter == parameter) {
            return Err(Error::VariedTwice(parameter));
        }
        axes.push(Vary { parameter, values: vary.values.clone() });
    }
    Ok(axes)
}

fn vary(parameter: &str, values: &str) -> Vary {
    Vary { parameter: parameter.to_owned(), values: values.split(',').map(str::to_owned).collect() }
}

/// The values of an option that are not the user's own.
fn others(vary: &Vary, own: &dyn Fn(&Vary) -> Option<String>) -> Vec<(Vary, String)> {
    let own = own(vary);
    let others = vary.values.iter().filter(|value| own.as_ref().is_none_or(|own| !is_same(own, value)));
    others.map(|value| (vary.clone(), value.clone())).collect()
}

fn is_same(a: &str, b: &str) -> bool {
    match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    }
}

fn seconds(text: &str) -> Result<Second> {
    let step = text.parse::<Second>().ok().filter(|step| step.is_finite() && *step > 0.0);
    step.ok_or_else(|| Error::Value(format!("{STEP}: \"{text}\" is not a time above 0 s")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(varied: &[&str], own: &'static [(&'static str, &'static str)]) -> Plan {
        let varied = varied.iter().map(|vary| vary.parse().unwrap()).collect::<Vec<_>>();
        let own =
            |vary: &Vary| own.iter().find(|(name, _)| *name == vary.parameter).map(|(_, value)| (*value).to_owned());
        Plan::of(&varied, false, &own).unwrap()
    }

    fn names(plan: &Plan) -> Vec<String> {
        (0..plan.settings.len()).map(|setting| plan.name(setting)).collect()
    }

    #[test]
    fn axes_that_meet_share_their_runs() {
        let plan = plan(
            &["step-length=0.5,1", "sumo:step-method.ballistic=true,false", "mu=minimal,paper"],
            &[("mu", "minimal")],
        );
        assert_eq!(
            names(&plan),
            [
                "own",
                "step-length=0.5",
                "step-length=0.5 sumo:step-method.ballistic=true",
                "sumo:step-method.ballistic=true",
                "mu=paper",
            ]
        );
        assert_eq!(plan.axes.len(), 4);
        let steps = plan.axes[1].choices.iter().map(|choice| (choice.setting, choice.step)).collect::<Vec<_>>();
        assert_eq!(steps, [(2, Some(0.5)), (3, Some(1.0))]);
    }

    #[test]
    fn the_users_own_step_is_among_the_steps() {
        let plan = plan(&["sumo:step-length=0.1,0.2"], &[("step-length", "0.25")]);
        assert_eq!(names(&plan), ["own", "step-length=0.1", "step-length=0.2"].map(str::to_owned));
        let steps = plan.axes[0].choices.iter().map(|choice| choice.step).collect::<Vec<_>>();
        assert_eq!((steps, plan.own_step), (vec![Some(0.1), Some(0.2), Some(0.25)], 0.25));
    }

    #[test]
    fn by_default_no_setting_repeats_the_users_own() {
        for own in [&[][..], &[("step-length", "0.1"), (BALLISTIC, "true"), ("path", "arc"), ("threads", "2")]] {
            let plan = plan(&[], own);
            let names = names(&plan);
            assert!(own.iter().all(|(name, value)| !names.contains(&format!("{name}={value}"))), "{names:?}");
            assert!(plan.axes[0].choices.len() == 5 && names.iter().all(|name| !name.ends_with('=')), "{names:?}");
        }
    }

    #[test]
    fn a_step_that_is_none_is_refused() {
        for wrong in ["0", "-1", "x", "inf"] {
            let vary = Vary { parameter: STEP.to_owned(), values: vec![wrong.to_owned()] };
            assert!(Plan::of(&[vary], false, &|_| None).unwrap_err().to_string().contains(wrong));
        }
    }
}
