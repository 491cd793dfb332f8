//! The measures that a condition may compare: those of a step, and the PET.

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
    ResponseLeft "response_left",
    Ttb "ttb",
    CrashProbability "crash_probability",
    CrashProbabilityBraking "crash_probability_braking",
    InjuryProbability "injury_probability",
    ExtendedDeltaV "extended_delta_v",
}
