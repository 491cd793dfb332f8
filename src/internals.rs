//! What the bridge, the benches and the tests of this repository use of the crate besides its public interface.
//!
//! Not part of that interface: anything here may change in any version.

#[cfg(feature = "cli")]
pub mod analysis {
    pub use crate::analysis::export;
    pub use crate::analysis::filter::{ConflictFilter, Place};
    pub use crate::analysis::logged::{ConflictReader, LoggedRun, Which};
    pub use crate::analysis::playback::{Playback, svg};
    #[cfg(feature = "plot")]
    pub use crate::analysis::plot;
    pub use crate::analysis::report;
    pub use crate::analysis::statistics::{Observed, Request, Statistics};
}

#[cfg(feature = "cli")]
pub mod batch {
    #[cfg(feature = "parquet")]
    pub use crate::analysis::logged::RunTime;
    pub use crate::batch::regress::outcome::Outcome;
    pub use crate::batch::regress::scenario::RegressSettings;
    pub use crate::batch::regress::statistics::comparisons;
    #[cfg(feature = "parquet")]
    pub use crate::batch::sweep::Task;
}

pub mod braking {
    pub use crate::braking::stopping_distance;
}

pub mod detection {
    pub use crate::detection::detector::LeftOut;
    pub use crate::detection::measures::ttc::{HORIZON, SteadyMotion, time_to_collision};
    pub use crate::detection::path::Pose;
    pub use crate::detection::path::track::Track;
}

pub mod geometry {
    pub use crate::geometry::bisection::Bisection;
    pub use crate::geometry::contact::{distance, plainly_touches, touches};
    pub use crate::geometry::convex::ConvexOutline;
    pub use crate::geometry::movement::{Movement, TOLERANCE};
    pub use crate::geometry::polygon::Polygon;
    pub use crate::geometry::polylines::Lines;
    pub use crate::geometry::rectangle::{Rectangle, direction};
    pub use crate::geometry::separating_axes::{Contact, slide, translation};
    pub use crate::geometry::{Bounds, Vector};
}

pub mod input {
    pub use crate::input::replay::demand::{self, PlannedRoutes};
    pub use crate::input::replay::lights::RecordedLights;
    pub use crate::input::replay::recording::Recording;
    pub use crate::input::replay::routes::Routes;
    pub use crate::input::replay::rows::RecordedStep;
    pub use crate::input::sumo_files::{check_xml, fault, net_of};
    #[cfg(feature = "cli")]
    pub use crate::input::tracks::{
        NOISE, Opened as OpenedTracks, RecordingFormat, TrackOptions, TrackOrigin, USUAL_NOISE, columns_read,
        inspect as inspect_tracks, open as open_tracks,
    };
}

pub mod options {
    #[cfg(feature = "cli")]
    pub use crate::options::OptionsFile;
    pub use crate::options::{BUILD_UP, EPSILON, RESPONSE};
}

pub mod output {
    #[cfg(feature = "cli")]
    pub use crate::output::formats::ExportFormat;
    pub use crate::output::input_hash::Input;
    pub use crate::output::log::Log;
    pub use crate::output::record::Versions;
    pub use crate::output::schema::{COLUMNS, Column, ColumnType, Context, LoggedConflict, Presence, Value};
}

pub mod run {
    pub use crate::run::step::StepPart;
}

#[cfg(feature = "study")]
pub mod study {
    pub use crate::study::reference::chance::Chance;
    pub use crate::study::stress::car;
}

pub mod traffic {
    pub use crate::traffic::frame::SUMO_INVALID;
    pub use crate::traffic::net::EdgeFunction;
    pub use crate::traffic::net::filter::Filter;
    pub use crate::traffic::profile::Carriage;
}

pub mod util {
    pub use crate::util::decimal::Written;
    pub use crate::util::limits;
    pub use crate::util::panics::caught;
    pub use crate::util::threads::{Helper, Team, processors};
    pub use crate::util::units::Second;
}
