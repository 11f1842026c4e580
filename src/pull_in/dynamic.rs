//! The dynamic threshold: Eqs. 19 and 20.
//!
//! Eq. 19 divided by λ⁴ − 1 gives the stagnation curve. Both sides have the
//! factor λ − 1; without it, with z = 1/λ, e = a5/3 and k = a1 + e,
//!
//! > Φ = a3 + 2e/z² − z⁴ + 2k z²/(1+z²) − 4S z³/((1+z)(1+z²)),
//! > dΦ/dz = 4z D/(1+z²)²,
//! > D = k − S r(z) − e (1+z⁻²)² − z²(1+z²)²,  r = z + 2z/(1+z)²,
//!
//! with no cancellation at λ = 1, where Φ = 2(γ+τ) − S is the voltage that
//! makes rest an equilibrium. D = 0 is Eq. 20 without the spurious root λ = 1.
//!
//! D is strictly concave in r, and r grows with z, on 0 < z ≤ 1. For with
//! r' = q/(1+z)³, q = 3 + z + 3z² + z³,
//!
//! > (dD/dz)/r' = −S + [4e/z⁵ − 2z(1+3z²)] (1+z²)(1+z)³/q,
//!
//! and its first part in e, 4e (1+z⁻²)(1+1/z)³/q, is a product of decreasing
//! factors, while the second has z(1+3z²)(1+z²), increasing, over r',
//! decreasing as r'' = 4(z−2)/(1+z)⁴ < 0. So the stagnation curve has at most
//! one maximum and, after it, at most one minimum on λ > 1, whatever γ, τ, S
//! and E ≥ 0. A later maximum that could be a new record does not exist.

use super::Threshold;
use super::fold::{VoltageCurve, first_maximum};
use crate::actuator::Coefficients;

/// Threshold of dynamic pull-in from rest at λ = 1 with the voltage and the
/// prestress applied as steps: the first maximum of the stagnation curve on
/// λ ≥ 1. Above it the orbit passes the stretch at which it turned back before.
///
/// If the curve falls from λ = 1 on (2(γ−τ−E) > 3 + 3S/2: a strong surface
/// energy or compressive prestress), its maximum is λ = 1 itself: below
/// φ² = 2(γ+τ) − S the actuator contracts, above it leaves an unstable
/// equilibrium and nothing nearby turns it back. The thickness stretch is 1.
///
/// `None` where the curve has no maximum: the turning stretch then grows
/// steadily with voltage, to infinity at φ² = 4τ if E = 0.
#[must_use]
pub fn dynamic(coefficients: &Coefficients, prestress: f64) -> Option<Threshold> {
    let curve = StagnationCurve::new(coefficients, prestress);
    let z = if curve.descent(1.0) > 0.0 {
        1.0
    } else {
        first_maximum(&curve, 1.0)?
    };
    Some(Threshold::at(&curve, z))
}

/// Φ of Eq. 19 in z = 1/λ on (0, 1].
struct StagnationCurve {
    /// k = a1 + a5/3.
    stiffness: f64,
    /// a3.
    cubic: f64,
    /// e = a5/3, the surface elasticity E.
    elasticity: f64,
    /// S.
    prestress: f64,
}

impl StagnationCurve {
    fn new(coefficients: &Coefficients, prestress: f64) -> Self {
        let elasticity = coefficients.quintic / 3.0;
        Self {
            stiffness: coefficients.linear + elasticity,
            cubic: coefficients.cubic,
            elasticity,
            prestress,
        }
    }
}

impl VoltageCurve for StagnationCurve {
    fn voltage_squared(&self, z: f64) -> f64 {
        let z2 = z * z;
        let bending = 2.0 * (self.stiffness - 2.0 * self.prestress * z / (1.0 + z)) / (1.0 + z2);
        self.cubic + 2.0 * self.elasticity / z2 + z2 * (bending - z2)
    }

    fn descent(&self, z: f64) -> f64 {
        let z2 = z * z;
        let surface = (1.0 + z2) / z2;
        let elastic = z * (1.0 + z2);
        let pull = z + 2.0 * z / ((1.0 + z) * (1.0 + z));
        self.stiffness
            - self.prestress * pull
            - self.elasticity * surface * surface
            - elastic * elastic
    }

    fn descent_slope(&self, z: f64) -> f64 {
        let z2 = z * z;
        let q = 3.0 + z + z2 * (3.0 + z);
        let weight = (1.0 + z2) * (1.0 + z).powi(3) / q;
        let surface = 4.0 * self.elasticity / (z2 * z2 * z);
        let elastic = 2.0 * z * (1.0 + 3.0 * z2);
        (surface - elastic) * weight - self.prestress
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curves() -> impl Iterator<Item = StagnationCurve> {
        let values = [0.0, 1e-3, 0.3, 5.0];
        values.into_iter().flat_map(move |elasticity| {
            [-40.0, -1.0, 0.0, 0.3, 7.0, 900.0].map(|prestress| StagnationCurve {
                stiffness: 1.7,
                cubic: 0.4,
                elasticity,
                prestress,
            })
        })
    }

    fn points() -> impl Iterator<Item = f64> {
        (1..=200).map(|i| f64::from(i) / 200.0)
    }

    #[test]
    fn descent_is_the_slope_of_the_curve() {
        for curve in curves() {
            for z in points() {
                let h = 1e-4 * z;
                let difference =
                    (curve.voltage_squared(z + h) - curve.voltage_squared(z - h)) / (2.0 * h);
                let slope = 4.0 * z * curve.descent(z) / (1.0 + z * z).powi(2);
                // Central difference: relative error h²/z² = 1e-8 times a few
                // of the largest term, and rounding 1e-16/1e-4 of it.
                let scale = 5.0 + curve.prestress.abs() + curve.elasticity / z.powi(3);
                assert!(
                    (difference - slope).abs() < 5e-7 * scale,
                    "{z} {difference} {slope}"
                );
            }
        }
    }

    #[test]
    fn descent_slope_has_the_sign_of_the_slope_and_decreases() {
        for curve in curves() {
            let mut before = f64::INFINITY;
            for z in points() {
                let h = 1e-4 * z;
                let pull_slope = (3.0 + z + 3.0 * z * z + z.powi(3)) / (1.0 + z).powi(3);
                let difference =
                    (curve.descent(z + h) - curve.descent(z - h)) / (2.0 * h * pull_slope);
                let slope = curve.descent_slope(z);
                let scale = 5.0 + curve.prestress.abs() + 40.0 * curve.elasticity / z.powi(5);
                assert!(
                    (difference - slope).abs() < 5e-7 * scale,
                    "{z} {difference} {slope}"
                );
                // Strict concavity in r, on which the search rests.
                assert!(slope < before);
                before = slope;
            }
        }
    }

    #[test]
    fn at_rest_the_curve_has_the_equilibrium_voltage() {
        // γ = 0.25, τ = 0.5, E = 0.75, S = 0.125, all exact in binary.
        let coefficients = Coefficients {
            inertia: 100.0,
            linear: 1.0 + 0.5 - 1.0 + 0.75,
            cubic: 2.0 - 3.0,
            quintic: 2.25,
        };
        let curve = StagnationCurve::new(&coefficients, 0.125);
        assert_eq!(curve.voltage_squared(1.0), 2.0 * (0.25 + 0.5) - 0.125);
    }
}
