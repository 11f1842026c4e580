//! The quasi-static threshold: Eq. 16 at rest.
//!
//! Without the terms of motion Eq. 16 gives the equilibrium curve, with
//! z = 1/λ,
//!
//! > Ψ = a3 + a5/z² + a1 z² − S z³ − z⁸,  dΨ/dz = 2z D,
//! > D = a1 − (3/2) S z − a5/z⁴ − 4z⁶.
//!
//! D is strictly concave in z as a sum of concave terms, for a5 ≥ 0 and any S.
//! So the equilibrium curve, which comes from −∞ at λ → 0, has at most one
//! maximum and, after it, at most one minimum.

use super::Threshold;
use super::fold::{VoltageCurve, first_maximum, minimum_after};
use crate::actuator::Coefficients;

/// Threshold of quasi-static pull-in, under a voltage raised slowly from zero
/// after the prestress: the maximum of the equilibrium curve, a saddle-node at
/// which the branch of contracted equilibria ends.
///
/// It counts only if the actuator is on that branch before it, led there from
/// λ = 1 by the force without voltage. A maximum at λ ≥ 1 always counts: for
/// γ, τ, E ≥ 0 the force without voltage is monotone there, so Ψ ≥ 0 from the
/// maximum on. One at λ < 1 does not if Ψ < 0 at the minimum after it: then the
/// contracted branch is a second state without voltage, shut off from λ = 1 (by
/// surface elasticity E > 29 under compression), and the actuator rests on the
/// outer branch, which has no fold. `None` then, and where there is no maximum.
#[must_use]
pub fn quasi_static(coefficients: &Coefficients, prestress: f64) -> Option<Threshold> {
    let curve = EquilibriumCurve {
        coefficients,
        prestress,
    };
    let z = first_maximum(&curve, curve.rising_from())?;
    if z > 1.0 && curve.voltage_squared(minimum_after(&curve, z)) < 0.0 {
        return None;
    }
    Some(Threshold::at(&curve, z))
}

/// Ψ in z = 1/λ > 0.
struct EquilibriumCurve<'a> {
    coefficients: &'a Coefficients,
    prestress: f64,
}

impl EquilibriumCurve<'_> {
    /// A z from which on the curve rises with stretch, as 4z⁶ exceeds what is
    /// positive in D: 4z⁶ ≥ 4uz for z ≥ u ≥ 1, and 4u > a1 + (3/2)|S|.
    fn rising_from(&self) -> f64 {
        1.0 + (self.coefficients.linear.abs() + 1.5 * self.prestress.abs()) / 4.0
    }
}

impl VoltageCurve for EquilibriumCurve<'_> {
    fn voltage_squared(&self, z: f64) -> f64 {
        let a = self.coefficients;
        let z2 = z * z;
        a.cubic + a.quintic / z2 + z2 * (a.linear - self.prestress * z - z2 * z2 * z2)
    }

    fn descent(&self, z: f64) -> f64 {
        let a = self.coefficients;
        let z4 = (z * z) * (z * z);
        a.linear - 1.5 * self.prestress * z - a.quintic / z4 - 4.0 * z4 * z * z
    }

    fn descent_slope(&self, z: f64) -> f64 {
        let z5 = (z * z) * (z * z) * z;
        4.0 * self.coefficients.quintic / z5 - 24.0 * z5 - 1.5 * self.prestress
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COEFFICIENTS: Coefficients = Coefficients {
        inertia: 100.0,
        linear: 1.7,
        cubic: 0.4,
        quintic: 0.3,
    };

    #[test]
    fn derivatives_agree_with_differences_and_the_descent_is_concave() {
        for prestress in [-40.0, -1.0, 0.0, 0.3, 900.0] {
            let curve = EquilibriumCurve {
                coefficients: &COEFFICIENTS,
                prestress,
            };
            let mut before = f64::INFINITY;
            for z in (1..=300).map(|i| f64::from(i) / 100.0) {
                let h = 1e-4 * z;
                let difference = |f: &dyn Fn(f64) -> f64| (f(z + h) - f(z - h)) / (2.0 * h);
                // Central difference: relative error a few (h/z)² = 1e-8 of the
                // largest term, times the square of its exponent.
                let scale = 1.0 + prestress.abs() * z + z.powi(6) + z.powi(-6);
                let slope = difference(&|z| curve.voltage_squared(z));
                assert!((slope - 2.0 * z * curve.descent(z)).abs() < 1e-6 * scale * (1.0 + z));
                let descent_slope = curve.descent_slope(z);
                let bend = difference(&|z| curve.descent(z));
                assert!((bend - descent_slope).abs() < 1e-6 * scale * (1.0 + z));
                assert!(descent_slope < before);
                before = descent_slope;
            }
        }
    }

    #[test]
    fn the_curve_rises_from_the_bound_on() {
        for linear in [-400.0, -1.0, 0.0, 1.0, 400.0] {
            for prestress in [-1000.0, -1.0, 0.0, 1.0, 1000.0] {
                let coefficients = Coefficients {
                    linear,
                    quintic: 0.0,
                    ..COEFFICIENTS
                };
                let curve = EquilibriumCurve {
                    coefficients: &coefficients,
                    prestress,
                };
                for factor in [1.0, 1.5, 10.0] {
                    assert!(curve.descent(factor * curve.rising_from()) < 0.0);
                }
            }
        }
    }
}
