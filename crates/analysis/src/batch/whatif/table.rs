//! `whatif.csv`: a row for each conflict; and a line of each for a reader.

use std::path::Path;

use super::answer::Answer;
use crate::{Error, Result};
use closecall::util::units::counted;
use closecall_run::util::decimal::Written;
use closecall_run::util::output_file::OutputFile;

impl Answer {
    /// Writes `whatif.csv`.
    ///
    /// # Errors
    /// [`Error::File`](closecall_run::Error::File) that names it.
    pub fn write(answers: &[Self], path: &Path) -> Result<()> {
        let failed = |error: csv::Error| Error::content(path, error.to_string());
        let mut table = OutputFile::create(path)?;
        let mut writer = csv::Writer::from_writer(&mut table);
        answers.iter().try_for_each(|answer| writer.serialize(answer)).map_err(failed)?;
        writer.flush().map_err(|source| Error::file(path, source))?;
        drop(writer);
        Ok(table.finish()?)
    }

    /// What a reader wants to know first.
    pub fn in_words(&self) -> String {
        let Self { conflict, kind, begin, ego, foe, .. } = self;
        let mut text = format!("conflict {conflict} ({kind}, {ego} and {foe}, {} s): ", Written(*begin));
        let (Some(share), Some(low), Some(high)) = (self.share, self.low, self.high) else {
            return text + if self.remark.is_empty() { "no roll-out ended" } else { &self.remark };
        };
        let per_cent = |share: f64| format!("{:.0}", 100.0 * share);
        let all = counted(self.roll_outs, "roll-out");
        text += &format!("contact in {} of {all}, {} %", self.contacts, per_cent(share));
        text += &format!(" ({}–{} %)", per_cent(low), per_cent(high));
        if let Some(formula) = self.crash_probability_at_opening {
            text += &format!("; by the formula {} %", per_cent(formula));
        }
        if let Some(response) = self.critical_response {
            text += &format!("; from a response time of {response:.1} s on");
        }
        if self.tried_by_other > 0 {
            text += &format!("; the other prevents {} of {}", self.prevented_by_other, self.tried_by_other);
        }
        if self.lost > 0 {
            text += &format!("; {} lost", counted(self.lost, "roll-out"));
        }
        if !self.remark.is_empty() {
            text += &format!("; {}", self.remark);
        }
        text
    }
}
