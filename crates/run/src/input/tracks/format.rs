//! The formats of recordings.

/// A format of recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
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
    pub fn name(self) -> &'static str {
        match self {
            Self::Fcd => "fcd",
            Self::Trj => "trj",
            Self::Fzp => "fzp",
            Self::Table => "table",
            Self::InD => "inD",
            Self::HighD => "highD",
            Self::Ngsim => "ngsim",
            Self::Interaction => "interaction",
            Self::Sind => "sind",
            Self::CitySim => "citysim",
            Self::OmegaPrime => "omega-prime",
        }
    }
}
