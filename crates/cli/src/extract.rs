//! `closecall extract`: one conflict as a standalone scenario.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::error::Result;
use super::files::absolute;
use super::print::{print, value};
use super::progress::CountBar;
use super::selector::SelectorArgs;
use super::sumo::{Sumo, no_sumo};
use closecall_analysis::batch::extract::{Extracted, SCENARIO, Tools, extract, extract_openscenario, extract_osi};
use closecall_analysis::logged::check_keeps_logs;
use closecall_run::util::decimal::Written;

/// Which conflict to cut out, and where to.
#[derive(Args)]
pub(crate) struct ExtractArgs {
    #[command(flatten)]
    conflict: SelectorArgs,
    /// Format of the scenario.
    #[arg(long, value_enum, default_value_t)]
    format: ExtractFormat,
    /// Folder for the scenario, new or empty; the file of an OSI trace.
    #[arg(short, long, value_name = "PATH")]
    out: PathBuf,
    /// Net of an OpenSCENARIO [default: the net file named in the log].
    #[arg(short, long, value_name = "NET")]
    net: Option<PathBuf>,
    /// Print only errors.
    #[arg(short, long)]
    quiet: bool,
}

/// The format of an extracted conflict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum ExtractFormat {
    /// A SUMO scenario in which the conflict happens again, with a test.
    #[default]
    Sumo,
    /// ASAM OpenSCENARIO XML 1.2 of the conflict's clip, with its net as OpenDRIVE, for esmini and other simulators.
    #[value(name = "openscenario")]
    OpenScenario,
    /// The conflict's clip as a trace of ASAM OSI 3: osi3.GroundTruth for each time.
    Osi,
}

/// Writes the folder or file, and prints what is in it.
pub fn run(arguments: &ExtractArgs, known: &[String], sumo: Option<Sumo>) -> Result<()> {
    let ExtractArgs { conflict: SelectorArgs { folder, .. }, format, out, net, .. } = arguments;
    let which = arguments.conflict.which();
    if net.is_some() && *format != ExtractFormat::OpenScenario {
        return Err(value("--net is for --format openscenario; what else is made needs no other net"));
    }
    match format {
        ExtractFormat::Sumo => {
            let Some(sumo) = sumo else { return no_sumo() };
            let mut bar = CountBar::new("runs", !arguments.quiet);
            let mut tools = Tools {
                save_configuration: sumo.save_configuration,
                closecall: sumo.closecall,
                known,
                interrupted: sumo.interrupted,
                progress: &mut |done, all| bar.show(done, all),
            };
            let made = extract(folder, which, &absolute(out)?, &mut tools)?;
            drop(bar);
            tell(arguments, &made, out, "closecall run and pytest find it there again")
        }
        ExtractFormat::OpenScenario => {
            let Some(sumo) = sumo else { return no_sumo() };
            let made = extract_openscenario(folder, which, net.as_deref(), &absolute(out)?, sumo.convert_net)?;
            tell(arguments, &made, &out.join(SCENARIO), "esmini and other players of OpenSCENARIO play it")
        }
        ExtractFormat::Osi => {
            check_keeps_logs(out, std::slice::from_ref(folder), None)?;
            let made = extract_osi(folder, which, out)?;
            tell(arguments, &made, out, "an osi3.GroundTruth for each time")
        }
    }
}

fn tell(arguments: &ExtractArgs, made: &Extracted, at: &Path, what: &str) -> Result<()> {
    if arguments.quiet {
        return Ok(());
    }
    if let Some(remark) = &made.remark {
        eprintln!("closecall: {remark}");
    }
    let (id, time) = (made.conflict.id, Written(made.conflict.time));
    print(format_args!("conflict {id} at {time} s in {}; {what}\n", at.display()))
}
