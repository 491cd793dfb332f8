//! `closecall example`: writes a scenario that comes with closecall, to try it on.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::error::Result;
use super::print::{print, value};
use closecall_run::Error as RunError;
use closecall_run::util::output_file;

/// Which scenario, and where to.
#[derive(Args)]
pub(crate) struct ExampleArgs {
    /// Scenario.
    #[arg(value_enum, value_name = "NAME")]
    name: Example,
    /// Folder for its files [default: the scenario's name].
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// The scenarios that come with closecall: the smallest, those of the tutorials, and the demo.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
enum Example {
    /// A crossing with two signal plans: left_turn.sumocfg and protected.sumocfg.
    LeftTurn,
    /// A car that takes too small a gap.
    Side,
    /// A town with 117 junctions, signals, buses, bicycles and persons.
    Town,
}

/// A file: its name, and what is in it.
type File = (&'static str, &'static [u8]);

/// The files of a scenario, from `sumo_nets/`.
macro_rules! files {
    ($folder:literal: $($name:literal),+) => {
        &[$(($name, include_bytes!(concat!("../../../sumo_nets/", $folder, "/", $name)))),+]
    };
}

impl Example {
    /// Its files, the configuration to run first.
    fn files(self) -> &'static [File] {
        match self {
            Self::LeftTurn => files!("left_turn": "left_turn.sumocfg", "left_turn.net.xml", "left_turn.rou.xml",
                "protected.sumocfg", "protected.add.xml"),
            Self::Side => files!("side": "side.sumocfg", "side.net.xml", "side.rou.xml"),
            Self::Town => files!("town": "town.sumocfg", "town.net.xml", "town.rou.xml", "town.add.xml"),
        }
    }
}

/// Writes the files, replacing none, and prints what to do next.
pub fn run(arguments: &ExampleArgs) -> Result<()> {
    let files = arguments.name.files();
    let name = arguments.name.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default();
    let out = arguments.out.clone().unwrap_or_else(|| PathBuf::from(&name));
    if let Some((taken, _)) = files.iter().find(|(file, _)| out.join(file).exists()) {
        return Err(value(format!("{} is there already; choose another --out", out.join(taken).display())));
    }
    std::fs::create_dir_all(&out).map_err(|source| RunError::file(&out, source))?;
    files.iter().try_for_each(|(file, bytes)| output_file::write(&out.join(file), bytes))?;
    let configuration = files.first().map_or(Path::new(""), |(file, _)| Path::new(file));
    print(format_args!("{name} in {}; check it: closecall run {}\n", out.display(), out.join(configuration).display()))
}
