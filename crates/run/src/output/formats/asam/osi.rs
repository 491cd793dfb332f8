//! A clip as a trace of ASAM OSI (Open Simulation Interface) 3: for each time the length of an `osi3.GroundTruth` in four bytes,
//! little-endian, and that message. Numbers of fields and of enumerations are those of OSI's `.proto` files.

use super::bodies::{Place, WHEEL, axle, box_around, class_of, places};
use super::protobuf::Message;
use closecall::events::{Clip, ClipCategory, ClipUser};
use closecall::util::units::{Metre, Second};

/// The version of OSI that the fields are taken from.
const VERSION: [u64; 3] = [3, 7, 0];

/// `MovingObject.Type`.
const VEHICLE: u64 = 2;
/// `MovingObject.Type`.
const PEDESTRIAN: u64 = 3;
/// `StationaryObject.Classification.Type`.
const OTHER: u64 = 1;

/// The trace. The ego is the host vehicle; an object's id is its place in the clip, counted from 1.
pub fn trace(clip: &Clip) -> Vec<u8> {
    let moving = clip.users.iter().zip(1..).filter(|(user, _)| user.category != ClipCategory::Obstacle);
    let moving = moving.map(|(user, id)| (user, id, places(user))).collect::<Vec<_>>();
    let parts = clip.users.iter().flat_map(|user| user.outlines.iter().map(move |part| (user, &part[..])));
    let stationary = parts.zip(clip.users.len() as u64 + 1..);
    let stationary = stationary.map(|((user, part), id)| stationary_object(user, part, id)).collect::<Vec<_>>();
    let mut bytes = Vec::new();
    for (step, time) in clip.times.iter().enumerate() {
        let mut truth = Message::default().message(1, version()).message(2, timestamp(*time)).message(3, identifier(1));
        for object in &stationary {
            truth = truth.message(4, object.clone());
        }
        for (user, id, places) in &moving {
            if let Some(place) = places[step] {
                truth = truth.message(5, moving_object(user, *id, place));
            }
        }
        bytes.extend((truth.encoded().len() as u32).to_le_bytes());
        bytes.extend(truth.encoded());
    }
    bytes
}

fn version() -> Message {
    let [major, minor, patch] = VERSION;
    Message::default().number(1, major).number(2, minor).number(3, patch)
}

fn timestamp(time: Second) -> Message {
    let nanoseconds = (time * 1e9).round() as i64;
    let [seconds, rest] = [nanoseconds.div_euclid(1_000_000_000), nanoseconds.rem_euclid(1_000_000_000)];
    Message::default().number(1, seconds as u64).number(2, rest as u64)
}

fn identifier(id: u64) -> Message {
    Message::default().number(1, id)
}

/// `Vector3d`, `Dimension3d` or `Orientation3d`, which have their fields in this order.
fn triple(values: [f64; 3]) -> Message {
    (1..).zip(values).fold(Message::default(), |message, (field, value)| message.double(field, value))
}

/// The id in SUMO, as an `ExternalReference`.
fn reference(user: &ClipUser) -> Message {
    let kind = match user.category {
        ClipCategory::Vehicle => "vehicle",
        ClipCategory::Person => "person",
        ClipCategory::Obstacle => "polygon",
    };
    Message::default().text(1, "SUMO").text(2, kind).text(3, &user.id)
}

/// A `MovingObject`; its position is the centre of its box.
fn moving_object(user: &ClipUser, id: u64, place: Place) -> Message {
    let class = class_of(user);
    let velocity = place.forward() * place.speed;
    let base = Message::default()
        .message(1, triple([user.length, user.width, class.height]))
        .message(2, triple([place.centre.x, place.centre.y, class.height / 2.0]))
        .message(3, triple([0.0, 0.0, place.heading]))
        .message(4, triple([velocity.x, velocity.y, 0.0]));
    let object = Message::default().message(1, identifier(id)).message(2, base);
    let object = if user.category == ClipCategory::Person {
        object.number(3, PEDESTRIAN)
    } else {
        let to_axle = |along: Metre| triple([along, 0.0, (WHEEL - class.height) / 2.0]);
        let attributes = Message::default().message(4, to_axle(-axle(user))).message(5, to_axle(axle(user)));
        object.number(3, VEHICLE).message(5, attributes).message(6, Message::default().number(1, class.osi))
    };
    object.message(10, reference(user))
}

/// A part of an obstacle as a `StationaryObject`: its box, and its outline from the box's centre.
fn stationary_object(user: &ClipUser, part: &[[Metre; 2]], id: u64) -> Message {
    let bounds = box_around(part);
    let (centre, size) = (nalgebra::center(&bounds.low, &bounds.high), bounds.size());
    let height = class_of(user).height;
    let mut base = Message::default()
        .message(1, triple([size.x, size.y, height]))
        .message(2, triple([centre.x, centre.y, height / 2.0]))
        .message(3, triple([0.0; 3]));
    for [x, y] in part {
        base = base.message(4, Message::default().double(1, x - centre.x).double(2, y - centre.y));
    }
    let classification = Message::default().number(1, OTHER);
    let object = Message::default().message(1, identifier(id)).message(2, base).message(3, classification);
    object.message(5, reference(user))
}
