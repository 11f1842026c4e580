//! One state over the nodes of a step.

use fearless_simd::Simd;

use super::Slope;
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

    /// The state as it goes on from the step `before`, of which half the length and the slopes are given, or with
    /// its `first` slope. One that relaxes within the step is taken to stay where it is: a fast transient would lead
    /// far away.
    #[inline(always)]
    pub fn guess(
        simd: S,
        rule: &Rule<N>,
        half: f64,
        first: Slope,
        before: Option<(f64, &LegendreCoefficients)>,
    ) -> Self {
        let fill = |value: f64| Nodes::fill(simd, value);
        let mut values = StageValues::constant(simd);
        if half * first.relaxation <= 1.0 {
            let slopes = match before {
                Some((before, series)) => {
                    let place: Nodes<S, R> = Nodes::load(simd, &rule.place);
                    let u = place.mul_add(fill(half / before), fill(1.0));
                    legendre::sum(u, CONTINUED, |degree| fill(series[degree]))
                }
                None => fill(first.value),
            };
            values.take(simd, rule, half, slopes);
        }
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
