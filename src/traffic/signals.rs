//! What the traffic lights have shown in the last seconds.

use super::net::Signal;
use crate::util::units::Second;

/// How long states are kept, in s: longer than it takes to pass a junction, and an amber before that.
const KEPT: Second = 30.0;

/// The states of all traffic lights of a net; empty where they are not known.
#[derive(Clone, Debug, Default)]
pub struct Signals {
    /// By traffic light, each state and since when, the oldest first.
    lights: Vec<Vec<(Second, Box<str>)>>,
}

impl Signals {
    /// Sets what a traffic light shows from now on: SUMO's letter for each of its links.
    pub fn set(&mut self, light: u32, time: Second, state: &str) {
        let light = light as usize;
        if self.lights.len() <= light {
            self.lights.resize_with(light + 1, Vec::new);
        }
        let states = &mut self.lights[light];
        if states.last().is_none_or(|(_, last)| **last != *state) {
            let old = states.iter().skip(1).take_while(|(since, _)| *since < time - KEPT).count();
            states.drain(..old);
            states.push((time, state.into()));
        }
    }

    /// What a link was shown at a time, and since when; none where that is not known.
    pub fn at(&self, signal: Signal, time: Second) -> Option<(u8, Second)> {
        let states = self.lights.get(signal.light as usize)?;
        let until = states.partition_point(|(since, _)| *since <= time);
        let shown = |state: &str| state.as_bytes().get(signal.index as usize).copied();
        let now = shown(&states[..until].last()?.1)?;
        let same = states[..until].iter().rev().take_while(|(_, state)| shown(state) == Some(now));
        same.last().map(|(since, _)| (now, *since))
    }
}

#[cfg(test)]
mod tests {
    use crate::traffic::signals::*;

    #[test]
    fn a_link_has_its_letter_since_it_last_changed() {
        let mut signals = Signals::default();
        for (time, state) in [(0.0, "Gr"), (1.0, "Gr"), (5.0, "yr"), (8.0, "rr"), (9.0, "rG")] {
            signals.set(1, time, state);
        }
        let at = |index, time| signals.at(Signal { light: 1, index }, time);
        assert_eq!(
            [4.9, 5.0, 7.0, 10.0].map(|time| at(0, time)),
            [Some((b'G', 0.0)), Some((b'y', 5.0)), Some((b'y', 5.0)), Some((b'r', 8.0))]
        );
        assert_eq!((at(1, 8.5), at(1, 9.0)), (Some((b'r', 0.0)), Some((b'G', 9.0))));
        assert_eq!((at(2, 9.0), at(0, -1.0), signals.at(Signal { light: 7, index: 0 }, 9.0)), (None, None, None));
    }

    #[test]
    fn states_of_long_ago_are_forgotten() {
        let mut signals = Signals::default();
        (0..100).for_each(|time| signals.set(0, f64::from(time), if time % 2 == 0 { "G" } else { "r" }));
        assert_eq!(signals.lights[0].len(), 32);
        assert_eq!(signals.at(Signal { light: 0, index: 0 }, 70.0), Some((b'G', 70.0)));
    }
}
