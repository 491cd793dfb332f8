//! What is recorded of one pair, from which the clips of its conflicts are cut.

use ecow::EcoString;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::clip::{AFTER, AROUND, BEFORE, Clip, ClipCategory, ClipSignal, ClipUser};
use super::recent::{Place, Recent, RecentStep};
use crate::detection::kind::Severity;
use crate::events::event::Conflict;
use crate::events::under_way::Pair;
use crate::geometry::Point;
use crate::geometry::polygon::Polygon;
use crate::traffic::net::{Net, Signal};
use crate::traffic::profile::Category;
use crate::traffic::roster::{Roster, UserIndex};
use crate::traffic::signals::Signals;
use crate::util::units::Second;

/// What a signal shows where it is not known: SUMO's letter for a light that is off and gives no way.
const UNKNOWN: u8 = b'O';

/// A moment around which the pair is shown, and where.
type Moment = (Second, Point);

/// The recording of a pair whose event is, or was, severe enough.
#[derive(Debug)]
pub(super) struct Take {
    pub pair: Pair,
    /// Whether an event of the pair is under way, so that the indices are its own.
    pub is_open: bool,
    /// The same, as far as this step has told.
    pub is_under_way: bool,
    /// When it became severe enough.
    since: Second,
    /// The pair, then all that came near.
    users: Vec<ClipUser>,
    /// By id, the place among these.
    numbers: FxHashMap<EcoString, usize>,
    steps: Vec<Step>,
    signals: Vec<(Signal, ClipSignal)>,
    moments: SmallVec<[Moment; 1]>,
    /// The conflicts that the event has become.
    conflicts: SmallVec<[Logged; 1]>,
}

/// A conflict in the log.
#[derive(Debug)]
struct Logged {
    number: u64,
    moment: Moment,
    /// The ego's place in [`Take::users`], 0 or 1.
    ego: usize,
}

/// What is copied of a step.
#[derive(Debug)]
struct Step {
    time: Second,
    severity: Option<Severity>,
    time_left: Option<Second>,
    /// By the place in [`Take::users`].
    places: Vec<(u32, Place)>,
    /// A letter for each of the signals.
    shown: Vec<u8>,
}

/// What a recording is made from.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub recent: &'a Recent,
    pub roster: &'a Roster,
    pub net: Option<&'a Net>,
    pub signals: &'a Signals,
}

impl Take {
    /// That of a pair whose event has just become severe enough.
    pub fn of(pair: Pair, since: Second, worst: &[Moment], source: &Source) -> Self {
        let at = worst.first().zip(source.net);
        let mut take = Self {
            pair,
            is_open: true,
            is_under_way: true,
            since,
            users: pair.map(|user| user_at(user, since, source)).into(),
            numbers: pair.into_iter().zip(0..).map(|(user, of)| (source.roster.id(user).clone(), of)).collect(),
            steps: Vec::new(),
            signals: at.map_or_else(Vec::new, |((_, at), net)| signals_near(net, *at, source.signals, since)),
            moments: SmallVec::new(),
            conflicts: SmallVec::new(),
        };
        take.add_moments(worst);
        take
    }

    /// Begins a step of a pair whose events were under way: which of them still are is to be told.
    pub fn begin_step(&mut self) {
        self.moments = self.conflicts.iter().map(|logged| logged.moment).collect();
        self.is_under_way = false;
    }

    /// Adds the worst moments so far of an event that is under way. Instead of one from long before the event became severe
    /// enough, that moment is shown.
    pub(crate) fn add_moments(&mut self, worst: &[Moment]) {
        let since = self.since;
        self.moments.extend(worst.iter().map(|(time, at)| (time.max(since), *at)));
        self.is_under_way = true;
    }

    /// Takes a conflict that has closed, if it is one of this pair and severe enough.
    pub fn close(&mut self, number: u64, conflict: &Conflict, least: Severity) {
        let [one, other] = [&*self.users[0].id, &*self.users[1].id];
        let (ego, foe) = (&*conflict.ego, &*conflict.foe);
        if conflict.severity < least || [ego, foe] != [one, other] && [ego, foe] != [other, one] {
            return;
        }
        let moment = (conflict.time.max(self.since), Point::new(conflict.x, conflict.y));
        self.conflicts.push(Logged { number, moment, ego: usize::from(ego != one) });
    }

    /// Copies the steps that are new, and forgets those that no moment needs any more.
    pub fn take(&mut self, source: &Source) {
        let is_wanted = |time: Second, moments: &[Moment]| {
            moments.iter().any(|(moment, _)| (moment - BEFORE..=moment + AFTER).contains(&time))
        };
        self.steps.retain(|step| is_wanted(step.time, &self.moments));
        let last = self.steps.last().map_or(Second::NEG_INFINITY, |step| step.time);
        for step in source.recent.since(last) {
            if is_wanted(step.time, &self.moments) {
                let copy = self.copy(step, source);
                self.steps.push(copy);
            }
        }
    }

