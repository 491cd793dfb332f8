//! Single formulas on arrays: μ, and contact and distance of rectangles.

use clap::ValueEnum;
use closecall::geometry::Vector;
use closecall::geometry::rectangle::Rectangle;
use closecall::options::{BUILD_UP, EPSILON, RESPONSE};
use closecall::util::limits::{self, Limit};
use closecall::{Brakes, Braking, Kind, MuModel, Point, SumoType};
use numpy::ndarray::{ArrayD, ArrayViewD, Ix2, IxDyn};
use numpy::{IntoPyArray, PyArrayDyn};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::numbers::numbers;

/// The minimal collision distance of an ego and a foe, in m; arrays broadcast as in NumPy.
///
/// Args:
///     speed, foe_speed: m/s, 0 to 1000.
///     decel, foe_decel: braking decelerations in m/s², 0.01 to 1000; 9.0 by default.
///     response_time: time t1 + t2 at full speed before braking begins, in s; 1.05 by default.
///     build_up: time t3 in which the deceleration builds up, in s; 0.1 by default.
///     epsilon: reserve ε of μ, in m; 0.5 by default.
///     kind: "rear_end", "side" or "frontal", which sets the cosine of the angle between the headings to 1, 0 or -1.
///     model: "minimal", "at_rest", "paper" or "rss", which has values of its own for the times and decelerations.
///     angle: the angle between the headings in rad, 0 to π, instead of the kind.
///
/// Raises:
///     ValueError: a value is out of its range; the message names it.
#[pyfunction]
#[pyo3(signature = (
    speed, foe_speed, *, decel=None, foe_decel=None, response_time=None, build_up=None, epsilon=None,
    kind="rear_end", model="minimal", angle=None,
))]
#[expect(clippy::too_many_arguments, reason = "each is a keyword in Python")]
pub fn mu<'py>(
    py: Python<'py>,
    speed: &Bound<'py, PyAny>,
    foe_speed: &Bound<'py, PyAny>,
    decel: Option<&Bound<'py, PyAny>>,
    foe_decel: Option<&Bound<'py, PyAny>>,
    response_time: Option<&Bound<'py, PyAny>>,
    build_up: Option<&Bound<'py, PyAny>>,
    epsilon: Option<&Bound<'py, PyAny>>,
    kind: &str,
    model: &str,
    angle: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let bad = |message: String| PyValueError::new_err(message);
    let kind =
        Kind::from_str(kind, false).map_err(|_| bad(format!("kind is \"{kind}\": rear_end, frontal or side")))?;
    let angles = angle.map(|angle| numbers("angle", angle)).transpose()?;
    let is_angle = |angle: &f64| (0.0..=std::f64::consts::PI).contains(angle);
    if let Some(angle) = angles.iter().flatten().find(|angle| !is_angle(angle)) {
        return Err(bad(format!("angle is {angle}, it must be 0 to π")));
    }
    let sigmas = angles.map_or_else(|| ArrayD::from_elem(IxDyn(&[]), kind.sigma()), |angles| angles.mapv(f64::cos));
    let model = MuModel::from_str(model, false)
        .map_err(|_| bad(format!("model is \"{model}\": minimal, at_rest, paper or rss")))?;
    let given = |name: &'static str, values: Option<&Bound<PyAny>>, default: f64| {
        let values = values.map_or_else(|| Ok(ArrayD::from_elem(IxDyn(&[]), default)), |values| numbers(name, values));
        Ok::<_, PyErr>((name, values?))
    };
    let car = SumoType::car("");
    let columns = [
        given("speed", Some(speed), 0.0)?,
        given("foe_speed", Some(foe_speed), 0.0)?,
        given("decel", decel, car.emergency_decel)?,
        given("foe_decel", foe_decel, car.emergency_decel)?,
        given("response_time", response_time, RESPONSE)?,
        given("build_up", build_up, BUILD_UP)?,
        given("epsilon", epsilon, EPSILON)?,
    ];
    for (name, values) in &columns {
        let limit = match *name {
            "decel" | "foe_decel" => &limits::DECELERATION,
            "epsilon" => &limits::RESERVE,
            "speed" | "foe_speed" => &limits::SPEED,
            _ => &limits::DURATION,
        };
        values.iter().try_for_each(|value| limit.check(name, *value).map(|_| ())).map_err(bad)?;
    }
    let [speed, foe_speed, decel, foe_decel, response_time, build_up, epsilon] = columns;
    let columns = [speed, foe_speed, decel, foe_decel, response_time, build_up, epsilon, ("angle", sigmas)];
    let shape = columns.iter().try_fold(Vec::new(), |shape, (name, values)| {
        broadcast(&shape, values.shape()).ok_or_else(|| bad(format!("{name} does not broadcast with the others")))
    })?;
    let views = columns.each_ref().map(|(_, values)| values.broadcast(IxDyn(&shape)));
    let [Some(v), Some(vi), Some(a), Some(ai), Some(r), Some(t3), Some(e), Some(sigmas)] = views else {
        return Err(bad("the arrays do not broadcast".to_owned()));
    };
    let found = py.detach(|| {
        let at = |view: &ArrayViewD<f64>, index: &IxDyn| view[index.clone()];
        ArrayD::from_shape_fn(IxDyn(&shape), |index| {
            let brakes = Brakes { response: at(&r, &index), build_up: at(&t3, &index), deceleration: at(&a, &index) };
            let foe_brakes = Brakes { deceleration: at(&ai, &index), ..brakes };
            let ego = Braking { speed: at(&v, &index), brakes: &brakes };
            let foe = Braking { speed: at(&vi, &index), brakes: &foe_brakes };
            closecall::mu(model, ego, foe, at(&sigmas, &index), at(&e, &index))
        })
    });
    Ok(found.into_pyarray(py))
}

