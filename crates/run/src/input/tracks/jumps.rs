//! Jumps of tracks, and identities that two road users exchange: counted, and reported with the first of each.

use super::kalman::Jump;
use crate::util::decimal::Written;

/// Jumps that are compared with each other: a recording with more is useless.
const COMPARED: usize = 1 << 16;
/// Each of two that exchange their identities is so much nearer to where the other was expected.
const NEARER: f64 = 0.5;

/// What is known of the jumps of a recording.
#[derive(Default)]
pub(super) struct Jumps {
    count: u64,
    jumps: Vec<Jump>,
}

impl Jumps {
    /// Adds a jump.
    pub fn add(&mut self, jump: Jump) {
        self.count += 1;
        if self.jumps.len() < COMPARED {
            self.jumps.push(jump);
        }
    }

    /// A line for the jumps and one for the exchanged identities, if there are any; `id` tells the id of a road user.
    pub fn remarks<'a>(mut self, id: impl Fn(u32) -> &'a str) -> Vec<String> {
        self.jumps.sort_by(|a, b| a.time.total_cmp(&b.time).then(a.user.cmp(&b.user)));
        let mut exchanged = vec![false; self.jumps.len()];
        let mut pairs = Vec::new();
        let mut first = 0;
        while let Some(jump) = self.jumps.get(first) {
            let many = self.jumps[first..].iter().take_while(|other| other.time == jump.time).count();
            for a in first..first + many {
                let other = (a + 1..first + many).find(|b| !exchanged[*b] && exchange(&self.jumps[a], &self.jumps[*b]));
                if let Some(b) = other.filter(|_| !exchanged[a]) {
                    exchanged[a] = true;
                    exchanged[b] = true;
                    pairs.push([a, b]);
                }
            }
            first += many;
        }
        let mut remarks = Vec::new();
        let jumps = self.count - 2 * pairs.len() as u64;
        let alone = self.jumps.iter().zip(&exchanged).find(|(_, exchanged)| !**exchanged);
        if let Some((jump, _)) = alone {
            let (times, distance) = (if jumps == 1 { "time" } else { "times" }, (jump.found - jump.expected).norm());
            remarks.push(format!(
                "jumps: {jumps} {times} a road user is where it cannot have driven, first \"{}\" at {} s, {distance:.1} m from where its \
                 movement led; nothing is mended",
                id(jump.user),
                Written(jump.time)
            ));
        }
        if let Some([a, b]) = pairs.first().map(|pair| pair.map(|place| self.jumps[place])) {
            let times = if pairs.len() == 1 { "time" } else { "times" };
            remarks.push(format!(
                "identities: {} {times} two road users exchange their places between two rows, first \"{}\" and \"{}\" at {} s; nothing \
                 is mended",
                pairs.len(),
                id(a.user),
                id(b.user),
                Written(a.time)
            ));
        }
        remarks
    }
}

/// Whether each of two is where the other was expected.
fn exchange(a: &Jump, b: &Jump) -> bool {
    let nearer =
        |one: &Jump, other: &Jump| (one.found - other.expected).norm() < NEARER * (one.found - one.expected).norm();
    nearer(a, b) && nearer(b, a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use closecall::geometry::Point;

    fn jump(user: u32, time: f64, [from, to]: [f64; 2]) -> Jump {
        Jump { user, time, expected: Point::new(from, 0.0), found: Point::new(to, 0.0) }
    }

    #[test]
    fn an_exchange_is_no_jump() {
        let mut jumps = Jumps::default();
        for (user, time, distance) in
            [(5, 9.0, [0.0, 8.25]), (1, 2.0, [0.0, 4.1]), (2, 2.0, [4.0, 0.2]), (3, 2.0, [50.0, 54.0])]
        {
            jumps.add(jump(user, time, distance));
        }
        let remarks = jumps.remarks(|user| ["", "a", "b", "c", "", "e"][user as usize]);
        assert_eq!(remarks.len(), 2, "{remarks:?}");
        assert!(
            remarks[0].starts_with("jumps: 2 times") && remarks[0].contains("first \"c\" at 2 s, 4.0 m"),
            "{remarks:?}"
        );
        assert!(
            remarks[1].starts_with("identities: 1 time two") && remarks[1].contains("\"a\" and \"b\" at 2 s"),
            "{remarks:?}"
        );
    }

    #[test]
    fn a_clean_recording_has_no_remarks() {
        assert!(Jumps::default().remarks(|_| "").is_empty());
    }
}
