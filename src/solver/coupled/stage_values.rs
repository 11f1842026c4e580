//! One state over the nodes of a step.

use fearless_simd::Simd;

use super::nodes::Nodes;
use super::polynomials::{LegendreCoefficients, TERMS};
use crate::arithmetic::legendre;
use crate::arithmetic::number::Number;
use crate::solver::tables::{Columns, Rule};

/// Legendre coefficients by which the slopes of the step before are continued: those of
/// high degree grow too fast outside their step.
const CONTINUED: usize = 8;

/// One state over the step: its slopes at the nodes and what they add to it.
#[derive(Clone, Copy)]
pub(super) struct StageValues<S: Simd, const R: usize, const N: usize> {
    pub slopes: [f64; N],
    pub gain: Nodes<S, R>,
}

impl<S: Simd, const R: usize, const N: usize> StageValues<S, R, N> {
    /// A state that stays where it is.
    #[inline(always)]
    pub fn constant(simd: S) -> Self {
        StageValues {
            slopes: [0.0; N],
            gain: Nodes::fill(simd, 0.0),
        }
    }

    /// The state as it goes on from a step of half the length `before`, whose slopes are given.
    #[inline(always)]
    pub fn continued(
        simd: S,
        rule: &Rule<N>,
        half: f64,
        before: f64,
        series: &LegendreCoefficients,
    ) -> Self {
        let fill = |value: f64| Nodes::fill(simd, value);
        let place: Nodes<S, R> = Nodes::load(simd, &rule.place);
        let u = place.mul_add(fill(half / before), fill(1.0));
        let slopes = legendre::sum(u, CONTINUED, |degree| fill(series[degree]));
        let mut values = StageValues::constant(simd);
        values.take(simd, rule, half, slopes);
        values
    }

    /// The state with this slope.
    #[inline(always)]
    pub fn going(simd: S, rule: &Rule<N>, half: f64, slope: f64) -> Self {
        let mut values = StageValues::constant(simd);
        values.take(simd, rule, half, Nodes::fill(simd, slope));
        values
    }

    /// The slopes, corrected by what they lack of `new` ones times the inverse of a matrix.
    #[inline(always)]
    pub fn corrected(&self, simd: S, inverse: &Columns<N>, new: Nodes<S, R>) -> Nodes<S, R> {
        let old = Nodes::load(simd, &self.slopes);
        old + Nodes::product(simd, inverse, &(new - old).store())
    }

    /// Takes new slopes, and returns by how much the state has changed.
    #[inline(always)]
    pub fn take(&mut self, simd: S, rule: &Rule<N>, half: f64, slopes: Nodes<S, R>) -> f64 {
        self.slopes = slopes.store();
        let gain = Nodes::product(simd, &rule.once, &self.slopes) * Nodes::fill(simd, half);
        let change = (gain - self.gain).largest();
        self.gain = gain;
        change
    }

    /// The Legendre coefficients of the slopes.
    #[inline(always)]
    pub fn series(&self, rule: &Rule<N>) -> LegendreCoefficients {
        series(rule, &self.slopes)
    }
}

/// The Legendre coefficients of numbers at the nodes.
#[inline(always)]
pub(super) fn series<const N: usize>(rule: &Rule<N>, values: &[f64; N]) -> LegendreCoefficients {
    let mut all = [0.0; TERMS];
    for (column, value) in rule.series.iter().zip(values) {
        for (term, share) in all.iter_mut().zip(column) {
            *term += share * value;
        }
    }
    all
}
