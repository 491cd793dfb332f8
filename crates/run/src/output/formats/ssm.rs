//! Conflicts in the format of SUMO's SSM device, so that scripts for its files keep working.
//!
//! Each conflict is written once, with closecall's ego and foe; the device writes it once for each of the two. Artefacts have
//! an attribute `artefact`, which the device's files lack. `type` is the device's code for the encounter (SUMO's
//! `MSDevice_SSM.h`).

use std::fmt::Write;
use std::path::Path;

use crate::Result;
use crate::output::schema::LoggedConflict;
use crate::util::decimal::shortest;
use crate::util::output_file::OutputFile;
use crate::util::xml_text::escaped;
use closecall::detection::kind::Kind;
use closecall::events::{Artefact, Conflict, Moment};
use closecall::util::units::Second;

/// The device's code for an ego that follows its foe.
const FOLLOWING_FOLLOWER: u32 = 2;
/// The code for an ego that crosses its foe's path behind it.
const CROSSING_FOLLOWER: u32 = 11;
/// The code for two that have both left the conflict area: that of a PET.
const BOTH_LEFT: u32 = 17;
/// The code for two that drive towards each other.
const ONCOMING: u32 = 20;
/// The code for a collision.
const COLLISION: u32 = 111;

/// The SSM file of a run.
#[derive(Debug)]
pub struct Ssm {
    file: OutputFile,
}

impl Ssm {
    /// Creates the file with its first lines.
    pub fn create(path: &Path) -> Result<Self> {
        let mut file = OutputFile::create(path)?;
        let made_by = concat!("<!-- closecall ", env!("CARGO_PKG_VERSION"), " -->\n");
        file.append(format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\n{made_by}\n<SSMLog>\n").as_bytes())?;
        Ok(Self { file })
    }

    /// Appends a conflict.
    pub(crate) fn write_conflict(&mut self, conflict: &Conflict) -> Result<()> {
        let Conflict { kind, collision, begin, end, pet, found, values: extremes, .. } = *conflict;
        let (ego, foe) = (&*conflict.ego, &*conflict.foe);
        let artefact = conflict.artefact.map(Artefact::name).unwrap_or_default();
        let values = [extremes.ttc(), extremes.drac(), pet];
        self.append(&Element { ego, foe, artefact, kind, collision, begin, end, values, found })
    }

    /// Appends a conflict of a log, which does not tell when and where its extremes were.
    pub(crate) fn write_logged(&mut self, conflict: &LoggedConflict) -> Result<()> {
        let LoggedConflict { kind, collision, begin, end, ttc, drac, pet, .. } = *conflict;
        let (ego, foe, artefact) = (&*conflict.ego, &*conflict.foe, &*conflict.artefact);
        let (values, found) = ([ttc, drac, pet], [None; 3]);
        self.append(&Element { ego, foe, artefact, kind, collision, begin, end, values, found })
    }

    fn append(&mut self, conflict: &Element) -> Result<()> {
        self.file.append(element(conflict).as_bytes())
    }

    /// Completes the file.
    pub fn finish(mut self) -> Result<()> {
        self.file.append(b"</SSMLog>\n")?;
        self.file.finish()
    }
}

/// A conflict as the format has it.
struct Element<'a> {
    ego: &'a str,
    foe: &'a str,
    /// Empty for traffic's.
    artefact: &'a str,
    kind: Kind,
    collision: bool,
    begin: Second,
    end: Second,
    /// The TTC, the DRAC and the PET.
    values: [Option<f64>; 3],
    /// When and where they were found, if that is known.
    found: [Option<Moment>; 3],
}

fn element(conflict: &Element) -> String {
    let code = match conflict.kind {
        _ if conflict.collision => COLLISION,
        Kind::RearEnd => FOLLOWING_FOLLOWER,
        Kind::Side => CROSSING_FOLLOWER,
        Kind::Frontal => ONCOMING,
    };
    let (ego, foe) = (escaped(conflict.ego), escaped(conflict.foe));
    let artefact = match conflict.artefact {
        "" => String::new(),
        name => format!(" artefact=\"{}\"", escaped(name)),
    };
    let mut text = format!(
        "    <conflict begin=\"{}\" end=\"{}\" ego=\"{ego}\" foe=\"{foe}\"{artefact}>\n",
        decimal(conflict.begin),
        decimal(conflict.end)
    );
    let names = [("minTTC", code), ("maxDRAC", code), ("PET", BOTH_LEFT)];
    for (((name, code), value), moment) in names.into_iter().zip(conflict.values).zip(conflict.found) {
        // Writing to a String cannot fail.
        let _ = match (value, moment) {
            (Some(value), Some(Moment { time, x, y, speed })) => writeln!(
                text,
                "        <{name} time=\"{}\" position=\"{},{}\" type=\"{code}\" value=\"{}\" speed=\"{}\"/>",
                decimal(time),
                decimal(x),
                decimal(y),
                decimal(value),
                decimal(speed)
            ),
            (Some(value), None) => writeln!(
                text,
                "        <{name} time=\"NA\" position=\"NA\" type=\"{code}\" value=\"{}\" speed=\"NA\"/>",
                decimal(value)
            ),
            (None, _) => {
                writeln!(text, "        <{name} time=\"NA\" position=\"NA\" type=\"NA\" value=\"NA\" speed=\"NA\"/>")
            }
        };
    }
    text + "    </conflict>\n"
}

/// A number with at least two decimals, as SUMO writes it, and at most six.
fn decimal(value: f64) -> String {
    let mut digits = String::new();
    shortest(value, &mut digits);
    let decimals = digits.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    if decimals < 2 { format!("{value:.2}") } else { digits }
}

#[cfg(test)]
mod tests {
    use crate::output::formats::ssm::*;

    #[test]
    fn numbers_have_at_least_two_decimals() {
        assert_eq!([1.0, 1.5, 1.25, 0.1234567].map(decimal), ["1.00", "1.50", "1.25", "0.123457"]);
    }
}
