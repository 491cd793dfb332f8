//! The chosen measures of a logged conflict.

use closecall::options::measures::ChosenMeasure;

/// The measures of a conflict that its run was told to log. They take memory only where there are any: most runs log none.
#[derive(Clone, Debug, Default)]
pub struct LoggedMeasures(Option<Box<[Option<f64>; ChosenMeasure::ALL.len()]>>);

impl LoggedMeasures {
    /// The value of a measure.
    pub fn of(&self, measure: ChosenMeasure) -> Option<f64> {
        self.0.as_ref().and_then(|values| values[measure as usize])
    }

    pub(super) fn set(&mut self, measure: ChosenMeasure, value: Option<f64>) {
        if value.is_some() || self.0.is_some() {
            let values = self.0.get_or_insert_with(|| Box::new([None; ChosenMeasure::ALL.len()]));
            values[measure as usize] = value;
        }
    }
}

impl PartialEq for LoggedMeasures {
    fn eq(&self, other: &Self) -> bool {
        ChosenMeasure::ALL.into_iter().all(|measure| self.of(measure) == other.of(measure))
    }
}
