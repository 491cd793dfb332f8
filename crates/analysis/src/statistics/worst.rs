//! The worst conflicts, and the command that shows each in sumo-gui.

use std::collections::BinaryHeap;
use std::path::Path;
use std::sync::Arc;

use serde::Serialize;

use crate::logged::{ConflictReader, LoggedConflict, LoggedRun};
use crate::playback::may_have_clip;
use crate::variants::Variants;
use closecall::util::units::{Metre, Second};
use closecall_run::Result;
use closecall_run::output::rank::Rank;

/// sumo-gui halts this long before a conflict, and the run ends this long after it, in s.
const AROUND: Second = 5.0;
/// The width of the net that sumo-gui shows around a conflict, in m.
const SHOWN: Metre = 80.0;
/// The zoom in % if the net's extent is unknown.
const ZOOM: f64 = 1000.0;

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
    /// The command that shows it in sumo-gui, for a POSIX shell; none for a recording or if a script started SUMO.
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

/// The command that shows a conflict without a clip in sumo-gui.
///
/// The run begins at its original begin, because vehicles that departed before a later `--begin` would be missing.
/// sumo-gui runs without delay to a breakpoint a few seconds before the conflict and halts there, zoomed to the conflict
/// point. It accepts a viewport only from a file, so the shell creates one.
fn show(run: &LoggedRun, conflict: &LoggedConflict) -> Option<String> {
    if run.sumo_words.is_empty() {
        return None;
    }
    let view = format!(
        "<viewsettings><delay value=\"0\"/><viewport x=\"{:.1}\" y=\"{:.1}\" zoom=\"{:.0}\"/></viewsettings>",
        conflict.x,
        conflict.y,
        zoom(run).unwrap_or(ZOOM)
    );
    let mut args = vec!["sumo-gui".to_owned()];
    args.extend(kept(&run.sumo_words).map(|word| quoted(word)));
    let begin = (conflict.begin - AROUND).max(run.summary.begin);
    let around = [("--breakpoints", begin), ("--end", conflict.end + AROUND)];
    args.extend(around.iter().flat_map(|(option, time)| [(*option).to_owned(), format!("{time:.1}")]));
    args.extend(["--start".to_owned(), "--gui-settings-file".to_owned(), "\"$view\"".to_owned()]);
    Some(format!("view=$(mktemp) && printf %s {} > \"$view\" && {}", quoted(&view), args.join(" ")))
}

/// A run's words without the options that the command sets itself: SUMO accepts each option only once.
fn kept(args: &[String]) -> impl Iterator<Item = &String> {
    let mut is_value = false;
    args.iter().filter(move |word| {
        let (option, has_value) = word.split_once('=').map_or((word.as_str(), false), |(option, _)| (option, true));
        let is_anew = ["--end", "-e", "--gui-settings-file", "-g", "--breakpoints"].contains(&option);
        let is_left_out = is_value || is_anew;
        is_value = !is_value && is_anew && !has_value;
        !is_left_out
    })
}

/// A word, quoted for a POSIX shell if necessary.
fn quoted(word: &str) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "-_./=:,@%+".contains(letter);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// sumo-gui's zoom on a conflict, in % of the whole net; none if the net is no longer available.
fn zoom(run: &LoggedRun) -> Option<f64> {
    run.inputs.iter().find_map(|input| zoom_on(&input.path))
}

/// The zoom for this net; none if the file is not a net.
fn zoom_on(net: &Path) -> Option<f64> {
    let mut head = Vec::new();
    std::io::Read::read_to_end(
        &mut std::io::Read::take(closecall_run::util::input_file::open(net).ok()?, 1 << 16),
        &mut head,
    )
    .ok()?;
    let head = String::from_utf8_lossy(&head);
    let (_, bounds) = head.split_once("convBoundary=\"")?;
    let bounds = bounds.split_once('"')?.0.split(',').map(|number| number.parse::<f64>().ok());
    let [left, low, right, high] = bounds.collect::<Option<Vec<_>>>()?[..] else { return None };
    Some(((right - left).max(high - low) / SHOWN * 100.0).max(100.0))
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
        assert_eq!(quoted("it's a;b"), r"'it'\''s a;b'");
    }
}
