//! Conflicts that the simulation makes of ordinary driving: by how closely its drivers follow, and how hard they can brake.

use typed_index_collections::{TiSlice, TiVec};

use closecall::detection::kind::Kind;
use closecall::events::Conflict;
use closecall::traffic::profile::{Category, Profile};
use closecall::traffic::roster::{ProfileIndex, Roster};
use closecall::util::index::row_of;
use closecall::util::remark::{Remark, RemarkCode};
use closecall::util::units::MetrePerSecondSquared;

/// An `emergencyDecel` above SUMO's default of passenger cars is worth a remark, in m/s²: hardly a tyre holds more on a dry
/// road.
const HARDEST: MetrePerSecondSquared = 9.0;
/// The number of types that a remark names.
const NAMED: usize = 5;

/// Conflicts by the type that they come from, in the order of the roster's profiles.
#[derive(Default)]
pub(super) struct OrdinaryDriving {
    conflicts: u64,
    following: TiVec<ProfileIndex, u64>,
    braking: TiVec<ProfileIndex, u64>,
}

impl OrdinaryDriving {
    /// Counts a conflict: the ego follows as usual, or the foe brakes harder than any car.
    pub fn count(&mut self, conflict: &Conflict, roster: &Roster) {
        self.conflicts += 1;
        let ego = roster.profile_at(conflict.ego_profile);
        if conflict.kind == Kind::RearEnd && conflict.ego_speed >= ego.tailgates_from {
            *row_of(&mut self.following, conflict.ego_profile, || 0) += 1;
        }
        let foe = roster.profile_at(conflict.foe_profile);
        if foe.category == Category::Vehicle && foe.brakes.deceleration > HARDEST {
            *row_of(&mut self.braking, conflict.foe_profile, || 0) += 1;
        }
    }

    /// A line for each way in which conflicts were made, with the types that come most often first.
    pub fn remarks(&self, roster: &Roster) -> Vec<Remark> {
        let follows = |of: &Profile| format!("{} from {:.0} km/h on", of.name, 3.6 * of.tailgates_from);
        let brakes = |of: &Profile| format!("{} with {} m/s²", of.name, of.brakes.deceleration);
        let (all, types) = (self.conflicts, |counts, text| types(counts, roster, text));
        let following = types(&self.following, &follows).map(|(count, types)| {
            format!(
                "ordinary following makes {count} of {all} conflicts: its headway (tau, minGap, actionStepLength) is below \
                 the response time of the model ({types})"
            )
        });
        let braking = types(&self.braking, &brakes).map(|(count, types)| {
            format!(
                "{count} of {all} conflicts have a foe that brakes harder than {HARDEST} m/s² (emergencyDecel: {types})"
            )
        });
        let found = [(RemarkCode::OrdinaryFollowing, following), (RemarkCode::HardBraking, braking)];
        found.into_iter().filter_map(|(code, text)| Some(Remark::new(code, text?))).collect()
    }
}

/// The sum of the counts and the types that have one, the largest first; none where no type has.
fn types(
    counts: &TiSlice<ProfileIndex, u64>,
    roster: &Roster,
    text: &dyn Fn(&Profile) -> String,
) -> Option<(u64, String)> {
    let mut of_types = counts.iter_enumerated().filter(|(_, count)| **count > 0).collect::<Vec<_>>();
    of_types.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
    let named = of_types.iter().take(NAMED).map(|(index, _)| text(roster.profile_at(*index)));
    let named = named.collect::<Vec<_>>().join(", ");
    let more = match of_types.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    (!of_types.is_empty()).then(|| (counts.iter().sum(), named + &more))
}

#[cfg(test)]
mod tests {
    use crate::options::RunOptions;
    use crate::run::Run;
    use crate::{Error, Result};
    use closecall::options::Options;
    use closecall::traffic::frame::State;
    use closecall::traffic::profile::Profile;
    use closecall::traffic::sumo_type::SumoType;

    /// The remarks of a run in which a follower of one type is 13 m behind a leader of another, both at 15 m/s.
    fn remarks(follower: SumoType, leader: SumoType) -> Vec<String> {
        let options = Options::default();
        let mut run = Run::new(&options.clone().into(), None).unwrap();
        let users = [follower, leader].map(|sumo| {
            let profile = run.roster.profile(Profile::vehicle(&sumo, &options)).unwrap();
            run.enter(&sumo.name, profile)
        });
        run.begin_step(0.0);
        for (user, x) in users.into_iter().zip([0.0, 18.0]) {
            run.frame.push(user, State { x, y: 0.0, z: 0.0, heading: 0.0, speed: 15.0 });
        }
        let stepped: Result<()> = run.step(|_, _| Ok::<_, Error>(()));
        stepped.unwrap();
        let summary = run.finish().unwrap();
        assert_eq!(summary.count(None, None), 1);
        summary.remarks.into_iter().map(|remark| remark.text).collect()
    }

    #[test]
    fn ordinary_following_is_named_with_its_type_and_share() {
        let hurried = SumoType { tau: 0.7, ..SumoType::car("hurried") };
        let found = remarks(hurried, SumoType::car("car"));
        let [line] = &found[..] else { panic!("{found:?}") };
        // It keeps 0.7 V + 2.5 m, and μ is 1.1 V + 0.5 m.
        assert!(line.starts_with("ordinary following makes 1 of 1 conflicts"), "{line}");
        assert!(line.ends_with("(hurried from 18 km/h on)"), "{line}");
    }

    #[test]
    fn a_driver_that_keeps_its_distance_is_not_named() {
        assert_eq!(remarks(SumoType { tau: 1.5, ..SumoType::car("calm") }, SumoType::car("car")), [""; 0]);
    }

    #[test]
    fn a_foe_that_brakes_harder_than_cars_is_named() {
        let strong = SumoType { emergency_decel: 10.0, ..SumoType::car("strong") };
        let found = remarks(SumoType { tau: 1.5, ..SumoType::car("calm") }, strong);
        assert_eq!(
            found,
            ["1 of 1 conflicts have a foe that brakes harder than 9 m/s² (emergencyDecel: strong with 10 m/s²)"]
        );
    }

    #[test]
    fn steps_above_a_tenth_of_a_second_are_long() {
        let run = Run::new(&RunOptions::default(), None).unwrap();
        let found = [0.1, 0.2].map(|length| run.opening_remarks(Some(length)).len());
        assert_eq!(found, [0, 1]);
    }
}
