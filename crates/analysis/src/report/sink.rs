//! Where the parts of the page go, and how its data writes values.

use crate::Result;

/// Takes the parts of a page, one after the other.
pub(super) type Sink<'a> = dyn FnMut(&[u8]) -> Result<()> + 'a;

/// JSON without a `<`.
pub(super) fn escaped(json: &str) -> String {
    json.replace('<', "\\u003c")
}

/// A number with this many decimals.
pub(super) fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10_f64.powi(decimals);
    // Adding 0 turns -0 into 0.
    (value * scale).round() / scale + 0.0
}

/// The place of a value among all that there are.
pub(super) fn rank<T: PartialEq>(all: &[T], one: T) -> usize {
    all.iter().position(|known| *known == one).unwrap_or_default()
}
