//! The moving parts of a clip's picture: animated, or at one time of the clip.
//!
//! The animation is SVG's own (SMIL), which browsers play without a script: values at the times of a clip, in an endless loop.
//! The loop is real time, but it halts for a second at the worst step and another at the end. A still of each time makes a
//! film.

use std::fmt::Write;

use closecall::util::units::Second;

/// How long it halts, in s.
const HALT: Second = 1.0;

/// The times of a clip as those of a loop.
#[derive(Clone, Debug)]
pub(crate) struct Loop {
    /// For each key time, the place in the clip's lists.
    places: Vec<usize>,
    /// From 0 to 1.
    keys: Vec<f64>,
    duration: Second,
    /// Where in the loop, from 0 to 1, a picture stands that does not play.
    still: Option<f64>,
}

/// An attribute that changes.
#[derive(Debug)]
pub(crate) struct Changing {
    /// The attribute as it is at first, or in a still.
    pub first: String,
    /// The element within that changes it; empty in a still.
    pub changes: String,
}

impl Loop {
    /// That of these times, one at least, with a halt at one of them.
    pub fn new(times: &[Second], halt: usize) -> Self {
        let first = times.first().copied().unwrap_or_default();
        let mut at = Vec::new();
        for (place, time) in times.iter().enumerate() {
            let delay = if place > halt { HALT } else { 0.0 };
            at.push((place, time - first + delay));
            if place == halt {
                at.push((place, time - first + HALT));
            }
        }
        let last = at.last().copied().unwrap_or_default();
        at.push((last.0, last.1 + HALT));
        let duration = last.1 + HALT;
        let (places, keys) = at.into_iter().map(|(place, time)| (place, time / duration)).unzip();
        Self { places, keys, duration, still: None }
    }

    /// Stills of it, this many a second.
    pub fn stills(&self, rate: f64) -> impl Iterator<Item = Self> {
        let count = (self.duration * rate).round().max(1.0);
        (0..count as usize).map(move |still| Self { still: Some(still as f64 / count), ..self.clone() })
    }

    /// Whether it plays; otherwise it is a still.
    pub fn plays(&self) -> bool {
        self.still.is_none()
    }

    /// An attribute that changes steadily between the numbers of each place in the clip.
    pub fn smooth(&self, attribute: &str, value: impl Fn(usize) -> f64) -> Changing {
        let what = format!("attributeName=\"{attribute}\"");
        let value = |place: usize| [value(place)];
        Changing {
            first: format!("{attribute}=\"{}\"", self.first(value)),
            changes: self.steady("animate", &what, value),
        }
    }

    /// The same of a transformation: `translate` or `rotate`.
    pub(crate) fn transform<const N: usize>(&self, kind: &str, value: impl Fn(usize) -> [f64; N]) -> Changing {
        let what = format!("attributeName=\"transform\" type=\"{kind}\"");
        let first = format!("transform=\"{kind}({})\"", self.first(&value));
        Changing { first, changes: self.steady("animateTransform", &what, value) }
    }

    /// An attribute that jumps from one value to the next; no element changes it where it never does.
    pub fn jumps(&self, attribute: &str, value: impl Fn(usize) -> String) -> Changing {
        let first = format!("{attribute}=\"{}\"", value(self.places[self.key()]));
        let (mut values, mut keys) = (Vec::<String>::new(), Vec::new());
        for (place, key) in self.places.iter().zip(&self.keys) {
            let next = value(*place);
            if values.last() != Some(&next) {
                values.push(next);
                keys.push(*key);
            }
        }
        let what = format!("attributeName=\"{attribute}\" calcMode=\"discrete\"");
        let changes = if values.len() < 2 { String::new() } else { self.element("animate", &what, &values, &keys) };
        Changing { first, changes }
    }

    /// What is seen at these places only.
    pub fn seen(&self, is_seen: impl Fn(usize) -> bool, what: &str) -> String {
        if !self.plays() && !is_seen(self.places[self.key()]) {
            return String::new();
        }
        let Changing { first, changes } = self.jumps("opacity", |place| u8::from(is_seen(place)).to_string());
        if first == "opacity=\"1\"" && changes.is_empty() {
            return what.to_owned();
        }
        format!("<g {first}>{changes}{what}</g>")
    }

