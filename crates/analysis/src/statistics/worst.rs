//! The worst conflicts, and the command that shows each in sumo-gui.

use std::collections::BinaryHeap;
use std::path::Path;
use std::sync::Arc;

use serde::Serialize;

use crate::Result;
use crate::logged::{ConflictReader, LoggedConflict, LoggedRun};
use crate::playback::may_have_clip;
use crate::variants::Variants;
use closecall::util::units::Second;
use closecall_run::output::rank::Rank;

/// sumo-gui halts this long before a conflict, and the run ends this long after it, in s.
const AROUND: Second = 5.0;

/// One of the worst conflicts.
#[derive(Clone, Debug, Serialize)]
pub struct RankedConflict {
    /// Its log folder.
    pub folder: Arc<Path>,
    /// The variant of its run; none if there is only one.
    pub variant: Option<String>,
    /// The seed of its run.
    pub seed: Option<String>,
    /// The edge of the conflict point.
    pub edge: String,
    /// The conflict.
    #[serde(flatten)]
    pub conflict: LoggedConflict,
    /// The command that shows it in sumo-gui, none for a recording or if a script started SUMO.
    pub command: Option<String>,
    #[serde(skip)]
    run: usize,
}

impl RankedConflict {
    /// Mildest first; of equal ones, the last logged first.
    fn order(&self, other: &Self) -> std::cmp::Ordering {
        let rank = |ranked: &Self| Rank::from(&ranked.conflict);
        rank(self).cmp(&rank(other)).then_with(|| (other.run, other.conflict.id).cmp(&(self.run, self.conflict.id)))
    }
}

/// Reverses the order of a heap, so that the mildest conflict is on top and goes first.
#[derive(Debug)]
struct MildestFirst(RankedConflict);

impl Ord for MildestFirst {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        other.0.order(&self.0)
    }
}
impl PartialOrd for MildestFirst {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl PartialEq for MildestFirst {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}
impl Eq for MildestFirst {}

/// The worst of the conflicts added so far.
#[derive(Debug, Default)]
pub struct WorstOf {
    wanted: usize,
    kept: BinaryHeap<MildestFirst>,
}

impl WorstOf {
    /// Keeps at most this many.
    pub fn new(wanted: usize) -> Self {
        Self { wanted, kept: BinaryHeap::new() }
    }

    /// Whether a conflict of the run with this number may be among the worst. False for nearly all.
    pub fn takes(&self, run: usize, conflict: &LoggedConflict) -> bool {
        self.wanted > 0 && !(self.kept.len() == self.wanted && self.is_milder(run, conflict))
    }

    /// Adds a conflict.
    pub fn add(&mut self, run: usize, folder: &Arc<Path>, conflict: LoggedConflict) {
        let edge = conflict.edge().to_owned();
        let (folder, variant, seed, command) = (folder.clone(), None, None, None);
        self.keep(MildestFirst(RankedConflict { folder, variant, seed, edge, conflict, command, run }));
    }

    /// Adds the worst of other runs.
    pub fn append(&mut self, others: Self) {
        others.kept.into_iter().for_each(|kept| self.keep(kept));
    }

    /// Reads the columns that were not counted.
    ///
    /// # Errors
    /// Those of reading the logs.
    pub fn complete(&mut self) -> Result<()> {
        let mut kept = std::mem::take(&mut self.kept).into_vec();
        kept.sort_unstable_by_key(|kept| (kept.0.run, kept.0.conflict.id));
        for of_run in kept.chunk_by_mut(|one, other| one.0.run == other.0.run) {
            let mut reader = ConflictReader::open(&of_run[0].0.folder)?.only(&["id", "kind", "severity"]);
            if reader.reads_whole_rows() {
                continue;
            }
            for MildestFirst(RankedConflict { conflict, .. }) in of_run {
                while reader.next_row()?.is_some_and(|row| row.id < conflict.id) {}
                if let Some(whole) = reader.whole_row()? {
                    *conflict = whole;
                }
            }
        }
        self.kept = kept.into();
        Ok(())
    }

