//! What may make the result of a replay differ from that of the simulation.

use super::Replay;
use closecall::util::limits::said_of_noise;
use closecall::util::remark::{Remark, RemarkCode};

/// The number of undefined types that a remark names.
const NAMED_TYPES: usize = 5;

impl Replay {
    /// What may make the result differ from that of the simulation, a line each.
    pub fn remarks(&self) -> Vec<Remark> {
        let speeds = said_of_noise(self.left_out.below_zero);
        let found = [
            (RemarkCode::UndefinedTypes, self.undefined_types()),
            (RemarkCode::UnknownLanes, self.unknown_lanes()),
            (RemarkCode::UnknownRoutes, self.unknown_routes()),
            (RemarkCode::OtherElements, self.other_elements()),
            (RemarkCode::NoisySpeeds, speeds),
        ];
        found.into_iter().filter_map(|(code, text)| Some(Remark::new(code, text?))).collect()
    }

    fn other_elements(&self) -> Option<String> {
        let elements = self.left_out.elements;
        (elements > 0).then(|| {
            format!("left out: {elements} elements of the recording's steps are neither vehicles nor persons (containers, for one)")
        })
    }

    fn undefined_types(&self) -> Option<String> {
        let quoted = |name: &String| if name.is_empty() { "(none)".to_owned() } else { format!("\"{name}\"") };
        let names = self.undefined.iter().take(NAMED_TYPES).map(quoted).collect::<Vec<_>>().join(", ");
        let more = match self.undefined.len().saturating_sub(NAMED_TYPES) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        (!names.is_empty()).then(|| {
            format!("types {names}{more}: no file defines them, so they are SUMO's default car or pedestrian (--route-files)")
        })
    }

    fn unknown_lanes(&self) -> Option<String> {
        let share = 100.0 * self.unknown_lanes as f64 / self.vehicle_rows.max(1) as f64;
        // As little as rounds to 0 is not none.
        let share = if share < 0.1 { "less than 0.1".to_owned() } else { format!("{share:.1}") };
        (self.unknown_lanes > 0)
            .then(|| format!("lanes: {share} % of the vehicle-steps are on no lane of the net (--net)"))
    }

    fn unknown_routes(&self) -> Option<String> {
        let gaps = self.routes.as_ref().map_or(0, |routes| routes.gaps);
        let places = if gaps == 1 { "place" } else { "places" };
        (gaps > 0).then(|| {
            format!(
                "routes: at {gaps} {places} no step shows which edges were driven, and neither a route file nor a shortest \
                 connection tells (--route-files)"
            )
        })
    }
}
