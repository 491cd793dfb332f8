//! The last lines of `closecall run` and `closecall replay`: what was found, where to look first, where the log is.

use std::path::Path;

use super::error::Result;
use super::print::print;
use closecall_run::output::summary::Summary;

/// Prints the summary; with `explain`, every skipped test and the time that each part of the work took.
pub(super) fn print_summary(summary: &Summary, log: &Path, explain: bool) -> Result<()> {
    print(format_args!("{summary}"))?;
    if explain {
        let skipped = summary.skipped.to_string();
        if !skipped.is_empty() {
            print(format_args!("skipped {skipped}; none could change the result\n"))?;
        }
        for left_out in &summary.left_out {
            print(format_args!("{left_out}\n"))?;
        }
        let parts = summary.spent.iter().map(|(what, seconds)| format!("{what} {seconds:.3} s"));
        let parts = parts.collect::<Vec<_>>().join(", ");
        if !parts.is_empty() {
            print(format_args!("time: {parts}\n"))?;
        }
    }
    let log = log.display();
    if let Some(worst) = &summary.worst {
        print(format_args!("worst conflict: {worst}\n"))?;
        print(format_args!("log in {log}; see it on a map: closecall report {log}\n"))?;
    } else {
        print(format_args!("log in {log}\n"))?;
    }
    Ok(())
}
