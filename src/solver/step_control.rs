//! How long the next substep may be.

/// Order with which the error inside a substep falls: the first neglected
/// Legendre coefficient of f (degree 16), twice integrated.
const ORDER: f64 = 18.0;

/// Part of the tolerance to which the stages of a substep are solved: unlike
/// the error between the nodes, what is left there adds up from substep to
/// substep (1e3-fold in 2000 units of time of a resonant motion).
const SETTLED: f64 = 1e-3;

/// More sweeps than this cost more than a shorter substep.
const MANY_SWEEPS: u32 = 18;

/// Chooses substeps so that the error in each stays below the tolerance.
#[derive(Clone, Copy, Debug)]
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

    /// How closely the stages of a substep have to be solved.
    #[must_use]
    pub fn settled(&self) -> f64 {
        SETTLED * self.tolerance
    }

    /// Judges a substep by its estimated error, relative to the position, and
    /// by the fixed-point sweeps it needed.
    #[must_use]
    pub fn judge(&self, error: f64, sweeps: u32) -> Verdict {
        let ratio = error / self.tolerance;
        // 0.9: the estimate is rough; below 1e-30 the error is nothing at all.
        let by_error = 0.9 * ratio.max(1e-30).powf(-1.0 / ORDER);
        if ratio > 1.0 {
            return Verdict::Reject(by_error.max(0.2));
        }
        let by_effort = if sweeps > MANY_SWEEPS { 0.8 } else { 2.0 };
        Verdict::Accept(by_error.min(by_effort))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_above_the_tolerance_is_rejected_and_shortens() {
        let control = StepControl::new(1e-9);
        assert!(matches!(control.judge(1e-3, 5), Verdict::Reject(f) if f < 0.6));
        assert!(matches!(control.judge(1e-12, 5), Verdict::Accept(f) if f > 1.0));
        assert!(matches!(control.judge(0.99e-9, 5), Verdict::Accept(f) if f < 1.0));
    }

    #[test]
    fn slow_convergence_shortens_an_accurate_substep() {
        let control = StepControl::new(1e-9);
        assert!(matches!(control.judge(0.0, MANY_SWEEPS + 1), Verdict::Accept(f) if f < 1.0));
    }
}
