//! `closecall stress`: stiff and extreme cases against exact references.

use clap::Args;

use super::error::{Error, Result};
use super::print::print;
use closecall_study::stress::{self, Group};

/// Which cases to run, and how many.
#[derive(Args)]
pub(crate) struct StressArgs {
    /// Total number of inputs, distributed over the named cases.
    #[arg(long, value_name = "N", default_value_t = 100_000, value_parser = clap::value_parser!(u64).range(1..))]
    cases: u64,
    /// Random seed for the inputs.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Run only the cases of one group.
    #[arg(long, value_enum, value_name = "GROUP")]
    only: Option<Group>,
}

/// Prints the table of worst errors; fails if a bound is exceeded.
pub fn run(arguments: &StressArgs) -> Result<()> {
    let rows = stress::run(arguments.cases, arguments.seed, arguments.only);
    print(format_args!("{}", stress::table(&rows)))?;
    let exceeded = rows.iter().filter(|row| !row.holds()).count();
    if exceeded > 0 {
        return Err(Error::Exceeded(exceeded, rows.len()));
    }
    print(format_args!("all {} bounds hold\n", rows.len()))?;
    Ok(())
}
