//! Runs of closecall: recordings and SUMO's files in, logs out.
//!
//! ```
//! use closecall_run::{Replay, Run, RunOptions};
//!
//! let folder = tempfile::tempdir().unwrap();
//! let recording = folder.path().join("fcd.xml");
//! let car = |time: u32, id: &str, x: f64, speed: f64| {
//!     let x = x + speed * f64::from(time);
//!     format!(r#"<vehicle id="{id}" x="{x}" y="0" angle="90" speed="{speed}" type="car"/>"#)
//! };
//! let step = |time| format!(r#"<timestep time="{time}">{}{}</timestep>"#, car(time, "b", 40.0, 0.0), car(time, "a", 0.0, 15.0));
//! std::fs::write(&recording, format!("<fcd-export>{}</fcd-export>", (0..3).map(step).collect::<String>())).unwrap();
//!
//! let options = RunOptions::default();
//! let mut replay = Replay::open(&recording, &[], None, &options.model)?;
//! let mut run = Run::new(&options, None)?;
//! while replay.next(&mut run)?.is_some() {}
//! run.finish()?;
//! assert_eq!(&*run.conflicts()[0].ego, "a");
//! # Ok::<(), closecall_run::Error>(())
//! ```
//!
//! | module | what is in it |
//! |---|---|
//! | [`util`] | opening files, and writing them whole |
//! | [`net`] | SUMO's nets as files |
//! | [`options`] | the settings of a run: those of the method, and those of its log; command line, TOML and Python |
//! | [`output`] | the columns of a conflict, the log, `run.json`, the formats of other tools |
//! | [`run`] | one run: its step, its life cycle with a log |
//! | [`input`] | recordings that are replayed, also other tools'; SUMO's own files |

pub mod error;
pub mod input;
pub mod net;
pub mod options;
pub mod output;
pub mod run;
pub mod util;

pub use error::{Error, Result};
pub use input::replay::Replay;
pub use options::RunOptions;
pub use output::folder::LogFolder;
pub use output::formats::OutputFiles;
pub use output::palette;
pub use output::record::RunRecord;
pub use output::summary::Summary;
pub use run::Run;
pub use run::recorded::{Ending, RecordedRun};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_public_types_may_go_to_another_thread() {
        fn check<T: Send>() {}
        check::<(Run, Replay, RecordedRun, RunRecord, RunOptions)>();
        check::<(Summary, LogFolder, OutputFiles, Ending)>();
        check::<Error>();
    }
}
