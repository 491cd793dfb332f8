//! The warm-up of a run: until it is over, traffic is not counted and no conflict is logged.

use crate::output::summary::Exposure;
use crate::util::decimal::Written;
use closecall::traffic::profile::Category;
use closecall::util::remark::{Remark, RemarkCode};
use closecall::util::units::{SAME_MOMENT, Second};

/// How far a run is in its warm-up.
#[derive(Debug, Default)]
pub(super) struct WarmUp {
    lasts: Second,
    /// The first step of the run.
    begin: Option<Second>,
    is_over: bool,
    /// Whether the road users that were there when it ended are counted.
    has_counted: bool,
    /// The vehicles and persons in the scene.
    present: [u64; 2],
    /// Those that ever were.
    entered: [u64; 2],
}

impl WarmUp {
    pub fn new(lasts: Second) -> Self {
        Self { lasts, has_counted: lasts == 0.0, ..Self::default() }
    }

    /// Whether a step has begun.
    pub(crate) fn has_begun(&self) -> bool {
        self.begin.is_some()
    }

    /// Whether the step under way is counted.
    pub(crate) fn is_over(&self) -> bool {
        self.is_over
    }

    pub fn begin_step(&mut self, time: Second) {
        let begin = *self.begin.get_or_insert(time);
        self.is_over |= time - begin >= self.lasts - SAME_MOMENT;
    }

    /// A road user enters the scene; those of the warm-up are counted if they are still there when it ends.
    pub fn enter(&mut self, category: Category, exposure: &mut Exposure) {
        let [vehicle, person] = [Category::Vehicle, Category::Person].map(|one| u64::from(one == category));
        for ((present, entered), one) in self.present.iter_mut().zip(&mut self.entered).zip([vehicle, person]) {
            *present += one;
            *entered += one;
        }
        if self.has_counted {
            exposure.vehicles += vehicle;
            exposure.persons += person;
        }
    }

    /// The vehicles and persons that ever were in the scene.
    pub fn entered(&self) -> [u64; 2] {
        self.entered
    }

    /// A road user leaves the scene.
    pub fn leave(&mut self, category: Category) {
        for (present, one) in self.present.iter_mut().zip([Category::Vehicle, Category::Person]) {
            *present -= u64::from(one == category);
        }
    }

    /// Counts the road users that are there in the first step that counts.
    pub(crate) fn count_present(&mut self, exposure: &mut Exposure) {
        if self.is_over && !self.has_counted {
            self.has_counted = true;
            [exposure.vehicles, exposure.persons] = self.present;
        }
    }

    /// What to tell at the end of a run that never left it.
    pub fn remark(&self) -> Option<Remark> {
        let lasted = !self.is_over && self.has_begun();
        lasted.then(|| {
            let text = format!(
                "warmup: the run ended before {} s had passed, so that nothing was counted",
                Written(self.lasts)
            );
            Remark::new(RemarkCode::OnlyWarmUp, text)
        })
    }
}
