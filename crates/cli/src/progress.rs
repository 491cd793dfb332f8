//! Progress bars, only on a terminal: of a run (simulated time, road users, conflicts so far, real-time factor), and of
//! work that is counted.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use closecall::util::units::Second;

/// Time between two redraws of the bar.
const PERIOD: Duration = Duration::from_millis(100);

/// Shows the progress of a run.
pub struct Progress {
    bar: Option<ProgressBar>,
    begin: Second,
    started: Instant,
    drawn: Instant,
}

impl Progress {
    /// A bar from `begin` to `end`, or a spinner if the end is unknown; nothing unless wanted and on a terminal.
    pub fn new(begin: Second, end: Option<Second>, wanted: bool) -> Self {
        let bar = (wanted && std::io::stderr().is_terminal()).then(|| match end {
            Some(end) => {
                let style = ProgressStyle::with_template("{bar:30} {msg}").unwrap_or(ProgressStyle::default_bar());
                ProgressBar::new((end - begin).max(0.0) as u64).with_style(style)
            }
            None => ProgressBar::new_spinner(),
        });
        let now = Instant::now();
        Self { bar, begin, started: now, drawn: now - PERIOD }
    }

    /// Shows a step if a redraw is due.
    pub fn show(&mut self, time: Second, road_users: usize, conflicts: u64) {
        let Some(bar) = &self.bar else { return };
        let now = Instant::now();
        if now - self.drawn < PERIOD {
            return;
        }
        self.drawn = now;
        let factor = (time - self.begin) / (now - self.started).as_secs_f64().max(1e-3);
        bar.set_position((time - self.begin).max(0.0) as u64);
        bar.set_message(format!(
            "{time:.0} s, {road_users} road users, {conflicts} conflicts, {factor:.0} × real time"
        ));
    }
}

/// Work that is done within this time needs no bar.
const PATIENCE: Duration = Duration::from_secs(2);

/// Shows how many of a number of things are done, once that takes long.
pub(crate) struct CountBar {
    what: &'static str,
    wanted: bool,
    started: Instant,
    bar: Option<ProgressBar>,
}

impl CountBar {
    /// A bar that counts `what`; nothing unless wanted and on a terminal.
    pub fn new(what: &'static str, wanted: bool) -> Self {
        Self { what, wanted: wanted && std::io::stderr().is_terminal(), started: Instant::now(), bar: None }
    }

    /// Shows how many of all are done.
    pub fn show(&mut self, done: u64, all: u64) {
        if !self.wanted || (self.bar.is_none() && self.started.elapsed() < PATIENCE) {
            return;
        }
        let bar = self.bar.get_or_insert_with(|| {
            let template =
                format!("{{bar:30}} {{human_pos}} of {{human_len}} {}, {{elapsed}}, {{eta}} to go", self.what);
            let style = ProgressStyle::with_template(&template).unwrap_or(ProgressStyle::default_bar());
            let bar = ProgressBar::new(all).with_style(style).with_elapsed(self.started.elapsed());
            // What follows the counting has no length of its own: the time at least goes on.
            bar.enable_steady_tick(Duration::from_secs(1));
            bar
        });
        bar.set_length(all);
        bar.set_position(done);
    }
}

impl Drop for CountBar {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
