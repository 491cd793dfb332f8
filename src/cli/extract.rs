//! `closecall extract`: one conflict as a scenario of its own.

use std::path::PathBuf;

use clap::Args;

use super::files::absolute;
use super::progress::CountBar;
use super::say::say;
use super::sumo::{Sumo, no_sumo};
use super::which::WhichArgs;
use crate::Result;
use crate::batch::extract::{Tools, extract};

/// Which conflict to cut out, and where to.
#[derive(Args)]
pub struct ExtractArgs {
    #[command(flatten)]
    conflict: WhichArgs,
    /// Folder for the scenario; it must be new or empty.
    #[arg(short, long, value_name = "FOLDER")]
    out: PathBuf,
    /// Print only errors.
    #[arg(short, long)]
    quiet: bool,
}

/// Writes the folder, and prints what is in it.
pub fn run(arguments: &ExtractArgs, known: &[String], sumo: Option<Sumo>) -> Result<()> {
    let ExtractArgs { conflict, out, quiet } = arguments;
    let Some(sumo) = sumo else { return no_sumo() };
    let mut bar = CountBar::new("runs", !quiet);
    let mut tools = Tools {
        save_configuration: sumo.save_configuration,
        closecall: sumo.closecall,
        known,
        interrupted: sumo.interrupted,
        progress: &mut |done, all| bar.show(done, all),
    };
    let made = extract(&conflict.folder, conflict.which(), &absolute(out)?, &mut tools)?;
    drop(bar);
    if *quiet {
        return Ok(());
    }
    if let Some(remark) = made.remark {
        eprintln!("closecall: {remark}");
    }
    let (id, time) = (made.conflict.id, made.conflict.time);
    say(format_args!("conflict {id} at {time} s in {}; closecall run and pytest find it there again\n", out.display()))
}
