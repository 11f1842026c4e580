//! First-order states and integrals over one step as polynomials.

use serde::{Deserialize, Serialize};

use super::{FullState, MOST_INTEGRALS, MOST_STATES};
use crate::arithmetic::legendre;

/// Legendre coefficients that are kept of a slope.
pub(super) const TERMS: usize = 16;

/// The Legendre coefficients of a slope over a step.
pub(super) type LegendreCoefficients = [f64; TERMS];

/// Everything but the motion, over one step, u = t/half − 1 ∈ [−1, 1].
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Polynomials {
    pub half: f64,
    pub start: FullState,
    pub end: FullState,
    /// z' of each state.
    pub slopes: [LegendreCoefficients; MOST_STATES],
    /// The derivative of each integral.
    pub powers: [LegendreCoefficients; MOST_INTEGRALS],
}

impl Polynomials {
    fn local(&self, offset: f64) -> f64 {
        (offset - self.half) / self.half
    }

    /// z at `offset` after the begin.
    pub fn internal(&self, offset: f64) -> [f64; MOST_STATES] {
        let u = self.local(offset);
        std::array::from_fn(|k| self.start.internal[k] + self.half * integrated(&self.slopes[k], u))
    }

    /// z' at `offset` after the begin.
    pub fn slopes(&self, offset: f64) -> [f64; MOST_STATES] {
        let u = self.local(offset);
        self.slopes
            .map(|series| legendre::sum(u, TERMS, |k| series[k]))
    }

    /// The integrals at `offset` after the begin.
    pub fn integrals(&self, offset: f64) -> [f64; MOST_INTEGRALS] {
        let u = self.local(offset);
        std::array::from_fn(|k| {
            self.start.integrals[k] + self.half * integrated(&self.powers[k], u)
        })
    }
}

/// Σ a_k ∫P_k from −1 to u, with ∫P_k = (P_{k+1} − P_{k−1})/(2k+1).
fn integrated(coefficients: &LegendreCoefficients, u: f64) -> f64 {
    if coefficients.iter().all(|a| *a == 0.0) {
        return 0.0;
    }
    let a = |k: usize| coefficients.get(k).copied().unwrap_or(0.0);
    let mut series = [0.0; TERMS + 1];
    series[0] = a(0) - a(1) / 3.0;
    for (k, term) in series.iter_mut().enumerate().skip(1) {
        *term = a(k - 1) / (2 * k - 1) as f64 - a(k + 1) / (2 * k + 3) as f64;
    }
    legendre::sum(u, series.len(), |k| series[k])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3 + 5u + P_4 from −1, by hand.
    #[test]
    fn a_series_is_integrated() {
        let mut a = [0.0; TERMS];
        (a[0], a[1], a[4]) = (3.0, 5.0, 1.0);
        let integral = |u: f64| (7.0 * u.powi(5) - 10.0 * u.powi(3) + 3.0 * u) / 8.0;
        for u in [-1.0, -0.3, 0.0, 0.8, 1.0] {
            let by_hand = 3.0 * (u + 1.0) + 2.5 * (u * u - 1.0) + integral(u) - integral(-1.0);
            assert!((integrated(&a, u) - by_hand).abs() < 1e-14);
        }
    }
}
