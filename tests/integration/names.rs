//! Neither the names of road users, nor the order of their rows, nor the direction in which a scene lies decides anything.

use std::f64::consts::{FRAC_PI_2, PI};

use closecall::{Conflict, Options, Profile, State, SumoType};
use closecall_run::{Error, Run};
use proptest::prelude::*;

/// How long a step lasts, in s.
const STEP: f64 = 0.5;
/// Steps of a scene.
const STEPS: u32 = 16;
/// What turning a scene may change a value by: the sweep's tolerance, 0.1 mm, at the largest ratio of any value to a distance.
const TURNED: f64 = 2e-3;

/// Vehicles that go straight on, each longer than the one before, so that no two are mirror images of each other.
#[derive(Clone, Debug)]
struct Scene(Vec<State>);

impl Scene {
    /// The conflicts, in the order of their times and of the vehicles, each of which is known by its place in the scene.
    /// `names` has the place of each vehicle's name, `rows` the order in which they enter and are listed in a frame.
    fn conflicts(&self, names: &[usize], rows: &[usize]) -> Vec<Conflict> {
        let options = Options { log: "margin < 0".parse().unwrap(), ..Options::default() };
        let mut run = Run::new(&options.clone().into(), None).unwrap();
        let name = |vehicle: usize| char::from(b'a' + names[vehicle] as u8).to_string();
        let profiles = (0..self.0.len()).map(|vehicle| {
            let sumo = SumoType { length: 4.0 + 0.5 * vehicle as f64, ..SumoType::car(&format!("car{vehicle}")) };
            run.roster.profile(Profile::vehicle(&sumo, &options)).unwrap()
        });
        let profiles = profiles.collect::<Vec<_>>();
        let users = rows.iter().map(|row| (*row, run.enter(&name(*row), profiles[*row]))).collect::<Vec<_>>();
        for step in 0..STEPS {
            let time = f64::from(step) * STEP;
            run.begin_step(time);
            for (vehicle, user) in &users {
                let state = self.0[*vehicle];
                let (sine, cosine) = state.heading.sin_cos();
                let driven = state.speed * time;
                run.frame.push(*user, State { x: state.x + driven * cosine, y: state.y + driven * sine, ..state });
            }
            run.step(|_, _| Ok::<_, Error>(())).unwrap();
        }
        run.finish().unwrap();
        let vehicle_of = |id: &str| {
            let place = (0..self.0.len()).find(|vehicle| name(*vehicle) == id).unwrap();
            place.to_string().into()
        };
        let mut conflicts = run.conflicts();
        for conflict in &mut conflicts {
            (conflict.ego, conflict.foe) = (vehicle_of(&conflict.ego), vehicle_of(&conflict.foe));
        }
        conflicts.sort_by(|a, b| {
            let key = |of: &Conflict| [of.ego.clone().min(of.foe.clone()), of.ego.clone().max(of.foe.clone())];
            a.begin.total_cmp(&b.begin).then_with(|| key(a).cmp(&key(b)))
        });
        conflicts
    }

    /// The same where no two touch, or pass a place at a step, exactly: rounding would decide, and a turn rounds.
    fn untied(&self) -> Self {
        let moved = |(state, number): (&State, f64)| State {
            x: state.x + 0.0137 * number,
            y: state.y + 0.0071 * number,
            ..*state
        };
        Self(self.0.iter().zip((0..).map(f64::from)).map(moved).collect())
    }

    /// The scene turned about the origin.
    fn turned(&self, by: f64) -> Self {
        let (sine, cosine) = by.sin_cos();
        let turned = |state: &State| State {
            x: state.x * cosine - state.y * sine,
            y: state.x * sine + state.y * cosine,
            heading: state.heading + by,
            ..*state
        };
        Self(self.0.iter().map(turned).collect())
    }
}

prop_compose! {
    /// Of few speeds, lanes and directions, so that many are alike.
    fn vehicle()(
        x in -50.0..50.0, lane in 0..4, heading in prop::sample::select(vec![0.0, PI, FRAC_PI_2, -FRAC_PI_2, 0.4]),
        speed in prop::sample::select(vec![0.0, 5.0, 10.0]), is_upright in any::<bool>(),
    ) -> State {
        let aside = f64::from(lane) * 1.5;
        let (x, y) = if is_upright { (aside, x) } else { (x, aside) };
        State { x, y, z: 0.0, heading, speed }
    }
}

fn scene() -> impl Strategy<Value = (Scene, Vec<usize>, Vec<usize>)> {
    prop::collection::vec(vehicle(), 2..7).prop_flat_map(|vehicles| {
        let order = (0..vehicles.len()).collect::<Vec<_>>();
        (Just(Scene(vehicles)), Just(order.clone()).prop_shuffle(), Just(order).prop_shuffle())
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn other_names_and_another_order_change_nothing((scene, names, rows) in scene()) {
        let order = (0..scene.0.len()).collect::<Vec<_>>();
        prop_assert_eq!(scene.conflicts(&order, &order), scene.conflicts(&names, &rows));
    }

    #[test]
    fn a_scene_that_is_turned_has_the_same_conflicts((scene, names, rows) in scene(), by in -PI..PI) {
        let scene = scene.untied();
        let order = (0..scene.0.len()).collect::<Vec<_>>();
        let [found, turned] = [scene.conflicts(&order, &order), scene.turned(by).conflicts(&names, &rows)];
        prop_assert_eq!(found.len(), turned.len());
        for (a, b) in found.iter().zip(&turned) {
            prop_assert_eq!((&a.ego, &a.foe, a.kind, a.severity, a.collision), (&b.ego, &b.foe, b.kind, b.severity, b.collision));
            let values = |of: &Conflict| {
                [
                    Some(of.begin), Some(of.time), Some(of.gap), Some(of.mu), Some(of.clearance), of.values.ttc(), of.pet,
                    of.values.response_left(), Some(of.ego_delta_v), Some(of.foe_delta_v), Some(of.ego_speed), Some(of.angle),
                ]
            };
            for (a, b) in values(a).into_iter().zip(values(b)) {
                let (a, b) = (a.unwrap_or(-1.0), b.unwrap_or(-1.0));
                prop_assert!((a - b).abs() <= TURNED * (1.0 + a.abs()), "{a} and {b} of {found:?} and {turned:?}");
            }
        }
    }
}
