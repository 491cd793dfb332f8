//! SVG's own animation (SMIL), which browsers play without a script: values at the times of a clip, in an endless loop.
//!
//! The loop is real time, but it halts for a second at the worst step and another at the end.

use std::fmt::Write;

use crate::util::units::Second;

/// How long it halts, in s.
const HALT: Second = 1.0;

/// The times of a clip as those of a loop.
#[derive(Debug)]
pub struct Loop {
    /// For each key time, the place in the clip's lists.
    places: Vec<usize>,
    /// From 0 to 1.
    keys: Vec<f64>,
    duration: Second,
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
        Self { places, keys, duration }
    }

    /// An attribute that changes steadily between the values of each place in the clip.
    pub fn smooth(&self, attribute: &str, value: impl Fn(usize) -> String) -> String {
        let (values, keys) = self.steady(value);
        self.element("animate", &format!("attributeName=\"{attribute}\""), &values, &keys)
    }

    /// The same of a transformation: `translate` or `rotate`.
    pub fn transform(&self, kind: &str, value: impl Fn(usize) -> String) -> String {
        let (values, keys) = self.steady(value);
        let what = format!("attributeName=\"transform\" type=\"{kind}\"");
        self.element("animateTransform", &what, &values, &keys)
    }

    /// The values and their key times, without those between two that are the same: much stands still.
    fn steady(&self, value: impl Fn(usize) -> String) -> (Vec<String>, Vec<f64>) {
        let values = self.places.iter().map(|place| value(*place)).collect::<Vec<_>>();
        let is_needed = |place: &usize| {
            let is_end = *place == 0 || place + 1 == values.len();
            is_end || values[*place] != values[place - 1] || values[*place] != values[place + 1]
        };
        let needed = (0..values.len()).filter(is_needed);
        needed.map(|place| (values[place].clone(), self.keys[place])).unzip()
    }

    /// An attribute that jumps from one value to the next; nothing where it never changes.
    pub fn jumps(&self, attribute: &str, value: impl Fn(usize) -> String) -> String {
        let (mut values, mut keys) = (Vec::<String>::new(), Vec::new());
        for (place, key) in self.places.iter().zip(&self.keys) {
            let next = value(*place);
            if values.last() != Some(&next) {
                values.push(next);
                keys.push(*key);
            }
        }
        if values.len() < 2 {
            return String::new();
        }
        self.element("animate", &format!("attributeName=\"{attribute}\" calcMode=\"discrete\""), &values, &keys)
    }

    /// An element that is seen at these places only.
    pub fn visible(&self, is_seen: impl Fn(usize) -> bool) -> String {
        self.jumps("opacity", |place| u8::from(is_seen(place)).to_string())
    }

    fn element(&self, name: &str, what: &str, values: &[String], keys: &[f64]) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_halts_at_the_worst_step_and_at_the_end() {
        let all = Loop::new(&[10.0, 11.0, 12.0], 1);
        assert_eq!((all.duration, &all.places[..]), (4.0, &[0, 1, 1, 2, 2][..]));
        assert_eq!(all.keys, [0.0, 0.25, 0.5, 0.75, 1.0]);
        let jumps = all.jumps("fill", |place| ["a", "a", "b"][place].to_owned());
        assert!(jumps.contains("values=\"a;b\" keyTimes=\"0.0000;0.7500\""), "{jumps}");
        assert_eq!(all.jumps("fill", |_| "a".to_owned()), "");
        let stands = all.smooth("x", |_| "1".to_owned());
        assert!(stands.contains("values=\"1;1\" keyTimes=\"0.0000;1.0000\""), "{stands}");
    }
}
