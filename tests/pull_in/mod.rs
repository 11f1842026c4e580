//! Pull-in thresholds against references, closed forms, a scan, and motions.

mod case;
mod closed_form;
mod motion;
mod reference;
mod scan;

/// Relative error where only the rounding of a few operations, here and in the
/// function, counts: some tens of units in the last place.
const ROUNDING_ERROR: f64 = 1e-14;

/// Fails if `actual` differs from `expected` by more than `error`.
#[track_caller]
fn assert_within(actual: f64, expected: f64, error: f64, what: &str) {
    let difference = (actual - expected).abs();
    assert!(
        difference <= error,
        "{what}: {actual} for {expected}, off by {difference:e}"
    );
}

/// Fails if `actual` differs from `expected` by more than rounding.
#[track_caller]
fn assert_rounded(actual: f64, expected: f64, what: &str) {
    assert_within(actual, expected, ROUNDING_ERROR * expected.abs(), what);
}
