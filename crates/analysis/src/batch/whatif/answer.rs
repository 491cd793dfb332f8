//! What the roll-outs of a conflict say.

use serde::{Deserialize, Serialize};

use super::arms::RolledOut;
use super::paths::Baseline;
use crate::Result;
use crate::logged::{ConflictReader, LoggedConflict};
use crate::statistics::share::{Share, share};
use closecall::util::units::{Metre, MetrePerSecond, Probability, Second, counted};
use closecall_run::run::roll_out::Contact;
use closecall_run::util::decimal::Written;

/// What the roll-outs of a conflict say: a row of `whatif.csv`.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Answer {
    /// The conflict's id in the log.
    pub conflict: u64,
    /// The ego.
    pub ego: String,
    /// The foe.
    pub foe: String,
    /// The kind.
    pub kind: String,
    /// What the two were doing.
    pub manoeuvre: String,
    /// The severity.
    pub severity: String,
    /// When it opens, in s.
    pub begin: Second,
    /// The conflict point, x in m.
    pub x: Metre,
    /// The same, y in m.
    pub y: Metre,
    /// The roll-outs that ended.
    pub roll_outs: u64,
    /// Those that failed.
    pub lost: u64,
    /// Those with a contact of one of the two.
    pub contacts: u64,
    /// Those of them with a third road user.
    pub with_others: u64,
    /// The share with a contact.
    pub share: Option<Probability>,
    /// The lower end of its 95 % interval.
    pub low: Option<Probability>,
    /// The upper end.
    pub high: Option<Probability>,
    /// The crash probability by the formula, in the step in which the conflict opens in the baseline.
    pub crash_probability_at_opening: Option<Probability>,
    /// The largest over the conflict in the baseline.
    pub crash_probability: Option<Probability>,
    /// The mean of the larger ΔV over the contacts, in m/s.
    pub delta_v: Option<MetrePerSecond>,
    /// The mean probability of a fatal injury over all roll-outs.
    pub injury_probability: Option<Probability>,
    /// The response time that tells contacts from the rest best, in s.
    pub critical_response: Option<Second>,
    /// The shortest with a contact, in s.
    pub shortest_with_contact: Option<Second>,
    /// The longest without, in s.
    pub longest_without: Option<Second>,
    /// The contacts that the other driver prevents by braking with a median response.
    pub prevented_by_other: u64,
    /// The contacts for which that was tried.
    pub tried_by_other: u64,
    /// The largest distance of the two from where they were in the run, in m, in the baseline.
    pub drift: Option<Metre>,
    /// The name of a run with a clip of a contact.
    pub clip_with_contact: String,
    /// That of one without.
    pub clip_without: String,
    /// Why the conflict was not rolled out, or what to know about the answer.
    pub remark: String,
}

impl Answer {
    /// That of a conflict that was not rolled out.
    pub(super) fn refused(of: &LoggedConflict, why: &str) -> Self {
        Self {
            conflict: of.id,
            ego: of.ego.to_string(),
            foe: of.foe.to_string(),
            kind: of.kind.name().to_owned(),
            manoeuvre: of.manoeuvre.to_string(),
            severity: of.severity.name().to_owned(),
            begin: of.begin,
            x: of.x,
            y: of.y,
            remark: why.to_owned(),
            ..Self::default()
        }
    }

