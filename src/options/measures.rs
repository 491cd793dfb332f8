//! The measures that a log has only if they are chosen.

use std::fmt;
use std::str::FromStr;

use serde::{Serialize, Serializer};

/// Makes [`ChosenMeasure`] of the rows of the table.
macro_rules! name_measures {
    ($( $(#[doc = $meaning:literal])+ $variant:ident $name:ident: $unit:ty, $over:ident = $value:expr; )+) => {
        /// A measure that is computed and logged only if it is chosen; docs/measures.md describes each.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum ChosenMeasure {
            $( $(#[doc = $meaning])+ $variant, )+
        }

        impl ChosenMeasure {
            /// All, in the order of their columns.
            pub const ALL: [Self; [$(stringify!($name)),+].len()] = [$(Self::$variant),+];

            /// The name of its column.
            pub fn name(self) -> &'static str {
                match self { $( Self::$variant => stringify!($name), )+ }
            }
        }
    };
}

crate::chosen_measures!(name_measures!);

/// A value of each [`ChosenMeasure`], in their order; none where it is not chosen or does not exist.
pub(crate) type ChosenValues = [Option<f64>; ChosenMeasure::ALL.len()];

/// The measures that are chosen: a bit for each [`ChosenMeasure`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Measures(u32);

impl Measures {
    /// All of them.
    pub const ALL: Self = Self((1 << ChosenMeasure::ALL.len()) - 1);

    /// Whether none is chosen.
    pub fn is_empty(&self) -> bool {
        self.0 == 0
    }

    /// Whether a measure is chosen.
    pub fn has(self, measure: ChosenMeasure) -> bool {
        self.0 & Self::from(measure).0 != 0
    }

    /// The chosen ones, in the order of their columns.
    pub fn chosen(self) -> impl Iterator<Item = ChosenMeasure> {
        ChosenMeasure::ALL.into_iter().filter(move |measure| self.has(*measure))
    }
}

impl From<ChosenMeasure> for Measures {
    fn from(measure: ChosenMeasure) -> Self {
        Self(1 << measure as u32)
    }
}

impl FromStr for Measures {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut measures = Self::default();
        for name in text.split(',').map(str::trim) {
            measures.0 |= match name {
                "default" => 0,
                "all" => Self::ALL.0,
                _ => match ChosenMeasure::ALL.into_iter().find(|measure| measure.name() == name) {
                    Some(measure) => Self::from(measure).0,
                    None => {
                        let names = ChosenMeasure::ALL.map(ChosenMeasure::name).join(", ");
                        return Err(format!("cannot add an unknown measure \"{name}\"; known are {names}"));
                    }
                },
            };
        }
        Ok(measures)
    }
}

impl fmt::Display for Measures {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match *self {
            Self(0) => f.write_str("default"),
            Self::ALL => f.write_str("all"),
            _ => f.write_str(&self.chosen().map(ChosenMeasure::name).collect::<Vec<_>>().join(",")),
        }
    }
}

impl Serialize for Measures {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_is_written_as_it_is_read() {
        for (text, written) in
            [("default", "default"), ("all", "all"), ("t2, tadv", "tadv,t2"), ("default,ei", "ei"), ("ei,all", "all")]
        {
            assert_eq!(text.parse::<Measures>().unwrap().to_string(), written);
        }
    }

    #[test]
    fn an_unknown_measure_is_named() {
        let error = "t2,picud".parse::<Measures>().unwrap_err();
        assert!(error.starts_with("cannot add an unknown measure \"picud\"; known are tadv, t2, "), "{error}");
    }
}
