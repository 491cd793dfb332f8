//! Vehicles parked off the road: recorded by SUMO, but ignored as in a live run.

use super::Replay;
use super::lanes::distance;
use super::recorded_step::RecordedRow;
use closecall::traffic::net::Net;
use closecall::util::units::Metre;

/// A front bumper further than this outside its lane is not on it, in m: places are rounded, and a vehicle that changes lanes
/// slowly, as in SUMO's sublane model, is on the next lane once it is half-way.
const BESIDE: Metre = 0.2;

impl Replay {
    /// Whether a vehicle is parked off the road: it stands, and is drawn beside the lane that it is on. Where the net does not
    /// tell, the stops do.
    pub(super) fn is_parked(&mut self, row: &RecordedRow, net: Option<&Net>) -> bool {
        let on_net = net.and_then(|net| {
            self.vehicle_rows += 1;
            let lane = self.lanes.lane(row.lane, |lane| self.recorded_steps.lane(lane), net);
            self.unknown_lanes += u64::from(lane.is_none());
            Some((net, lane?))
        });
        match on_net {
            Some((net, lane)) => row.speed == 0.0 && distance(row, net, lane) > net.lanes[lane].width / 2.0 + BESIDE,
            None => self.stops.is_parked(self.recorded_steps.id(row.user), self.step.time),
        }
    }
}
