//! The words that choose one conflict of a log.

use std::path::PathBuf;

use clap::Args;

use closecall_analysis::logged::ConflictSelector;

/// Which conflict.
#[derive(Args)]
pub(super) struct SelectorArgs {
    /// Log folder.
    #[arg(value_name = "LOG")]
    pub folder: PathBuf,
    /// The conflict's id in the log.
    #[arg(value_name = "ID", required_unless_present = "worst")]
    id: Option<u64>,
    /// The worst conflict (1), the second worst (2), and so on, instead of an id. Artefacts can be chosen only by id.
    #[arg(long, value_name = "N", conflicts_with = "id")]
    worst: Option<usize>,
}

impl SelectorArgs {
    /// The choice.
    pub fn which(&self) -> ConflictSelector {
        self.id.map_or(ConflictSelector::Worst(self.worst.unwrap_or(1)), ConflictSelector::Id)
    }
}
