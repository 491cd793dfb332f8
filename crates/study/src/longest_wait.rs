//! How long a driver can wait: in closed form, by halving μ, or by small steps.

use std::hint::black_box;

use super::clock::{Timed, interleaved};
use super::measurement::{Axis, Measurement, Plan};
use super::reference::braking;
use super::reference::chance::Chance;
use closecall::braking::{Brakes, Braking, LateBraking, Leader, MuModel, mu, response_left};
use closecall::util::units::{Metre, Second};

const SCENES: [&str; 2] = ["response left", "time to brake"];
const STEPS: [Second; 3] = [0.1, 0.01, 0.001];
/// Waits up to this are looked for, in s.
const LONGEST: Second = 10.0;
/// A wait whose error is larger than this counts as too long or too short, in s.
const NOTICED: Second = 0.01;

/// A driver behind a leader.
struct Follower {
    braking: LateBraking,
    leader: Leader,
}

impl Follower {
    /// One that has to brake within [`LONGEST`], and still can. For the response left its leader brakes fully now.
    fn draw(chance: &mut Chance, scene: &str) -> Self {
        loop {
            let deceleration = chance.between(5.0, 9.0);
            let [present, of_leader] = [chance.between(0.0, 4.0), chance.between(0.0, 4.0)];
            let leader_speed = chance.between(1.0, 40.0);
            let is_left = scene == SCENES[0];
            let found = Self {
                braking: LateBraking {
                    speed: chance.between(1.0, 40.0),
                    present: if is_left { 0.0 } else { chance.pick(&[0.0, present]) },
                    build_up: 0.1,
                    deceleration,
                },
                leader: Leader {
                    room: chance.between(1.0, 80.0),
                    speed: leader_speed,
                    deceleration: if is_left { deceleration } else { chance.pick(&[0.0, of_leader]) },
                },
            };
            if found.keeps_clear(0.0) && !found.keeps_clear(LONGEST) {
                return found;
            }
        }
    }

    /// Whether it keeps clear of its leader after a wait, in high precision.
    fn keeps_clear(&self, wait: Second) -> bool {
        braking::least_room_behind(&self.leader, &self.braking, Some(wait)) >= super::reference::precise(0.0)
    }

    /// The same by small steps.
    fn keeps_clear_by_steps(&self, wait: Second, step: Second) -> bool {
        let Self { braking, leader } = self;
        let [mut speed, mut of_leader] = [braking.speed, leader.speed];
        let mut room = leader.room;
        let mut time = 0.0;
        while room >= 0.0 && speed > 0.0 && (speed > of_leader || leader.deceleration > 0.0 || time < wait) {
            let built_up = ((time + step / 2.0 - wait) / braking.build_up).clamp(0.0, 1.0);
            let deceleration = braking.present + (braking.deceleration - braking.present) * built_up;
            let next = (speed - deceleration * step).max(0.0);
            let next_of_leader = (of_leader - leader.deceleration * step).max(0.0);
            room += (of_leader + next_of_leader - speed - next) / 2.0 * step;
            (speed, of_leader) = (next, next_of_leader);
            time += step;
        }
        room >= 0.0
    }

    fn response_left(&self) -> Second {
        self.with_gap(|ego, foe, gap| response_left(MuModel::Minimal, ego, foe, 1.0, 0.0, gap))
    }

    fn mu(&self, response: Second) -> Metre {
        self.with_gap(|ego, foe, _| {
            let brakes = Brakes { response, ..*ego.brakes };
            mu(MuModel::Minimal, Braking { brakes: &brakes, ..ego }, foe, 1.0, 0.0)
        })
    }

    fn with_gap<T>(&self, of: impl FnOnce(Braking, Braking, Metre) -> T) -> T {
        let LateBraking { speed, build_up, deceleration, .. } = self.braking;
        let brakes = Brakes { response: 0.0, build_up, deceleration };
        let of_leader = Brakes { response: 0.0, build_up: 0.0, deceleration: self.leader.deceleration };
        let ego = Braking { speed, brakes: &brakes };
        of(ego, Braking { speed: self.leader.speed, brakes: &of_leader }, self.leader.room)
    }
}

/// A method that finds the longest wait.
#[derive(Clone, Copy)]
enum Method {
    Closed,
    HalvedMu,
    Steps(Second),
}

impl Method {
    fn wait(self, follower: &Follower, scene: &str) -> Second {
        match self {
            Self::Closed if scene == SCENES[0] => follower.response_left(),
            Self::Closed => follower.braking.longest_wait_behind(&follower.leader),
            Self::HalvedMu => halved(1e-9, |wait| follower.mu(wait) <= follower.leader.room),
            Self::Steps(step) => halved(step, |wait| follower.keeps_clear_by_steps(wait, step)),
        }
    }
}

/// The longest wait that keeps clear, to a precision.
fn halved(precision: Second, keeps_clear: impl Fn(Second) -> bool) -> Second {
    let [mut low, mut high] = [0.0, LONGEST];
    while high - low > precision {
        let middle = (low + high) / 2.0;
        *(if keeps_clear(middle) { &mut low } else { &mut high }) = middle;
    }
    low
}

pub(super) fn measure(plan: &Plan) -> Vec<Measurement> {
    let (count, rounds) = if plan.quick { (50, 3) } else { (1_000, 5) };
    let mut rows = Vec::new();
    for scene in SCENES {
        let mut chance = Chance::new(1);
        let followers = (0..count).map(|_| Follower::draw(&mut chance, scene)).collect::<Vec<_>>();
        let truth = followers.iter().map(|one| halved(1e-12, |wait| one.keeps_clear(wait))).collect::<Vec<_>>();
        let mut methods = vec![("closed form", String::new(), Method::Closed)];
        if scene == SCENES[0] {
            methods.push(("mu by halves", String::new(), Method::HalvedMu));
        }
        methods.extend(STEPS.map(|step| ("small steps", format!(", step {step} s"), Method::Steps(step))));
        let timed = |(_, _, method): &(_, _, Method)| {
            // The closed form is faster than the clock's resolution.
            let again = if matches!(method, Method::Closed) { 200 } else { 1 };
            let (method, followers) = (*method, &followers);
            Timed::new(count * again, move || {
                for follower in std::iter::repeat_n(followers, again).flatten() {
                    black_box(method.wait(black_box(follower), scene));
                }
            })
        };
        let times = interleaved(&mut methods.iter().map(timed).collect::<Vec<_>>(), rounds);
        for ((name, parameter, method), ns_per_item) in methods.into_iter().zip(times) {
            let off = followers.iter().zip(&truth).map(|(one, truth)| method.wait(one, scene) - truth);
            let off = off.collect::<Vec<_>>();
            let share = |is: fn(f64) -> bool| off.iter().filter(|off| is(**off)).count() as f64 / count as f64;
            rows.push(Measurement {
                axis: Axis::Late,
                method: name,
                parameter: format!("{scene}{parameter}"),
                error_name: "largest error of the wait, s",
                error: off.iter().map(|off| off.abs()).fold(0.0, f64::max),
                false_negative_rate: share(|off| off > NOTICED),
                false_positive_rate: share(|off| off < -NOTICED),
                ns_per_item,
                items: count,
                on_pareto_front: false,
                scene: scene.to_owned(),
                default: matches!(method, Method::Closed),
            });
        }
    }
    rows
}
