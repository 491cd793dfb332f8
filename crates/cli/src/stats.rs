//! `closecall stats`: near-miss statistics of one or many runs.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::error::Result;
use super::print::{print, value};
use super::progress::CountBar;
use closecall_analysis::filter::ConflictFilter;
use closecall_analysis::logged::{check_keeps_logs, check_none_lost};
use closecall_analysis::statistics::{By, Observed, Request, Statistics, quoted, table};
use closecall_run::util::output_file;

/// The default length of the lists.
const LISTED: usize = 10;

/// Which logs to analyse, and how to print the result.
#[derive(Args)]
pub(crate) struct StatsArgs {
    /// Log folders, or folders that contain log folders at any depth, such as the results of a sweep.
    #[arg(value_name = "LOG", required = true)]
    folders: Vec<PathBuf>,
    /// What to group the conflicts by [default: kind].
    #[arg(long, value_enum, help_heading = "Output")]
    by: Option<By>,
    /// Output format.
    #[arg(long, value_enum, default_value = "text", help_heading = "Output")]
    format: Format,
    /// File to write instead of standard output.
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    out: Option<PathBuf>,
    /// Number of worst conflicts and of hot spots to list [default: 10].
    #[arg(long, alias = "worst", value_name = "N", help_heading = "Output")]
    top: Option<usize>,
    /// Print all tables with all columns, as --by, --top, --against and --plan do; otherwise what fits a screen.
    #[arg(long, help_heading = "Output")]
    all: bool,
    /// With `--format csv`, begin ids that a spreadsheet would run as formulas (=, +, -, @) with an apostrophe.
    #[arg(long, help_heading = "Output")]
    csv_safe: bool,
    /// Runs to compare with: log folders, or folders that contain log folders.
    #[arg(long, value_name = "LOG", num_args = 1.., help_heading = "Comparison")]
    against: Vec<PathBuf>,
    /// Ratio of rates to detect: print how many runs a comparison needs, given the spread of these runs.
    #[arg(long, value_name = "RATIO", value_parser = ratio, help_heading = "Comparison")]
    plan: Option<f64>,
    /// Crashes observed in reality for the runs of --against: estimate how many the first set may have.
    #[arg(long, value_name = "CRASHES", requires_all = ["against", "years"], help_heading = "Comparison")]
    observed: Option<u64>,
    /// Years in which the crashes were observed.
    #[arg(long, value_name = "YEARS", value_parser = years, requires = "observed", help_heading = "Comparison")]
    years: Option<f64>,
    #[command(flatten)]
    filter: ConflictFilter,
}

/// A ratio above 0 that is not 1.
fn ratio(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(ratio) if ratio > 0.0 && ratio != 1.0 && ratio.is_finite() => Ok(ratio),
        _ => Err("it must be a ratio above 0 other than 1, such as 1.3".to_owned()),
    }
}

fn years(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(years) if years > 0.0 && years.is_finite() => Ok(years),
        _ => Err("it must be a number of years above 0".to_owned()),
    }
}

/// How statistics are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Tables for a terminal.
    Text,
    /// One row per value.
    Csv,
    /// One object with all digits.
    Json,
    /// Page for a browser.
    Html,
}

/// Prints the statistics.
pub fn run(arguments: StatsArgs) -> Result<()> {
    let StatsArgs { folders, by, format, against, csv_safe, out, top, all, plan, observed, years, filter } = arguments;
    if let Some(out) = &out {
        check_keeps_logs(out, &[&folders[..], &against].concat(), None)?;
    }
    let mut bar = CountBar::new("conflicts", true);
    let observed = observed.zip(years).map(|(crashes, years)| Observed { crashes, years });
    let is_whole = all || by.is_some() || top.is_some() || !against.is_empty() || plan.is_some();
    let logs = folders.iter().map(|folder| quoted(&folder.to_string_lossy())).collect::<Vec<_>>().join(" ");
    let (by, worst) = (by.unwrap_or_default(), top.unwrap_or(LISTED));
    let request = Request { folders, by, against, filter, worst, plan, observed };
    let statistics = Statistics::of(&request, &mut |read, all| bar.show(read, all))?;
    drop(bar);
    if observed.is_some() && statistics.transferred.is_none() {
        eprintln!(
            "closecall: the ratio of conflicts has no finite interval, so the observed crashes tell nothing of the first set"
        );
    }
    for log in &statistics.left_out {
        eprintln!("closecall: {}: {}", log.folder.display(), log.why);
    }
    let printed = match format {
        Format::Json => serde_json::to_string_pretty(&statistics).map_err(|error| value(error.to_string()))? + "\n",
        // The rates of several variants stand side by side only in the whole tables.
        Format::Text if !is_whole && statistics.variants.len() == 1 => table::brief(&statistics, &logs),
        Format::Text => table::text(&table::tables(&statistics)),
        Format::Csv => table::csv(&table::tables(&statistics), csv_safe)?,
        Format::Html => table::html(&statistics.name, &table::tables(&statistics)),
    };
    match out {
        Some(out) => output_file::write(&out, printed.as_bytes())?,
        None => print(printed)?,
    }
    Ok(check_none_lost(&statistics.lost)?)
}