    fn keep(&mut self, conflict: MildestFirst) {
        self.kept.push(conflict);
        if self.kept.len() > self.wanted {
            self.kept.pop();
        }
    }

    /// Whether this conflict is certainly not among the worst.
    fn is_milder(&self, run: usize, conflict: &LoggedConflict) -> bool {
        let Some(MildestFirst(mildest)) = self.kept.peek() else { return false };
        let (rank, least) = (Rank::from(conflict), Rank::from(&mildest.conflict));
        rank < least || (rank == least && run >= mildest.run)
    }

    /// The worst first.
    pub(crate) fn into_sorted(self, runs: &[LoggedRun], variants: &Variants) -> Vec<RankedConflict> {
        let mut worst = self.kept.into_sorted_vec().into_iter().map(|kept| kept.0).collect::<Vec<_>>();
        for found in &mut worst {
            let Some(run) = runs.get(found.run) else { continue };
            let of_run = variants.all.iter().find(|variant| variant.runs.binary_search(&found.run).is_ok());
            found.variant = of_run.filter(|_| variants.are_several()).map(|variant| variant.name.clone());
            found.seed.clone_from(&run.seed);
            found.command = if may_have_clip(&found.folder, run, &found.conflict) {
                Some(format!("closecall show {} {}", quoted(&found.folder.to_string_lossy()), found.conflict.id))
            } else {
                show(run, &found.conflict)
            };
        }
        worst
    }
}

/// The command that shows a conflict without a clip in sumo-gui, for any shell.
///
/// The run begins at its original begin, because vehicles that departed before a later `--begin` would be missing.
/// sumo-gui runs without delay to a breakpoint a few seconds before the conflict and halts there. It takes a view from no
/// option, so the place has to be looked for: the table has it.
fn show(run: &LoggedRun, conflict: &LoggedConflict) -> Option<String> {
    if run.sumo_words.is_empty() {
        return None;
    }
    let mut args = vec!["sumo-gui".to_owned()];
    args.extend(kept(&run.sumo_words).map(|word| quoted(word)));
    let begin = (conflict.begin - AROUND).max(run.summary.begin);
    let around = [("--breakpoints", begin), ("--end", conflict.end + AROUND)];
    args.extend(around.iter().flat_map(|(option, time)| [(*option).to_owned(), format!("{time:.1}")]));
    args.extend(["--delay", "0", "--start"].map(str::to_owned));
    Some(args.join(" "))
}

/// A run's words without the options that the command sets itself: SUMO accepts each option only once.
fn kept(args: &[String]) -> impl Iterator<Item = &String> {
    let mut is_value = false;
    args.iter().filter(move |word| {
        let (option, has_value) = word.split_once('=').map_or((word.as_str(), false), |(option, _)| (option, true));
        let is_anew = ["--end", "-e", "--breakpoints", "--delay", "-d"].contains(&option);
        let is_left_out = is_value || is_anew;
        is_value = !is_value && is_anew && !has_value;
        !is_left_out
    })
}

/// A word, quoted if necessary: in double quotes, which every shell takes, where they are enough.
pub fn quoted(word: &str) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "-_./=:,@%+".contains(letter);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else if word.contains(['"', '$', '`', '!']) {
        format!("'{}'", word.replace('\'', r"'\''"))
    } else {
        format!("\"{word}\"")
    }
}

#[cfg(test)]
mod tests {
    use crate::statistics::worst::*;

    #[test]
    fn options_that_are_replaced_are_removed_in_every_spelling() {
        let args = "-c a.sumocfg --end 9 --seed=3 --end=9 -e 9 -W".split(' ').map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(kept(&args).collect::<Vec<_>>(), ["-c", "a.sumocfg", "--seed=3", "-W"]);
    }

    #[test]
    fn a_word_with_a_space_or_a_quote_is_quoted() {
        assert_eq!(quoted("a/b.sumocfg"), "a/b.sumocfg");
        assert_eq!(quoted("it's a;b"), "\"it's a;b\"");
        assert_eq!(quoted("it's $1"), r"'it'\''s $1'");
    }
}
