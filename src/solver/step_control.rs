//! How long the next substep may be.

use serde::{Deserialize, Serialize};

use super::collocation::{Closeness, ROUNDING};

/// Order with which the error inside a substep of 16 nodes falls: the first
/// neglected Legendre coefficient of f (degree 16), twice integrated.
const ORDER_INSIDE: f64 = 18.0;

/// Part of the tolerance that is left for the end of a substep, and to which its
/// stages are solved: unlike the error between the nodes, what is left there
/// adds up from substep to substep (1e3-fold in 2000 units of time of a
/// resonant motion).
const SETTLED: f64 = 2e-4;

/// The same at a tight tolerance, where a sweep more costs little.
const SETTLED_TIGHTLY: f64 = 5e-5;

/// Errors of this part of the position, one in each step, are not seen beside the
/// rounding of 1e6 steps.
pub const UNSEEN: f64 = 1e-19;

/// Part of the tolerance for what is repeated.
const REPEATED_SHARE: f64 = 0.001;

/// Contraction above which a shorter substep is cheaper: it grows with the
/// square of the length, and near 1 the iteration diverges.
pub(super) const SLOW: f64 = 0.35;

/// The same of a stride, whose first guess is good for short ones only.
const SLOW_STRIDE: f64 = 0.25;

/// Tolerance above which strides of 8 nodes are faster than those of 16. Measured
/// near resonance, at equal error: 25 % at 1e-6, nothing at 1e-10.
const LOOSE: f64 = 3e-10;

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

    /// Whether few nodes are enough.
    #[must_use]
    pub fn is_loose(&self) -> bool {
        self.tolerance > LOOSE
    }

    /// The same for what is repeated: an orbit is as long as the caller likes, and so
    /// is its error; the errors of ever new starts add up. Neither costs more than
    /// a sweep or two.
    #[must_use]
    pub fn repeated(&self) -> StepControl {
        StepControl::new(REPEATED_SHARE * self.tolerance)
    }

    /// How closely the stages of a substep have to be solved.
    #[must_use]
    pub fn settled(&self) -> f64 {
        let share = if self.is_loose() {
            SETTLED
        } else {
            SETTLED_TIGHTLY
        };
        share * self.tolerance
    }

    /// The same of a substep that is a `part` of the motion's time scale, relative to
    /// the position: the shorter, the more there are.
    #[must_use]
    pub fn settled_within(&self, part: f64) -> f64 {
        (self.settled() * part.min(1.0)).max(UNSEEN)
    }

    /// The same, for the iteration, from this position on. What a sweep leaves of f
    /// makes an error of the rate that is, in the time scale, 1/part times that of
    /// the position; and the rounding of f moves the position by as little as f.
    #[must_use]
    pub fn closeness(&self, position: f64, part: f64) -> Closeness {
        let short = part.min(1.0);
        Closeness {
            settled: self.settled_within(part) * position * short,
            rounding: ROUNDING * position * short * short,
        }
    }

    /// Judges a substep by its estimated error inside, relative to the position,
    /// and by the contraction of its fixed-point iteration.
    #[must_use]
    pub fn judge(&self, error: f64, contraction: f64) -> Verdict {
        verdict(error / self.tolerance, ORDER_INSIDE, SLOW / contraction)
    }

    /// The same of a stride of P node pairs by its estimated error at the end.
    #[must_use]
    pub fn judge_stride<const P: usize>(&self, error: f64, contraction: f64) -> Verdict {
        verdict(
            error / self.settled(),
            4.0 * P as f64,
            SLOW_STRIDE / contraction,
        )
    }
}

/// What follows from an error by `ratio` larger than allowed, of this `order`, and from how much
/// longer (squared) the step may be for the iteration's sake.
pub(super) fn verdict(ratio: f64, order: f64, effort: f64) -> Verdict {
    // Below 1e-30 the error is nothing at all.
    let by_error = CAUTION * power(ratio.max(1e-30), -1.0 / order);
    if ratio.is_nan() || ratio > 1.0 {
        return Verdict::Reject(by_error.max(0.2));
    }
    Verdict::Accept(by_error.min(effort.sqrt()).clamp(0.2, 3.0))
}

/// `x` to a small `exponent`, to a few thousandths: a logarithm that is linear
/// between powers of 2, since the real one takes as long as two sweeps.
pub(super) fn power(x: f64, exponent: f64) -> f64 {
    const ONE: f64 = 1.0_f64.to_bits() as f64;
    f64::from_bits((ONE + exponent * (x.to_bits() as f64 - ONE)) as u64)
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
