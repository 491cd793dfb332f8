//! Lapses of all drivers: plain simulation of errors, against which `closecall rare` is checked.

use fastrand::Rng;
use rustc_hash::FxHashSet;

use super::super::Run;
use super::plan::{DriverError, ErringDriver, Lapses};
use closecall::traffic::profile::Category;
use closecall::traffic::roster::UserIndex;

/// Draws the drivers that lapse in the conflicts that open.
#[derive(Debug)]
pub(super) struct Lapsing {
    share: f64,
    random: Rng,
    /// The pairs in conflict in the last step.
    open: FxHashSet<[UserIndex; 2]>,
}

impl Lapsing {
    pub fn new(asked: Lapses) -> Self {
        Self { share: asked.share, random: Rng::with_seed(asked.seed), open: FxHashSet::default() }
    }

    /// The drivers that lapse in the conflicts that this step opens.
    pub fn step(&mut self, run: &Run) -> Vec<ErringDriver> {
        let pair = |alarm: &closecall::Alarm| [alarm.ego.min(alarm.foe), alarm.ego.max(alarm.foe)];
        let mut alarms = run.alarms().collect::<Vec<_>>();
        alarms.sort_unstable_by_key(pair);
        let before = std::mem::replace(&mut self.open, alarms.iter().map(pair).collect());
        let mut drivers = Vec::new();
        for alarm in alarms.iter().filter(|alarm| !before.contains(&pair(alarm))) {
            let [chance, response, deceleration] = std::array::from_fn(|_| self.random.f64());
            let is_vehicle = |user: UserIndex| run.roster.profile_of(user).category == Category::Vehicle;
            let (ego, foe) = if is_vehicle(alarm.ego) { (alarm.ego, alarm.foe) } else { (alarm.foe, alarm.ego) };
            if chance < self.share && is_vehicle(ego) {
                let [id, foe] = [ego, foe].map(|user| run.roster.id(user).to_string());
                let from = Some(run.frame.time);
                drivers.push(ErringDriver { id, foe, error: DriverError::Late, from, response, deceleration });
            }
        }
        drivers
    }
}
