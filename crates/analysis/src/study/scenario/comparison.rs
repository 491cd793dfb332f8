//! The runs of a plan, read back and compared over pairs with the same seed.

use super::estimate::{Estimate, mean, relative_error};
use super::measures::{Measure, RunFigures, measures};
use super::plan::{Axis, Plan};
use super::recommendation::coarsest;
use super::richardson::{Convergence, convergence, own_error};
use crate::batch::sweep::Task;
use crate::logged::RunTime;
use crate::study::pareto::is_on_front;
use crate::{Error, Result};
use closecall::util::units::Second;

/// The measure by which steps are recommended.
pub(crate) const HEADLINE: &str = "conflicts_per_vehicle_hour";
/// Measures that are shown beside it.
pub const SHOWN: [&str; 3] = [HEADLINE, "serious_or_critical_per_vehicle_hour", "risk_index_per_vehicle_kilometre"];

/// The runs of a plan, read back.
#[derive(Debug)]
pub struct Study {
    /// The plan, without what failed.
    pub plan: Plan,
    /// The seeds as they were asked for.
    pub seeds: String,
    /// The relative error that is wanted.
    pub accuracy: f64,
    /// All measures of a run.
    pub measures: Vec<Measure>,
    /// The settings of which a run failed.
    pub left_out: Vec<String>,
    /// The runs of each setting, one per seed; none where some failed.
    runs: Vec<Vec<RunFigures>>,
}

impl Study {
    /// Reads the runs of a plan. The tasks are those of its settings, seed by seed. A setting with a run that failed is left
    /// out.
    ///
    /// # Errors
    /// Those of reading a log; [`Error::Value`] if a run of the user's own setting failed.
    pub fn read(mut plan: Plan, tasks: &[Task], failed: &[String], seeds: String, accuracy: f64) -> Result<Self> {
        let settings = plan.settings().len();
        let mut runs = vec![Vec::new(); settings];
        for (setting, runs) in runs.iter_mut().enumerate() {
            let own = tasks.iter().skip(setting).step_by(settings).collect::<Vec<_>>();
            if own.iter().all(|task| !failed.contains(&task.name)) {
                *runs = own.into_iter().map(RunFigures::of).collect::<Result<_>>()?;
            }
        }
        if runs[0].is_empty() {
            return Err(Error::Value(
                "a run of the scenario as it is failed, so there is nothing to compare".to_owned(),
            ));
        }
        let failed = (0..settings).filter(|setting| runs[*setting].is_empty());
        let left_out = failed.map(|setting| plan.name(setting)).collect();
        for axis in &mut plan.axes {
            axis.choices.retain(|choice| !runs[choice.setting].is_empty());
        }
        plan.axes.retain(|axis| axis.choices.len() > 1);
        Ok(Self { plan, seeds, accuracy, measures: measures(), left_out, runs })
    }

    /// The axis of steps with the user's own integration, if steps were varied.
    pub fn steps(&self) -> Option<&Axis> {
        self.plan.axes.first().filter(|axis| axis.has_steps())
    }

    /// The place of a measure.
    pub fn place(&self, measure: &str) -> usize {
        self.measures.iter().position(|known| known.name == measure).unwrap_or_default()
    }

    /// A measure of a setting over its seeds.
    pub fn estimate(&self, setting: usize, measure: usize) -> Option<Estimate> {
        self.measures[measure].estimate(measure, &self.runs[setting])
    }

    /// The relative error of a setting against another.
    pub fn error(&self, setting: usize, reference: usize, measure: usize) -> Option<Estimate> {
        let [values, of] = self.values(&[setting, reference], measure).try_into().ok()?;
        relative_error(&values, &of)
    }

    /// The errors on an axis against its first choice; of a step also with what the finest step itself may be off by.
    pub fn errors(&self, axis: &Axis, measure: usize) -> Vec<Option<Estimate>> {
        let reference = axis.choices[0].setting;
        let own = self.own_error(axis, measure).unwrap_or_default();
        let error = |setting: usize| Some(self.error(setting, reference, measure)?.widened(own));
        axis.choices.iter().map(|choice| error(choice.setting)).collect()
    }

    /// What the finest step of an axis of steps may be off by, relative to its value.
    pub(crate) fn own_error(&self, axis: &Axis, measure: usize) -> Option<f64> {
        let (steps, values) = self.steps_and_values(axis, measure);
        let means = values.iter().map(|values| mean(values).map(|mean| mean.value)).collect::<Option<Vec<_>>>()?;
        own_error(&steps, &means, self.convergence(axis, measure))
    }

    /// The steps of an axis, none if it has no steps, and the values at each.
    fn steps_and_values(&self, axis: &Axis, measure: usize) -> (Vec<Second>, Vec<Vec<f64>>) {
        let steps = axis.choices.iter().filter_map(|choice| choice.step).collect();
        let settings = axis.choices.iter().map(|choice| choice.setting).collect::<Vec<_>>();
        (steps, self.values(&settings, measure))
    }

    /// The values of these settings, for the seeds with which all of them have one.
    pub fn values(&self, settings: &[usize], measure: usize) -> Vec<Vec<f64>> {
        let mut values = vec![Vec::new(); settings.len()];
        for seed in 0..self.runs[0].len() {
            let of_seed = settings.iter().map(|setting| self.runs[*setting][seed].values[measure]);
            if let Some(of_seed) = of_seed.collect::<Option<Vec<_>>>() {
                values.iter_mut().zip(of_seed).for_each(|(values, value)| values.push(value));
            }
        }
        values
    }

    /// What a run of a setting takes, on average.
    pub(crate) fn run_time(&self, setting: usize) -> RunTime {
        let runs = &self.runs[setting];
        let mean =
            |of: fn(&RunTime) -> Second| runs.iter().map(|run| of(&run.run_time)).sum::<f64>() / runs.len() as f64;
        RunTime { wall: mean(|time| time.wall), cpu: mean(|time| time.cpu) }
    }

    /// The place of the step that a measure needs, on an axis of steps.
    pub fn recommended(&self, axis: &Axis, measure: usize) -> usize {
        coarsest(&self.errors(axis, measure), self.accuracy)
    }

    /// What the finest steps of an axis tell of a measure.
    pub(crate) fn convergence(&self, axis: &Axis, measure: usize) -> Convergence {
        let (steps, values) = self.steps_and_values(axis, measure);
        convergence(&steps, &values, self.measures[measure].may_be_negative())
    }

    /// Whether each choice of an axis of steps is on the Pareto front of processor time and error.
    pub fn front(&self, axis: &Axis, measure: usize) -> Vec<bool> {
        let errors = self.errors(axis, measure);
        let size = |error: &Option<Estimate>| error.map_or(f64::INFINITY, |error| error.value.abs());
        let points =
            axis.choices.iter().zip(&errors).map(|(choice, error)| [self.run_time(choice.setting).cpu, size(error)]);
        let points = points.collect::<Vec<_>>();
        points.iter().map(|point| is_on_front(*point, points.iter().copied())).collect()
    }
}
