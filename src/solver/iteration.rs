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

    /// Whether an iteration that changed the position by `change`, after one by `last_change`,
    /// came near enough. The error left is the change times the rate of convergence, which is given
    /// as two numbers that have that ratio.
    #[inline(always)]
    pub fn is_met(&self, change: f64, last_change: f64, rate: [f64; 2]) -> bool {
        let [small, large] = rate;
        change <= self.rounding
            || change * small <= self.error * (large - small)
            || change >= last_change && change <= 16.0 * self.rounding
    }

    /// Whether stages have converged that were iterated this often; for the rest see
    /// [`IterationTolerance::is_met`].
    ///
    /// # Errors
    /// [`Diverged`] where a further iteration is of no use.
    #[inline(always)]
    pub fn has_converged(
        &self,
        iterations: u32,
        change: f64,
        last_change: f64,
        rate: [f64; 2],
    ) -> Result<bool, Diverged> {
        if self.is_met(change, last_change, rate) {
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
