//! A list of seeds: `1-100`, `1,2,5-9`.

use std::fmt;
use std::str::FromStr;

/// Seeds without repetitions, in the order in which they were given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seeds(pub Vec<u32>);

/// More seeds than this are a typing mistake.
const MOST: usize = 1_000_000;

impl FromStr for Seeds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut seeds = Vec::new();
        for part in text.split(',') {
            let number = |text: &str| text.trim().parse::<u32>().map_err(|_| format!("\"{part}\" is not a seed"));
            let (first, last) = part.split_once('-').unwrap_or((part, part));
            let first = number(first)?;
            let last = number(last)?;
            if last < first {
                return Err(format!("\"{part}\" ends before it begins"));
            }
            if (last - first) as usize >= MOST || seeds.len() >= MOST {
                return Err(format!("these are more than {MOST} seeds"));
            }
            seeds.extend(first..=last);
        }
        let mut known = std::collections::HashSet::new();
        seeds.retain(|seed| known.insert(*seed));
        Ok(Self(seeds))
    }
}

impl fmt::Display for Seeds {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        for (place, run) in self.0.chunk_by(|seed, next| seed.checked_add(1) == Some(*next)).enumerate() {
            let comma = if place > 0 { "," } else { "" };
            match run {
                [first, .., last] => write!(f, "{comma}{first}-{last}")?,
                _ => write!(f, "{comma}{}", run[0])?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::batch::sweep::seeds::*;

    #[test]
    fn seeds_are_numbers_and_ranges_each_once() {
        assert_eq!("1-3".parse(), Ok(Seeds(vec![1, 2, 3])));
        assert_eq!("7,1-3,2".parse(), Ok(Seeds(vec![7, 1, 2, 3])));
        assert_eq!("7,1-3,9,10".parse::<Seeds>().map(|seeds| seeds.to_string()), Ok("7,1-3,9-10".to_owned()));
        for wrong in ["", "a", "3-1", "1-", "1--3", "-1", "0-4294967295"] {
            assert!(wrong.parse::<Seeds>().is_err(), "{wrong}");
        }
    }
}
