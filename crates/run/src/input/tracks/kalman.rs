//! Kalman's filter over a track, forward, with the model of a constant acceleration which white noise changes; steps may be of any
//! length. Where a place is further from its prediction than a vehicle can drive, the track jumps, and the filter begins anew.
//! Only the last step is in memory.

use nalgebra::{Matrix1x3, Matrix3, Matrix3x2, RowVector2, Vector3};

use super::spill::Row;
use closecall::geometry::Point;
use closecall::util::units::{Metre, Second};

/// The noise of the places of a recording that is not smoothed, in m: that which the drones' data sets state.
pub const USUAL_NOISE: Metre = 0.1;
/// Spectral density of the jerk, in m²/s⁵. Of 1, 3, 10, 30 and 100 the error of places at 25 Hz with white noise of 0.1 and 0.3 m differs
/// by 25 % at most in `sumo_nets/roundabout` and `reckless`; it is 5 % less with 3.
const JERK: f64 = 10.0;
/// Standard deviations of a speed and an acceleration before a track is known, in SI units.
const UNKNOWN: [f64; 2] = [40.0, 5.0];
/// A value further from its prediction than this number of standard deviations is not noise.
const SURE: f64 = 5.0;
/// A place nearer than this to its prediction is not a jump, in m: two vehicles that exchange identities are further apart.
const LEAST_JUMP: Metre = 2.0;

/// A place that its road user cannot have driven to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Jump {
    pub user: u32,
    pub time: Second,
    /// Where it was expected.
    pub expected: Point,
    pub found: Point,
}

/// Value, its change and the change of that, of two quantities.
pub(super) type State = Matrix3x2<f64>;

/// How noisy values are, and how they change.
#[derive(Clone, Copy)]
pub(super) struct Model {
    pub noise: f64,
    pub density: f64,
    pub unknown: [f64; 2],
    /// The least distance of a value from its prediction that is not noise.
    pub least_jump: f64,
}

impl Model {
    /// That of places with noise of this standard deviation.
    pub(crate) fn of_places(noise: Metre) -> Self {
        Self { noise, density: JERK, unknown: UNKNOWN, least_jump: LEAST_JUMP }
    }
}

/// A step of the filter, as the smoother needs it.
#[derive(Clone, Copy)]
pub(super) struct Filtered {
    pub transition: Matrix3<f64>,
    pub predicted: State,
    pub predicted_covariance: Matrix3<f64>,
    pub state: State,
    pub covariance: Matrix3<f64>,
    /// Whether the track jumps here, and the smoother does not look back beyond.
    pub begins: bool,
}

/// The filter, at a row of a track.
pub(super) struct Filter {
    model: Model,
    last: Option<(Second, Filtered)>,
}

impl Filter {
    /// Before the first row of a track.
    pub fn new(model: Model) -> Self {
        Self { model, last: None }
    }

    /// Goes on to the next row, in which this was found.
    pub fn step(&mut self, time: Second, found: [f64; 2]) -> Filtered {
        let Model { noise, density, unknown: [change, change_of_change], least_jump } = self.model;
        let measured = Matrix1x3::new(1.0, 0.0, 0.0);
        let variance = noise * noise;
        let unknown = Vector3::new(variance, change * change, change_of_change * change_of_change);
        let first = || (State::new(found[0], found[1], 0.0, 0.0, 0.0, 0.0), Matrix3::from_diagonal(&unknown));
        let lasted = self.last.as_ref().map_or(0.0, |(before, _)| time - before);
        let transition = Matrix3::new(1.0, lasted, lasted * lasted / 2.0, 0.0, 1.0, lasted, 0.0, 0.0, 1.0);
        let step = match &self.last {
            None => {
                let (state, covariance) = first();
                let (predicted, predicted_covariance) = (state, covariance);
                Filtered { transition, predicted, predicted_covariance, state, covariance, begins: true }
            }
            Some((_, last)) => {
                let predicted = transition * last.state;
                let predicted_covariance =
                    transition * last.covariance * transition.transpose() + jerks(lasted) * density;
                let off = [found[0] - predicted[(0, 0)], found[1] - predicted[(0, 1)]];
                let expected = predicted_covariance[(0, 0)] + variance;
                let begins = off[0].hypot(off[1]) > least_jump.max(SURE * expected.sqrt());
                let (state, covariance) = if begins {
                    first()
                } else {
                    let gain = predicted_covariance.column(0) / expected;
                    let state = predicted + gain * RowVector2::new(off[0], off[1]);
                    (state, (Matrix3::identity() - gain * measured) * predicted_covariance)
                };
                Filtered { transition, predicted, predicted_covariance, state, covariance, begins }
            }
        };
        self.last = Some((time, step));
        step
    }
}

/// Finds the jumps of tracks, row by row.
pub(super) struct JumpFinder {
    user: u32,
    filter: Filter,
}

impl Default for JumpFinder {
    fn default() -> Self {
        Self { user: 0, filter: Filter::new(Model::of_places(USUAL_NOISE)) }
    }
}

impl JumpFinder {
    /// The jump to this row, which follows the last one or is the first of another road user.
    pub fn next(&mut self, row: &Row) -> Option<Jump> {
        if row.user != self.user {
            *self = Self { user: row.user, ..Self::default() };
        }
        let is_first = self.filter.last.is_none();
        let step = self.filter.step(row.time, [row.values[0], row.values[1]]);
        (step.begins && !is_first).then(|| jump(row, &step))
    }
}

/// The jump to a row at which the filter begins anew.
pub(super) fn jump(row: &Row, step: &Filtered) -> Jump {
    let expected = Point::new(step.predicted[(0, 0)], step.predicted[(0, 1)]);
    Jump { user: row.user, time: row.time, expected, found: Point::new(row.values[0], row.values[1]) }
}

/// The covariance that white jerk of density 1 adds within a time.
fn jerks(lasted: Second) -> Matrix3<f64> {
    let power = |exponent: i32| lasted.powi(exponent);
    let [a, b, c] = [power(5) / 20.0, power(4) / 8.0, power(3) / 6.0];
    Matrix3::new(a, b, c, b, power(3) / 3.0, power(2) / 2.0, c, power(2) / 2.0, lasted)
}
