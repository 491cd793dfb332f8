//! The progress bar on a terminal: simulated time, vehicles, conflicts so far, real-time factor. None in a pipe.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::util::units::Second;

/// How often the bar is drawn anew.
const PERIOD: Duration = Duration::from_millis(100);

/// Shows how far a run is.
pub struct Progress {
    bar: Option<ProgressBar>,
    begin: Second,
    started: Instant,
    drawn: Instant,
}

impl Progress {
    /// A bar from `begin` to `end` (unknown: none) if standard error is a terminal and it is wanted.
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

    /// Shows a step, if it is time to.
    pub fn show(&mut self, time: Second, vehicles: usize, conflicts: u64) {
        let Some(bar) = &self.bar else { return };
        let now = Instant::now();
        if now - self.drawn < PERIOD {
            return;
        }
        self.drawn = now;
        let factor = (time - self.begin) / (now - self.started).as_secs_f64().max(1e-3);
        bar.set_position((time - self.begin).max(0.0) as u64);
        bar.set_message(format!("{time:.0} s, {vehicles} road users, {conflicts} conflicts, {factor:.0} × real time"));
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
