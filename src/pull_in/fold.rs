//! The first maximum of a curve of squared voltage over stretch.
//!
//! Method: neither curve is searched as it is. Each has a *descent* D(z),
//! z = 1/λ, that is positive where the curve falls with growing stretch, and
//! that is proved in its module to be strictly concave in a variable which
//! grows with z. So D has one crest and at most two zeros: the larger z is the
//! only maximum of the curve, the smaller z its only minimum, and there are
//! none if the crest is not above zero. Three facts of one kind follow (a
//! condition that holds left of one point and fails right of it), and bisection
//! answers each, with nothing to assume, tune or isolate. A polynomial in z
//! would have degree 12 for the stagnation curve, and its roots would have to
//! be isolated first.
//!
//! Accuracy: the zero of the *computed* D, to neighbouring doubles. The crest
//! is flat, so the existence of a fold is decided to the rounding error of D
//! itself, a few 1e-16 of its largest term, even at a cusp.

/// φ² as a function of z = 1/λ > 0, with what locates its extrema.
pub(super) trait VoltageCurve {
    /// φ² at `z`.
    fn voltage_squared(&self, z: f64) -> f64;

    /// D(z): a positive multiple of the slope of φ² over z, so positive where
    /// φ² falls with growing stretch.
    fn descent(&self, z: f64) -> f64;

    /// A positive multiple of the slope of D over z: positive below the crest,
    /// negative above it.
    fn descent_slope(&self, z: f64) -> f64;
}

/// Smallest z considered (λ = 1e50). It stands for 0, where the terms with E
/// are not defined, and is far below the z of any maximum: those shrink no
/// faster than a1/S.
pub(super) const SMALLEST_Z: f64 = 1e-50;

/// The z of the first maximum of `curve` with growing stretch, for z from
/// `largest_z` down. The curve must rise at `largest_z`, that is D ≤ 0 there.
pub(super) fn first_maximum(curve: &impl VoltageCurve, largest_z: f64) -> Option<f64> {
    let crest = last_where(SMALLEST_Z, largest_z, |z| curve.descent_slope(z) > 0.0);
    (curve.descent(crest) > 0.0).then(|| last_where(crest, largest_z, |z| curve.descent(z) > 0.0))
}

/// The z of the minimum that follows the maximum at `maximum`; [`SMALLEST_Z`]
/// where the curve falls for ever.
pub(super) fn minimum_after(curve: &impl VoltageCurve, maximum: f64) -> f64 {
    last_where(SMALLEST_Z, maximum, |z| curve.descent(z) <= 0.0)
}

/// The last double in `[lower, upper)` at which `holds` is true, for a
/// condition that is true up to some point and false from there on; `lower` if
/// it never holds, the double before `upper` if it always does.
///
/// Positive doubles have the order of their bit patterns. Halving between the
/// patterns, not the values, takes at most 64 evaluations at any scale and
/// needs no tolerance.
fn last_where(lower: f64, upper: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let (mut left, mut right) = (lower.to_bits(), upper.to_bits());
    while left + 1 < right {
        let middle = left.midpoint(right);
        if holds(f64::from_bits(middle)) {
            left = middle;
        } else {
            right = middle;
        }
    }
    f64::from_bits(left)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curve with the descent −(z − near)(z − far), and itself as integral.
    struct Parabola {
        near: f64,
        far: f64,
    }

    impl VoltageCurve for Parabola {
        fn voltage_squared(&self, z: f64) -> f64 {
            -z * z * z / 3.0 + (self.near + self.far) * z * z / 2.0 - self.near * self.far * z
        }
        fn descent(&self, z: f64) -> f64 {
            (z - self.near) * (self.far - z)
        }
        fn descent_slope(&self, z: f64) -> f64 {
            self.near + self.far - 2.0 * z
        }
    }

    #[test]
    fn last_where_ends_at_neighbouring_doubles() {
        for edge in [1e-40, 1e-17, 0.3, 1.0, 377.0] {
            let found = last_where(SMALLEST_Z, 400.0, |z| z <= edge);
            assert_eq!(found, edge);
        }
    }

    #[test]
    fn last_where_answers_at_both_ends() {
        assert_eq!(last_where(0.25, 1.0, |_| false), 0.25);
        assert_eq!(last_where(0.25, 1.0, |_| true), 1.0_f64.next_down());
        assert_eq!(last_where(1.0, 1.0, |_| true), 1.0);
    }

    #[test]
    fn last_where_is_bounded_for_any_condition() {
        let evaluations = std::cell::Cell::new(0);
        last_where(0.0, f64::INFINITY, |z| {
            evaluations.set(evaluations.get() + 1);
            z.to_bits() % 3 == 0
        });
        assert!(evaluations.get() <= 64);
    }

    #[test]
    fn extrema_of_separate_and_of_clustered_zeros() {
        // The gaps are exact in binary and wider than the spacing of doubles.
        for gap in [0.5, 1e-3, 1e-6, f64::powi(2.0, -40), f64::powi(2.0, -50)] {
            let curve = Parabola {
                near: 0.25,
                far: 0.25 + gap,
            };
            let maximum = first_maximum(&curve, 1.0).expect("the zeros differ");
            // The descent is strictly positive left of `far` only.
            assert_eq!(maximum, curve.far.next_down(), "gap {gap}");
            assert_eq!(minimum_after(&curve, maximum), curve.near, "gap {gap}");
        }
    }

    #[test]
    fn double_zero_is_no_maximum() {
        assert_eq!(
            first_maximum(
                &Parabola {
                    near: 0.25,
                    far: 0.25
                },
                1.0
            ),
            None
        );
    }

    #[test]
    fn zeros_beyond_the_range_are_no_maximum() {
        assert_eq!(
            first_maximum(
                &Parabola {
                    near: 1.5,
                    far: 2.5
                },
                1.0
            ),
            None
        );
    }

    #[test]
    fn a_curve_that_falls_for_ever_has_its_minimum_at_the_smallest_z() {
        let curve = Parabola {
            near: -1.0,
            far: 0.5,
        };
        assert_eq!(minimum_after(&curve, 0.5), SMALLEST_Z);
    }
}
