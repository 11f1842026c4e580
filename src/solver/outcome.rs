//! How an advance of a trajectory ends.

use super::limits::Limit;

/// How far an advance came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress<L = Limit> {
    /// As far as asked.
    Whole,
    /// To a limit, this long after the begin of the advance.
    Stopped {
        /// The limit.
        limit: L,
        /// The time from the begin of the advance to the limit.
        after: f64,
    },
}

/// Why an advance could not be finished. The trajectory stands where it came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// Substeps became too short to go on.
    SubstepTooShort {
        /// The length of the last substep tried.
        length: f64,
        /// The time from the begin of the advance.
        after: f64,
    },
    /// The advance needs more work than one call may take.
    TooManySubsteps {
        /// The number of substeps allowed, or of iterations where these are counted (coupled systems).
        most: u32,
        /// The time from the begin of the advance.
        after: f64,
    },
}
