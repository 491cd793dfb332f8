//! How the pair of an event first struck each other.
//!
//! A step ends some time after the contact: by then one may have turned or stopped, and the two overlap somehow. The first
//! contact is found between the steps, so the kind and place of a collision do not depend on them.

use super::moment::Moment;
use super::past::Past;
use super::substep::FirstContact;
use crate::detection::kind::Kind;
use crate::detection::measures;
use crate::geometry::{Point, Vector, angle_between};
use crate::options::thresholds::KindBounds;
use crate::traffic::profile::{Category, Profile};
use crate::traffic::roster::UserIndex;
use crate::util::units::{Metre, MetrePerSecond, Radian, Second};

/// A person's course is the direction in which it has gone this far, in m: SUMO turns a person across its way if it steps aside
/// or is about to be hit.
const WALKED: Metre = 0.5;

/// The first contact of two.
#[derive(Clone, Copy, Debug)]
pub(super) struct Struck {
    /// When, in s.
    pub time: Second,
    pub kind: Kind,
    /// The angle between the courses of both.
    pub angle: Radian,
    /// The two, and in their order what follows.
    pair: [UserIndex; 2],
    /// The front-bumper centres.
    fronts: [Point; 2],
    speeds: [MetrePerSecond; 2],
    pub delta_v: [MetrePerSecond; 2],
}

impl Struck {
    /// That of a contact of a pair.
    pub fn of(
        contact: &FirstContact,
        (pair, profiles): ([UserIndex; 2], [&Profile; 2]),
        past: &Past,
        kinds: KindBounds,
    ) -> Self {
        let [a, b] = [0, 1].map(|one| course(contact, one, (pair[one], profiles[one]), past));
        let angle = angle_between(&a, &b);
        let [of_a, of_b] = [0, 1].map(|one| (contact.speeds[one], profiles[one].mass));
        Self {
            time: contact.time,
            kind: Kind::at(angle, kinds),
            angle,
            pair,
            fronts: contact.fronts,
            speeds: contact.speeds,
            delta_v: measures::delta_v(of_a, of_b, angle),
        }
    }

    /// Where the front bumper of one of the two was.
    pub fn front_of(&self, user: UserIndex) -> Point {
        self.fronts[self.place_of(user)]
    }

    /// When, where and how fast one of the two was.
    pub fn moment_of(&self, user: UserIndex) -> Moment {
        let front = self.front_of(user);
        Moment { time: self.time, x: front.x, y: front.y, speed: self.speeds[self.place_of(user)] }
    }

    fn place_of(&self, user: UserIndex) -> usize {
        usize::from(user == self.pair[1])
    }
}

/// The direction in which one of the two was going: that of its front, or of a person's way.
fn course(contact: &FirstContact, one: usize, (user, profile): (UserIndex, &Profile), past: &Past) -> Vector {
    if profile.category != Category::Person {
        return contact.axes[one];
    }
    let displacements = past.of(user, contact.time).map(|(_, place, _)| contact.fronts[one] - place);
    displacements
        .filter(|displacement| displacement.norm() >= WALKED)
        .last()
        .map_or(contact.axes[one], |displacement| displacement.normalize())
}
