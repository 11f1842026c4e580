//! How long the next substep may be.

use serde::{Deserialize, Serialize};

use super::iteration::IterationTolerance;

/// Order with which the error inside a substep of 16 nodes falls: the first
/// neglected Legendre coefficient of f (degree 16), twice integrated.
const ORDER_INSIDE: f64 = 18.0;

/// Order with which the error at its end falls.
const ORDER_AT_END: f64 = 32.0;

/// Part of the tolerance that is left for the end of a substep, and to which its
/// stages are solved: unlike the error between the nodes, what is left there
/// adds up from substep to substep (1e3-fold in 2000 units of time of a
/// resonant motion).
const LEFT_AT_END: f64 = 2e-4;

/// This part at a tight tolerance, where an iteration more costs little.
const LEFT_AT_END_TIGHTLY: f64 = 5e-5;

/// Errors of this part of the position, one in each step, are not seen beside the
/// rounding of 1e6 steps.
pub const UNSEEN: f64 = 1e-19;

/// Part of the tolerance for what is repeated.
const REPEATED_SHARE: f64 = 0.001;

/// Contraction above which a shorter substep is cheaper: it grows with the
/// square of the length, and near 1 the iteration diverges.
pub(super) const SLOW: f64 = 0.35;

/// The contraction that is slow in a step of 16 nodes of which only the end is asked for, whose first guess is
/// good for short ones only.
const SLOW_AT_END: f64 = 0.25;

/// Tolerance above which steps of 8 nodes are faster than those of 16 where the equation changes after a
/// few of them. Measured near resonance, at equal error: 25 % at 1e-6, nothing at 1e-10.
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

/// A step shorter than this part of what it was to be cannot go on.
pub const SHORTEST: f64 = 1e-12;

/// Nor can one whose square has lost digits, since it is next to the smallest number.
const LEAST: f64 = 1e-150;

/// By what a step is shortened that says nothing about how long it may be.
pub const HALVED: f64 = 0.5;

/// A step longer than the one before by more than this factor does not take its first guess from there.
const MOST_LONGER: f64 = 4.0;

/// Whether a step of this length may go on from the f of the step before, half of whose length is given.
/// One that was cut short says nothing about much longer ones: rounding leaves some of 1e-17.
pub fn goes_on_from(half: f64, length: f64) -> bool {
    length <= 2.0 * MOST_LONGER * half
}

/// By how much a step may be longer than the one before, where that had not grown itself. Where it grows as far as
/// the last one allows, every second attempt is refused at a tolerance of 1e-6, every seventh at 1e-12.
const MOST_GROWTH: f64 = 1.05;

/// By which factor the step after one of this `length` may be longer, at most: not at all where this one was to be
/// `longest` and had to be shortened, as far as it can where none was `before`. The longer this one is than the one
/// before, whose length is given, the longer the next one may be; by the power `acceleration` of their ratio.
#[inline(always)]
pub fn most_growth(length: f64, longest: f64, before: Option<f64>, acceleration: i32) -> f64 {
    match before {
        _ if length < longest => 1.0,
        Some(before) => MOST_GROWTH * (length / before).max(1.0).powi(acceleration),
        None => f64::INFINITY,
    }
}

/// Attempts a step of the `longest` length and shorter ones, until one is accepted. An attempt returns by which factor
/// to shorten a step that is refused. It may take a shorter step than it is asked for.
///
/// # Errors
/// The length that is no longer than `shortest` or 1e-150, or NaN.
#[inline(always)]
pub fn first_accepted<T>(
    longest: f64,
    shortest: f64,
    mut attempt: impl FnMut(&mut f64) -> Result<T, f64>,
) -> Result<T, f64> {
    let mut length = longest;
    loop {
        if length.is_nan() || length <= shortest.max(LEAST) {
            return Err(length);
        }
        match attempt(&mut length) {
            Ok(step) => return Ok(step),
            Err(factor) => length *= factor,
        }
    }
}

impl StepControl {
    /// For a relative `tolerance` of the result.
    pub fn new(tolerance: f64) -> StepControl {
        StepControl { tolerance }
    }

    /// Whether the tolerance is one.
    pub fn is_valid(&self) -> bool {
        self.tolerance > 0.0 && self.tolerance < 1.0
    }

    /// Whether few nodes are enough.
    pub fn is_loose(&self) -> bool {
        self.tolerance > LOOSE
    }

    /// The control of what is repeated: an orbit is as long as the caller likes, and so is its
    /// error; the errors of ever new starts add up. Neither costs more than an iteration or two.
    pub fn repeated(&self) -> StepControl {
        StepControl::new(REPEATED_SHARE * self.tolerance)
    }

    /// The error that may be left at the end of a step, relative to the position.
    pub fn end_tolerance(&self) -> f64 {
        let share = if self.is_loose() {
            LEFT_AT_END
        } else {
            LEFT_AT_END_TIGHTLY
        };
        share * self.tolerance
    }

