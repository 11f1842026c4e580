//! The largest of some errors.

/// The largest of these sizes; NaN if one is NaN, which `f64::max` would leave out.
pub fn largest(errors: impl IntoIterator<Item = f64>) -> f64 {
    errors.into_iter().fold(0.0, |largest, error| {
        let size = error.abs();
        if size.is_nan() || size > largest {
            size
        } else {
            largest
        }
    })
}
