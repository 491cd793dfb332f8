//! The formats of recordings.

use clap::ValueEnum;

/// A format of recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RecordingFormat {
    /// SUMO's fcd-output.
    Fcd,
    /// SSAM's trajectories, 1.04 and 3.0.
    Trj,
    /// Vissim's vehicle record, with COORDFRONT and COORDREAR.
    Fzp,
    /// Any table, with --columns.
    Table,
    /// inD, rounD, exiD and uniD.
    #[value(name = "inD", alias = "ind", aliases = ["rounD", "exiD", "uniD"])]
    InD,
    /// highD.
    #[value(name = "highD", alias = "highd")]
    HighD,
    /// NGSIM.
    Ngsim,
    /// INTERACTION.
    Interaction,
    /// SinD.
    #[value(name = "sind", alias = "SinD")]
    Sind,
    /// CitySim.
    #[value(name = "citysim", alias = "CitySim")]
    CitySim,
    /// OMEGA-Prime.
    OmegaPrime,
}

impl RecordingFormat {
    /// Its name on the command line.
    pub fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}
