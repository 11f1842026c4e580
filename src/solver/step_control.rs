//! How long the next substep may be.

use serde::{Deserialize, Serialize};

/// Order with which the error inside a substep falls: the first neglected
/// Legendre coefficient of f (degree 16), twice integrated.
const ORDER: f64 = 18.0;

/// Part of the tolerance to which the stages of a substep are solved: unlike
/// the error between the nodes, what is left there adds up from substep to
/// substep (1e3-fold in 2000 units of time of a resonant motion).
const SETTLED: f64 = 2e-4;

/// Contraction above which a shorter substep is cheaper: it grows with the
/// square of the length, and near 1 the iteration diverges.
const SLOW: f64 = 0.35;

/// What the next substep aims at, so that few are rejected: an error of
/// 0.85¹⁸, a twentieth of the tolerance.
const CAUTION: f64 = 0.85;

/// Chooses substeps so that the error in each stays below the tolerance.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct StepControl {
    /// Error of the position that a substep may make, relative to the position.
    pub tolerance: f64,
}

/// What to do with a substep that has been solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// Keep it; the next one may be longer or shorter by this factor.
    Accept(f64),
    /// Solve it again, shorter by this factor.
    Reject(f64),
}

impl StepControl {
    /// For a relative `tolerance` of the result.
    #[must_use]
    pub fn new(tolerance: f64) -> StepControl {
        StepControl { tolerance }
    }

    /// Whether the tolerance is one.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.tolerance > 0.0 && self.tolerance < 1.0
    }

    /// How closely the stages of a substep have to be solved.
    #[must_use]
    pub fn settled(&self) -> f64 {
        SETTLED * self.tolerance
    }

    /// Judges a substep by its estimated error, relative to the position, and
    /// by the contraction of its fixed-point iteration.
    #[must_use]
    pub fn judge(&self, error: f64, contraction: f64) -> Verdict {
        let ratio = error / self.tolerance;
        // Below 1e-30 the error is nothing at all.
        let by_error = CAUTION * ratio.max(1e-30).powf(-1.0 / ORDER);
        if ratio > 1.0 {
            return Verdict::Reject(by_error.max(0.2));
        }
        let by_effort = (SLOW / contraction).sqrt();
        Verdict::Accept(by_error.min(by_effort).clamp(0.2, 3.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_above_the_tolerance_is_rejected_and_shortens() {
        let control = StepControl::new(1e-9);
        assert!(matches!(control.judge(1e-3, 0.1), Verdict::Reject(f) if f < 0.6));
        assert!(matches!(control.judge(1e-12, 0.01), Verdict::Accept(f) if f > 1.0));
        assert!(matches!(control.judge(0.99e-9, 0.01), Verdict::Accept(f) if f < 1.0));
    }

    #[test]
    fn slow_convergence_shortens_an_accurate_substep() {
        let control = StepControl::new(1e-9);
        assert!(matches!(control.judge(0.0, 0.7), Verdict::Accept(f) if f < 1.0));
    }
}
