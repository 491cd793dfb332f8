//! How far the logs are read, for a progress bar.

/// Takes how many of how many conflicts are read.
pub type Progress<'a> = dyn FnMut(u64, u64) + 'a;

/// Counts conflicts as they are read.
pub struct Reading<'a, 'b> {
    read: u64,
    all: u64,
    progress: &'a mut Progress<'b>,
}

impl<'a, 'b> Reading<'a, 'b> {
    /// None of `all` conflicts is read yet. A run that was killed does not say how many it has, so there may be more.
    pub fn new(all: u64, progress: &'a mut Progress<'b>) -> Self {
        Self { read: 0, all, progress }
    }

    /// This many conflicts more are read.
    pub fn count(&mut self, more: u64) {
        /// Conflicts between two reports.
        const EVERY: u64 = 4096;
        let reports = self.read / EVERY;
        self.read += more;
        if self.read / EVERY > reports {
            (self.progress)(self.read, self.all.max(self.read));
        }
    }
}
