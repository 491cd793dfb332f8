//! The choices that no other beats.

/// Run times whose ratio is smaller are equal: repeated medians differ by about this.
const SAME_TIME: f64 = 1.05;

/// Whether none of the others beats this point of run time and error in one of them or both.
pub fn is_on_front(point: [f64; 2], mut others: impl Iterator<Item = [f64; 2]>) -> bool {
    let [time, error] = point;
    !others.any(|[other_time, other_error]| {
        let faster = other_time * SAME_TIME < time;
        let slower = time * SAME_TIME < other_time;
        other_error <= error && !slower && (faster || other_error < error)
    })
}
