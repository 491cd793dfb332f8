//! The measures that a condition may compare: those of a step, and the PET.

use super::Comparison;
use super::look_ahead::LookAhead;
use crate::options::LONGEST_PET;
use crate::util::units::Second;

/// Makes [`Measure`], with the name of its column in the log.
macro_rules! measures {
    ($($variant:ident $name:literal),+ $(,)?) => {
        /// A measure of a pair in a step; `detection::step_values` has its value. The PET is that of the event.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Measure {
            $( #[doc = concat!("The column `", $name, "`.")] $variant, )+
        }

        impl Measure {
            /// All, in the order in which an error lists them.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$variant),+];

            /// The name of its column.
            pub fn name(self) -> &'static str {
                match self { $( Self::$variant => $name, )+ }
            }
        }
    };
}

measures! {
    Gap "gap",
    Mu "mu",
    Margin "margin",
    Clearance "clearance",
    Ttc "ttc",
    Drac "drac",
    Pet "pet",
    Headway "headway",
    Overlap "overlap",
    Angle "angle",
    EgoSpeed "ego_speed",
    FoeSpeed "foe_speed",
    EgoDeltaV "ego_delta_v",
    FoeDeltaV "foe_delta_v",
}

impl Comparison {
    /// How far ahead the pairs that meet it have to be looked for; an error says why no distance is enough.
    pub(super) fn look_ahead(&self) -> Result<LookAhead, String> {
        let &Self { measure, operator, value } = self;
        let at_least_0 = value.max(0.0);
        match (measure, operator.is_upper_bound()) {
            (Measure::Pet, false) => {
                Err("asks for a late PET; a PET can only be bounded above, as in \"pet < 2\"".into())
            }
            (Measure::Pet, true) if value > LONGEST_PET => {
                Err(format!("asks for a longer PET than is waited for, {LONGEST_PET} s"))
            }
            (Measure::Pet, true) => Ok(LookAhead { pet: at_least_0, ..LookAhead::NONE }),
            (Measure::Gap | Measure::Margin, true) => Ok(LookAhead { metres: at_least_0, ..LookAhead::NONE }),
            (Measure::Ttc | Measure::Headway, true) => Ok(LookAhead { seconds: at_least_0, ..LookAhead::NONE }),
            // A DRAC exists only where a TTC does.
            (Measure::Drac, false) => Ok(LookAhead { seconds: Second::INFINITY, ..LookAhead::NONE }),
            // Two that overlap now are always met.
            (Measure::Overlap, false) if operator.holds(0.0, value) => Err(UNBOUNDED.into()),
            (Measure::Overlap, false) => Ok(LookAhead::NONE),
            _ => Err(UNBOUNDED.into()),
        }
    }
}

/// Why a comparison alone selects no pairs near each other.
const UNBOUNDED: &str = "holds for pairs however far ahead they meet; join it by \"and\" with a bound such as \
                         \"margin < 0\" or \"ttc < 5\"";