    /// The last key time that is not after the still's, the first where it plays.
    fn key(&self) -> usize {
        let still = self.still.unwrap_or_default();
        self.keys.partition_point(|key| *key <= still).saturating_sub(1)
    }

    /// The numbers at the still's time, between those of the key times around it.
    fn first<const N: usize>(&self, value: impl Fn(usize) -> [f64; N]) -> String {
        let key = self.key();
        let next = (key + 1).min(self.keys.len() - 1);
        let apart = self.keys[next] - self.keys[key];
        let share = if apart > 0.0 { (self.still.unwrap_or_default() - self.keys[key]) / apart } else { 0.0 };
        let [from, to] = [key, next].map(|key| value(self.places[key]));
        numbers(std::array::from_fn::<f64, N, _>(|axis| from[axis] + share * (to[axis] - from[axis])))
    }

    /// The element that changes numbers, without the key times between two that are the same: much stands still.
    fn steady<const N: usize>(&self, name: &str, what: &str, value: impl Fn(usize) -> [f64; N]) -> String {
        let values = self.places.iter().map(|place| numbers(value(*place))).collect::<Vec<_>>();
        let is_needed = |place: &usize| {
            let is_end = *place == 0 || place + 1 == values.len();
            is_end || values[*place] != values[place - 1] || values[*place] != values[place + 1]
        };
        let needed = (0..values.len()).filter(is_needed);
        let (values, keys) =
            needed.map(|place| (values[place].clone(), self.keys[place])).unzip::<_, _, Vec<_>, Vec<_>>();
        self.element(name, what, &values, &keys)
    }

    fn element(&self, name: &str, what: &str, values: &[String], keys: &[f64]) -> String {
        if !self.plays() {
            return String::new();
        }
        let mut times = String::new();
        for key in keys {
            let _ = write!(times, "{}{key:.4}", if times.is_empty() { "" } else { ";" });
        }
        let (values, duration) = (values.join(";"), self.duration);
        format!(
            "<{name} {what} values=\"{values}\" keyTimes=\"{times}\" dur=\"{duration:.2}s\" repeatCount=\"indefinite\"/>"
        )
    }
}

/// Numbers as SVG's attributes have them.
fn numbers<const N: usize>(values: [f64; N]) -> String {
    values.map(|value| format!("{value:.1}")).join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_halts_at_the_worst_step_and_at_the_end() {
        let all = Loop::new(&[10.0, 11.0, 12.0], 1);
        assert_eq!((all.duration, &all.places[..]), (4.0, &[0, 1, 1, 2, 2][..]));
        assert_eq!(all.keys, [0.0, 0.25, 0.5, 0.75, 1.0]);
        let jumps = all.jumps("fill", |place| ["a", "a", "b"][place].to_owned());
        assert!(jumps.changes.contains("values=\"a;b\" keyTimes=\"0.0000;0.7500\""), "{jumps:?}");
        assert_eq!(all.jumps("fill", |_| "a".to_owned()).changes, "");
        let stands = all.smooth("x", |_| 1.0);
        assert!(stands.changes.contains("values=\"1.0;1.0\" keyTimes=\"0.0000;1.0000\""), "{stands:?}");
    }

    #[test]
    fn stills_are_what_plays_at_their_times() {
        let all = Loop::new(&[10.0, 11.0, 12.0], 1);
        let mut places = Vec::new();
        for still in all.stills(2.0) {
            let at = still.transform("translate", |place| [place as f64, 0.0]);
            let colour = still.jumps("fill", |place| ["a", "a", "b"][place].to_owned());
            assert_eq!((&at.changes[..], &colour.changes[..]), ("", ""));
            places.push((at.first, colour.first, still.seen(|place| place == 2, "<a/>")));
        }
        let place = |x: &str, fill: &str, seen: &str| {
            (format!("transform=\"translate({x} 0.0)\""), format!("fill=\"{fill}\""), seen.to_owned())
        };
        let first = ["0.0", "0.5", "1.0", "1.0", "1.0", "1.5"].map(|x| place(x, "a", ""));
        let last = ["2.0", "2.0"].map(|x| place(x, "b", "<a/>"));
        assert_eq!(places, [&first[..], &last[..]].concat());
    }
}
