//! Pull-in thresholds under a constant voltage and a constant prestress.
//!
//! With the surface effects folded into `a1`, `a3`, `a5` (see
//! [`Coefficients`]), both thresholds are the top of a curve of squared voltage
//! over stretch:
//!
//! | threshold | curve | meaning of a point on it |
//! |---|---|---|
//! | [`dynamic`] | stagnation curve Φ, Eq. 19 | φ² that turns the orbit from rest at λ = 1 at that stretch |
//! | [`quasi_static`] | equilibrium curve Ψ, Eq. 16 at rest | φ² that holds the actuator at that stretch |
//!
//! Where a curve falls, a slightly larger voltage neither turns nor holds the
//! actuator nearby, so the first maximum is the threshold. The two curves meet
//! where Φ is stationary (Eq. 20), hence the dynamic threshold never lies above
//! the quasi-static one.
//!
//! All quantities are nondimensional; the inertia `c` has no influence. That
//! each curve has at most one maximum is proved for E ≥ 0, that no threshold
//! has φ² < 0 for γ, τ, E ≥ 0; the prestress may have either sign. A call takes
//! about a microsecond, allocates nothing, and gives a finite answer or `None`
//! for all coefficients and prestresses up to 1e6 in size.

pub mod device;
mod dynamic;
mod fold;
mod quasi_static;

pub use dynamic::dynamic;
pub use quasi_static::quasi_static;

use crate::actuator::Coefficients;
use fold::VoltageCurve;

/// A voltage at which pull-in sets in, and the thickness stretch there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Threshold {
    /// Nondimensional voltage φ ≥ 0; accurate to a few units in the last place
    /// of φ² wherever the terms of the curve do not cancel.
    pub voltage: f64,
    /// Thickness stretch λ3 = 1/λ² > 0. As the place of a maximum it loses
    /// digits like a square root where the fold is about to vanish.
    pub thickness_stretch: f64,
}

impl Threshold {
    /// The threshold at the point `z` = 1/λ of a curve.
    ///
    /// For γ, τ, E ≥ 0 no reported threshold has φ² < 0: without voltage the
    /// force law is monotone for λ ≥ 1, so prestress alone pulls nothing in.
    /// The clamp keeps the voltage real against rounding and for other
    /// coefficients, where 0 means that every voltage exceeds the threshold.
    fn at(curve: &impl VoltageCurve, z: f64) -> Self {
        Self {
            voltage: curve.voltage_squared(z).max(0.0).sqrt(),
            thickness_stretch: z * z,
        }
    }
}

/// Voltage above which nothing bounds the stretch of the motion from rest at
/// λ = 1: without surface elasticity it then reaches infinity in finite time.
///
/// It is √max(Φ): the larger of the dynamic threshold and √(4τ), the level to
/// which the stagnation curve tends for λ → ∞. Between the dynamic threshold
/// and a larger √(4τ) the actuator pulls in, but onto a larger orbit. `None`
/// with surface elasticity (`a5` > 0), whose λ⁵ force bounds every motion.
#[must_use]
pub fn escape_voltage(coefficients: &Coefficients, prestress: f64) -> Option<f64> {
    if coefficients.quintic > 0.0 {
        return None;
    }
    let level_at_infinity = coefficients.cubic.max(0.0).sqrt();
    let fold = dynamic(coefficients, prestress).map_or(0.0, |threshold| threshold.voltage);
    Some(level_at_infinity.max(fold))
}