    /// The error that may be left at the end of a step that is a `part` of the motion's time scale,
    /// relative to the position: the shorter steps are, the more there are.
    pub fn end_tolerance_within(&self, part: f64) -> f64 {
        (self.end_tolerance() * part.min(1.0)).max(UNSEEN)
    }

    /// How accurately the stages of such a step from this position are solved. What an iteration leaves of f
    /// makes an error of the rate that is, in the time scale, 1/part times that of
    /// the position; and the rounding of f moves the position by as little as f.
    pub fn iteration_tolerance(&self, position: f64, part: f64) -> IterationTolerance {
        let short = part.min(1.0);
        let error = self.end_tolerance_within(part) * position * short;
        IterationTolerance::new(error, position * short * short)
    }

    /// Judges a step of 16 nodes of which only the end is asked for by its estimated error there,
    /// relative to the position, as [`StepControl::judge`] does.
    ///
    /// # Errors
    /// By which factor to shorten it.
    pub fn judge_end(&self, error: f64, contraction: f64) -> Result<f64, f64> {
        judge(
            error / self.end_tolerance(),
            ORDER_AT_END,
            SLOW_AT_END / contraction,
        )
    }

    /// Judges a step with dense output by its estimated error inside, relative to the position, and
    /// by the contraction of its iteration: by which factor the next one may be longer.
    ///
    /// # Errors
    /// By which factor to shorten it.
    pub fn judge(&self, error: f64, contraction: f64) -> Result<f64, f64> {
        judge(error / self.tolerance, ORDER_INSIDE, SLOW / contraction)
    }
}

/// What follows from an error by `ratio` larger than allowed, of this `order`, and from how much
/// longer (squared) the step may be for the iteration's sake: by which factor the next one may be
/// longer.
///
/// # Errors
/// By which factor to shorten it.
pub fn judge(ratio: f64, order: f64, effort: f64) -> Result<f64, f64> {
    accept(ratio, order)?;
    Ok(factor(ratio, order).min(effort.sqrt()).clamp(0.2, 3.0))
}

/// Accepts a step whose error, of this `order`, is by `ratio` larger than allowed, if that is no more
/// than 1.
///
/// # Errors
/// By which factor to shorten it.
#[inline(always)]
pub fn accept(ratio: f64, order: f64) -> Result<(), f64> {
    if ratio <= 1.0 {
        Ok(())
    } else if ratio.is_nan() {
        Err(HALVED)
    } else {
        Err(factor(ratio, order).max(0.2))
    }
}

/// By which factor a step may be longer whose error, of this `order`, is by `ratio` larger than
/// allowed.
#[inline(always)]
pub fn factor(ratio: f64, order: f64) -> f64 {
    // Below 1e-30 the error is nothing at all.
    CAUTION * power(ratio.max(1e-30), -1.0 / order)
}

/// `x` to a small `exponent`, to a few thousandths: a logarithm that is linear
/// between powers of 2, since the real one takes as long as two iterations.
fn power(x: f64, exponent: f64) -> f64 {
    const ONE: f64 = 1.0_f64.to_bits() as f64;
    f64::from_bits((ONE + exponent * (x.to_bits() as f64 - ONE)) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_above_the_tolerance_is_rejected_and_slow_convergence_shortens() {
        let control = StepControl::new(1e-9);
        assert!(matches!(control.judge(1e-3, 0.1), Err(f) if f < 0.6));
        assert!(matches!(control.judge(1e-12, 0.01), Ok(f) if f > 1.0));
        assert!(matches!(control.judge(0.99e-9, 0.01), Ok(f) if f < 1.0));
        assert!(matches!(control.judge(0.0, 0.7), Ok(f) if f < 1.0));
    }

    #[test]
    fn steps_grow_faster_the_longer_they_have_grown() {
        let after = |before: f64, acceleration| most_growth(1.0, 1.0, Some(before), acceleration);
        assert_eq!(after(1.0, 1), MOST_GROWTH);
        assert_eq!(after(2.0, 1), MOST_GROWTH);
        assert_eq!(after(0.8, 1), MOST_GROWTH * 1.25);
        assert_eq!(after(0.8, 2), MOST_GROWTH * 1.5625);
        assert_eq!(most_growth(1.0, 1.0, None, 1), f64::INFINITY);
        assert_eq!(most_growth(1.0, 1.5, None, 1), 1.0);
    }

    #[test]
    fn a_step_is_shortened_until_it_is_accepted_or_too_short() {
        let up_to = |most: f64| {
            first_accepted(1.6, 0.1, |length| {
                *length = length.min(1.5);
                if *length > most {
                    Err(HALVED)
                } else {
                    Ok(*length)
                }
            })
        };
        assert_eq!(up_to(1.5), Ok(1.5));
        assert_eq!(up_to(0.4), Ok(0.375));
        assert_eq!(up_to(0.09), Err(0.09375));
    }
}