/// The shape that two shapes broadcast to, by NumPy's rules.
fn broadcast(a: &[usize], b: &[usize]) -> Option<Vec<usize>> {
    let length = a.len().max(b.len());
    let at = |shape: &[usize], place: usize| (place + shape.len()).checked_sub(length).map_or(1, |place| shape[place]);
    (0..length)
        .map(|place| match (at(a, place), at(b, place)) {
            (a, b) if a == b => Some(a),
            (1, other) | (other, 1) => Some(other),
            _ => None,
        })
        .collect()
}

/// Whether rectangles touch, row by row; touching counts as contact.
///
/// Args:
///     a, b: n rows `x, y, heading, length, width`: centre in m, heading in rad, dimensions in m.
///
/// Returns:
///     n booleans.
///
/// Raises:
///     ValueError: an array does not have 5 columns, the numbers of rows differ, or a value is out of its range; the
///         message names it.
#[pyfunction]
pub fn touches(py: Python, a: &Bound<PyAny>, b: &Bound<PyAny>) -> PyResult<Py<PyAny>> {
    let pairs = pairs(a, b)?;
    let found =
        py.detach(|| pairs.iter().map(|(a, b)| closecall::geometry::contact::touches(a, b)).collect::<Vec<_>>());
    Ok(found.into_pyarray(py).into_any().unbind())
}

/// The smallest distance between rectangles, in m, row by row; 0 where they touch or overlap.
///
/// Args and errors as for `touches`.
#[pyfunction]
pub fn distance(py: Python, a: &Bound<PyAny>, b: &Bound<PyAny>) -> PyResult<Py<PyAny>> {
    let pairs = pairs(a, b)?;
    let found =
        py.detach(|| pairs.iter().map(|(a, b)| closecall::geometry::contact::distance(a, b)).collect::<Vec<_>>());
    Ok(found.into_pyarray(py).into_any().unbind())
}

/// The columns of a rectangle, each with its limit; it may be a line or a point.
const RECTANGLE: [(&str, Limit); 5] = [
    ("x", limits::POSITION),
    ("y", limits::POSITION),
    ("heading", limits::ANGLE),
    ("length", Limit { is_open: false, ..limits::LENGTH }),
    ("width", Limit { is_open: false, ..limits::LENGTH }),
];

fn pairs(a: &Bound<PyAny>, b: &Bound<PyAny>) -> PyResult<Vec<(Rectangle, Rectangle)>> {
    let rows = |name: &str, values: &Bound<PyAny>| {
        let values = numbers(name, values)?;
        let dimensions = values.ndim();
        let message = |_| PyValueError::new_err(format!("{name} has {dimensions} dimensions; rows and columns are 2"));
        values.into_dimensionality::<Ix2>().map_err(message)
    };
    let (a, b) = (rows("a", a)?, rows("b", b)?);
    for (name, rows) in [("a", &a), ("b", &b)] {
        if rows.ncols() != 5 {
            let found = rows.ncols();
            return Err(PyValueError::new_err(format!(
                "{name} has {found} columns; x, y, heading, length, width are 5"
            )));
        }
        if rows.nrows() != a.nrows() {
            return Err(PyValueError::new_err(format!("a has {} rows, b has {}", a.nrows(), rows.nrows())));
        }
        for (number, row) in rows.rows().into_iter().enumerate() {
            for ((column, limit), value) in RECTANGLE.iter().zip(row) {
                let checked = limit.check(column, *value);
                checked.map_err(|why| PyValueError::new_err(format!("{name}, row {number}: {why}")))?;
            }
        }
    }
    let rectangle = |row: numpy::ndarray::ArrayView1<f64>| {
        // The axis is exactly the cosine and sine of the heading, so that a check can compute the same corners.
        let (sine, cosine) = row[2].sin_cos();
        let centre = Point::new(row[0], row[1]);
        let axis = Vector::new(cosine, sine);
        Rectangle { centre, axis, half_length: row[3] / 2.0, half_width: row[4] / 2.0 }
    };
    Ok(a.rows().into_iter().zip(b.rows()).map(|(a, b)| (rectangle(a), rectangle(b))).collect())
}