    /// That of a conflict with a baseline.
    pub(super) fn of(
        of: &LoggedConflict,
        baseline: &Baseline,
        rolled: &[RolledOut],
        answered: &[RolledOut],
        filmed: &[RolledOut],
        lost: u64,
    ) -> Result<Self> {
        let contact = |run: &RolledOut| run.outcome.contact.clone();
        let struck = rolled.iter().filter_map(|run| Some((run, contact(run)?))).collect::<Vec<_>>();
        let is_of_the_two = |contact: &Contact| of.is_between(&contact.pair[0], &contact.pair[1]);
        let mut delta_v = Vec::new();
        let mut injury = 0.0;
        for (run, contact) in &struck {
            if let Some(found) = collision(run, contact)? {
                delta_v.push(found.delta_v());
                injury += found.injury_probability.unwrap_or_default();
            }
        }
        // Wilson's interval is one of independent draws; these are spread more evenly, so that it is wider than need be.
        let Share { value, low, high } = share(struck.len() as u64, rolled.len() as u64);
        let has_any = !rolled.is_empty();
        let responses = rolled.iter().filter_map(|run| {
            let drawn = run.outcome.drivers.first()?;
            Some((drawn.from.map(|_| drawn.response)?, run.outcome.contact.is_some()))
        });
        let responses = responses.collect::<Vec<_>>();
        let of_contact = |is_contact: bool| responses.iter().filter(move |run| run.1 == is_contact).map(|run| run.0);
        let clip = |is_contact: bool| {
            let run = filmed.iter().find(|run| run.outcome.contact.is_some() == is_contact);
            run.map(|run| run.task.name.clone()).unwrap_or_default()
        };
        let never_opened = rolled.len() - responses.len();
        let remark = match () {
            () if baseline.collides => "the two strike each other without any error".to_owned(),
            () if never_opened > 0 => format!("in {never_opened} roll-outs no conflict of the two opened"),
            () => String::new(),
        };
        Ok(Self {
            roll_outs: rolled.len() as u64,
            lost,
            contacts: struck.len() as u64,
            with_others: struck.iter().filter(|(_, contact)| !is_of_the_two(contact)).count() as u64,
            share: has_any.then_some(value),
            low: has_any.then_some(low),
            high: has_any.then_some(high),
            crash_probability_at_opening: baseline.at_opening,
            crash_probability: baseline.largest,
            delta_v: (!delta_v.is_empty()).then(|| delta_v.iter().sum::<f64>() / delta_v.len() as f64),
            injury_probability: has_any.then(|| injury / rolled.len() as f64),
            critical_response: threshold(&responses),
            shortest_with_contact: of_contact(true).reduce(f64::min),
            longest_without: of_contact(false).reduce(f64::max),
            prevented_by_other: answered.iter().filter(|run| run.outcome.contact.is_none()).count() as u64,
            tried_by_other: answered.len() as u64,
            drift: Some(baseline.drift),
            clip_with_contact: clip(true),
            clip_without: clip(false),
            ..Self::refused(of, &remark)
        })
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

/// The conflict of a contact in the log of its run.
fn collision(run: &RolledOut, contact: &Contact) -> Result<Option<LoggedConflict>> {
    let [a, b] = &contact.pair;
    for found in ConflictReader::open(&run.task.log())? {
        let found = found?;
        if found.is_between(a, b) && found.collision {
            return Ok(Some(found));
        }
    }
    Ok(None)
}

/// The value from which on most are true and below which most are not: the one with the fewest on the wrong side. None where all
/// are equal.
fn threshold(values: &[(Second, bool)]) -> Option<Second> {
    let mut values = values.to_vec();
    values.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let all = values.iter().filter(|value| value.1).count();
    if all == 0 || all == values.len() {
        return None;
    }
    // Below the threshold, those that are true are wrong; above it, those that are not.
    let mut wrong = values.len() - all;
    let mut best = (wrong, values[0].0);
    for pair in values.windows(2) {
        wrong = if pair[0].1 { wrong + 1 } else { wrong - 1 };
        if wrong < best.0 {
            best = (wrong, f64::midpoint(pair[0].0, pair[1].0));
        }
    }
    Some(best.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_threshold_parts_contacts_from_the_rest() {
        let values = |limit: f64| (0..20).map(|k| f64::from(k) / 10.0).map(|t| (t, t > limit)).collect::<Vec<_>>();
        assert!((threshold(&values(1.23)).unwrap() - 1.25).abs() < 1e-12);
        assert_eq!(threshold(&values(5.0)), None);
        let mut mixed = values(1.23);
        mixed[3].1 = true;
        assert!((threshold(&mixed).unwrap() - 1.25).abs() < 1e-12, "one on the wrong side moves nothing");
    }
}