    fn copy(&mut self, step: &RecentStep, source: &Source) -> Step {
        let time = step.time;
        let is_of = |user: UserIndex, of: &ClipUser| *source.recent.who(user, time, source.roster).0 == *of.id;
        let place_of = |of: usize| {
            step.places.iter().find(|place| place.user == self.pair[of] && is_of(place.user, &self.users[of]))
        };
        let pair = [place_of(0), place_of(1)];
        let at = |place: &Place| Point::new(place.x, place.y);
        let centres = self.moments.iter().map(|(_, at)| *at).chain(pair.into_iter().flatten().map(at));
        let centres = centres.collect::<SmallVec<[Point; 4]>>();
        let is_near = |place: &&Place| {
            let from = |centre: &Point| (at(place) - centre).norm_squared();
            centres.iter().any(|centre| from(centre) <= AROUND * AROUND)
        };
        let danger = step.dangers.iter().find(|danger| danger.pair == self.pair && pair.iter().all(Option::is_some));
        let (severity, time_left) = (danger.map(|danger| danger.severity), danger.and_then(|danger| danger.time_left));
        let near = step.places.iter().filter(is_near).collect::<Vec<_>>();
        let places = near.into_iter().map(|place| (self.number(place.user, time, source) as u32, *place)).collect();
        let shown = self.signals.iter().map(|(signal, _)| source.signals.at(*signal, time).map_or(UNKNOWN, |at| at.0));
        Step { time, severity, time_left, places, shown: shown.collect() }
    }

    /// The place in [`Take::users`] of a road user.
    fn number(&mut self, user: UserIndex, time: Second, source: &Source) -> usize {
        let (id, _) = source.recent.who(user, time, source.roster);
        if let Some(number) = self.numbers.get(id) {
            return *number;
        }
        self.users.push(user_at(user, time, source));
        self.numbers.insert(id.clone(), self.users.len() - 1);
        self.users.len() - 1
    }

    /// Whether nothing more is wanted at this time.
    pub fn is_done(&self, time: Second) -> bool {
        !self.is_open && self.moments.iter().all(|(moment, _)| time >= moment + AFTER)
    }

    /// Its clips, one for each conflict.
    pub fn clips(&self) -> impl Iterator<Item = Clip> {
        self.conflicts.iter().map(|logged| self.cut(logged))
    }

    fn cut(&self, &Logged { number, moment: (moment, _), ego }: &Logged) -> Clip {
        let shown = moment - BEFORE..=moment + AFTER;
        let steps = self.steps.iter().filter(|step| shown.contains(&step.time)).collect::<Vec<_>>();
        let mut users = self.users.clone();
        for (of, user) in users.iter_mut().enumerate() {
            for step in &steps {
                let place = step.places.iter().find(|place| place.0 as usize == of).map(|place| place.1);
                user.x.push(place.map(|place| rounded(place.x, 2)));
                user.y.push(place.map(|place| rounded(place.y, 2)));
                user.heading.push(place.map(|place| rounded(place.heading.into(), 3)));
                user.speed.push(place.map(|place| rounded(place.speed.into(), 2)));
            }
        }
        users.swap(0, ego);
        let others = users.split_off(2);
        users.extend(others.into_iter().filter(|user| user.x.iter().any(Option::is_some)));
        let signals = self.signals.iter().enumerate().map(|(place, (_, signal))| ClipSignal {
            states: steps.iter().map(|step| char::from(step.shown[place])).collect(),
            ..signal.clone()
        });
        Clip {
            conflict: number,
            times: steps.iter().map(|step| rounded(step.time, 3)).collect(),
            severity: steps.iter().map(|step| step.severity).collect(),
            time_left: steps.iter().map(|step| step.time_left.map(|left| rounded(left, 2))).collect(),
            users,
            signals: signals.collect(),
        }
    }
}

/// A road user of a clip that had this index at a time, without its places.
fn user_at(user: UserIndex, time: Second, source: &Source) -> ClipUser {
    let (id, profile) = source.recent.who(user, time, source.roster);
    let profile = source.roster.profile_at(profile);
    let corners = |part: &Polygon| {
        part.outline.corners().iter().map(|corner| [rounded(corner.x, 2), rounded(corner.y, 2)]).collect()
    };
    ClipUser {
        id: id.to_string(),
        category: match profile.category {
            Category::Vehicle => ClipCategory::Vehicle,
            Category::Person => ClipCategory::Person,
            Category::Obstacle => ClipCategory::Obstacle,
        },
        class: profile.class.clone(),
        length: profile.length,
        width: profile.width,
        outlines: source.roster.shape(user).iter().map(corners).collect(),
        ..ClipUser::default()
    }
}

/// The signals around a place of which it is known what they show.
fn signals_near(net: &Net, at: Point, signals: &Signals, time: Second) -> Vec<(Signal, ClipSignal)> {
    let nearby = net.signals_near(at, AROUND);
    let known = nearby.filter(|(signal, _)| signals.at(*signal, time).is_some());
    let named = known.map(|(signal, lane)| {
        let light = net.lights[signal.light as usize].clone();
        (signal, ClipSignal { light, index: signal.index, lane: net.lane_id(lane).to_owned(), states: String::new() })
    });
    named.collect()
}

/// A number with this many decimals: short in the file.
fn rounded(value: f64, decimals: i32) -> f64 {
    let tens = 10_f64.powi(decimals);
    (value * tens).round() / tens
}
