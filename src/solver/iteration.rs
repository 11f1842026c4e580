//! When the iteration of a step's stages ends: one test for all kinds of steps.

/// Iterations after which one that still moves is given up.
pub const MOST_ITERATIONS: u32 = 40;

/// Changes of what f adds to a position by less than this part of it are rounding.
const ROUNDING: f64 = 0.5 * f64::EPSILON;

/// The iteration did not converge: the step is too long.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diverged;

/// How accurately stages are to be solved.
#[derive(Clone, Copy, Debug)]
pub struct IterationTolerance {
    /// The position may be this far from the solution.
    pub error: f64,
    /// An iteration that changes the position by less tells nothing.
    pub rounding: f64,
}

impl IterationTolerance {
    /// With rounding of numbers of this size.
    #[inline(always)]
    pub fn new(error: f64, size: f64) -> IterationTolerance {
        IterationTolerance {
            error,
            rounding: ROUNDING * size,
        }
    }

    /// Whether stages have converged that were iterated this often, the last time so that the position changed by
    /// `change`, after a `last_change`. The error left is the change times the rate of convergence, which is given
    /// as two numbers that have that ratio.
    ///
    /// # Errors
    /// [`Diverged`] where a further iteration is of no use.
    #[inline(always)]
    pub fn has_converged(
        &self,
        iterations: u32,
        change: f64,
        last_change: f64,
        [small, large]: [f64; 2],
    ) -> Result<bool, Diverged> {
        let is_met = change <= self.rounding
            || change * small <= self.error * (large - small)
            || change >= last_change && change <= 16.0 * self.rounding;
        if is_met {
            return Ok(true);
        }
        // Before the second iteration there may be no change. NaN fails each comparison.
        let converging = change < last_change || iterations == 2 && change.is_finite();
        if converging && iterations < MOST_ITERATIONS {
            Ok(false)
        } else {
            Err(Diverged)
        }
    }
}

/// The convergence of an iteration, of which each change is seen: steps with dense output and those of coupled
/// systems. Of the others some changes are not looked at.
#[derive(Clone, Copy, Debug)]
pub struct Convergence {
    tolerance: IterationTolerance,
    /// The second iteration is taken to shrink the change to this part of it at least.
    least_at_first: f64,
    iterations: u32,
    last_change: f64,
    /// By how much an iteration has shrunk the change of the one before, in the worst case. The first ratio
    /// counts where there is no other.
    pub contraction: f64,
}

impl Convergence {
    /// Before the first iteration.
    #[inline(always)]
    pub fn to(tolerance: IterationTolerance, least_at_first: f64) -> Convergence {
        Convergence {
            tolerance,
            least_at_first,
            iterations: 0,
            last_change: f64::NAN,
            contraction: 0.0,
        }
    }

    /// Whether a further iteration, which changed the position by `change`, came near enough. The first
    /// change may be NaN.
    ///
    /// # Errors
    /// [`Diverged`] where a further iteration is of no use.
    #[inline(always)]
    pub fn is_reached_by(&mut self, change: f64) -> Result<bool, Diverged> {
        self.iterations += 1;
        let last_change = std::mem::replace(&mut self.last_change, change);
        if self.iterations == 1 {
            return Ok(false);
        }
        let (ratio, second) = (change / last_change, self.iterations == 2);
        let worst = if ratio.is_nan() {
            1.0
        } else {
            self.contraction.max(ratio)
        };
        let least = if second { self.least_at_first } else { 0.0 };
        let rate = [worst.max(least), 1.0];
        let done = (self.tolerance).has_converged(self.iterations, change, last_change, rate)?;
        // A change that is nothing but rounding tells nothing of it.
        if second && done {
            let is_rounding = change <= self.tolerance.rounding;
            self.contraction = if is_rounding { 0.0 } else { worst };
        } else if !(second || done && ratio > 1.0) {
            self.contraction = self.contraction.max(ratio);
        }
        Ok(done)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contraction(changes: &[f64]) -> Result<f64, Diverged> {
        let mut convergence = Convergence::to(IterationTolerance::new(1e-16, 1.0), 0.1);
        for (left, change) in (0..changes.len()).rev().zip(changes) {
            assert_eq!(
                convergence.is_reached_by(*change)?,
                left == 0,
                "{changes:?}"
            );
        }
        Ok(convergence.contraction)
    }

    #[test]
    fn the_contraction_is_the_worst_ratio_that_is_not_rounding() {
        // The first ratio counts only where it is alone.
        assert_eq!(contraction(&[1e-10, 2e-16]), Ok(2e-6));
        assert_eq!(contraction(&[1.0, 0.5, 1e-16]), Ok(2e-16));
        // A change that was not seen, and changes that are rounding.
        assert_eq!(contraction(&[f64::NAN, 1e-17]), Ok(0.0));
        assert_eq!(contraction(&[f64::NAN, 1.0, 0.1, 1e-15, 1.2e-15]), Ok(0.1));
        assert_eq!(contraction(&[1.0, 0.5, 0.6]), Err(Diverged));
    }
}
