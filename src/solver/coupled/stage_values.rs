//! One state over the nodes of a step, in SIMD registers.

use fearless_simd::{Simd, f64x8};
use nalgebra::{Const, DimMin, SMatrix, SVector, ToTypenum};

use super::Slope;
use super::polynomials::{Coefficients, TERMS, sum};
use super::rule::{Columns, Rule};
use crate::solver::lanes::Lanes;
use crate::solver::number::Number;

/// A state that relaxes by less than this part in a step needs no linear system.
const SLOW_RELAXATION: f64 = 0.05;

/// Legendre coefficients by which the slopes of the step before are continued: those of high
/// degree grow too fast outside their step.
const CONTINUED: usize = 8;

/// Eight nodes a register.
const LANES: usize = 8;

/// Numbers at the nodes.
pub(super) type Row<S, const R: usize> = [f64x8<S>; R];

#[inline(always)]
pub(super) fn load<S: Simd, const R: usize, const N: usize>(
    simd: S,
    values: &[f64; N],
) -> Row<S, R> {
    std::array::from_fn(|r| {
        let mut part = [0.0; LANES];
        part.copy_from_slice(&values[LANES * r..LANES * (r + 1)]);
        f64x8::load(simd, &part)
    })
}

#[inline(always)]
pub(super) fn store<S: Simd, const R: usize, const N: usize>(row: &Row<S, R>) -> [f64; N] {
    let mut values = [0.0; N];
    for (part, register) in values.chunks_exact_mut(LANES).zip(row) {
        part.copy_from_slice(&register.store());
    }
    values
}

/// `Σ_j column[j] · value[j]`, in a fixed order.
#[inline(always)]
pub(super) fn product<S: Simd, const R: usize, const N: usize>(
    simd: S,
    columns: &Columns<N>,
    values: &[f64; N],
) -> Row<S, R> {
    let zero = f64x8::fill(simd, 0.0);
    let mut sums = [[zero; R]; 2];
    for j in 0..N {
        let column: Row<S, R> = load(simd, &columns[j]);
        let value = f64x8::fill(simd, values[j]);
        for r in 0..R {
            sums[j % 2][r] = Number::mul_add(column[r], value, sums[j % 2][r]);
        }
    }
    std::array::from_fn(|r| sums[0][r] + sums[1][r])
}

/// The slopes of a state that relaxes, see [`super::stages`].
#[inline(never)]
fn relaxed<const N: usize>(
    rule: &Rule<N>,
    half: f64,
    relaxation: &[f64; N],
    right: &[f64; N],
) -> Option<[f64; N]>
where
    Const<N>: ToTypenum + DimMin<Const<N>, Output = Const<N>>,
{
    let system = SMatrix::<f64, N, N>::from_fn(|i, j| {
        let unit = if i == j { 1.0 } else { 0.0 };
        unit + half * relaxation[i] * rule.once[j][i]
    });
    let solution = system.lu().solve(&SVector::from(*right))?;
    Some(solution.into())
}

/// One state over the step: its slopes at the nodes and what they add to it.
#[derive(Clone, Copy)]
pub(super) struct StageValues<S: Simd, const R: usize, const N: usize> {
    pub slopes: [f64; N],
    pub gain: Row<S, R>,
    relaxes: bool,
}

impl<S: Simd, const R: usize, const N: usize> StageValues<S, R, N>
where
    Const<N>: ToTypenum + DimMin<Const<N>, Output = Const<N>>,
{
    /// The state as it goes on from the step `before`, or with the slope that it has at the begin.
    #[inline(always)]
    pub fn guess(
        simd: S,
        rule: &Rule<N>,
        half: f64,
        first: Slope,
        before: Option<(f64, &Coefficients)>,
    ) -> Self {
        let relaxes = half * first.relaxation > SLOW_RELAXATION;
        let slopes = match before {
            // It stays where it is: a fast transient would lead far away.
            _ if relaxes => [0.0; N],
            Some((length, series)) => rule
                .place
                .map(|place| sum(&series[..CONTINUED], 1.0 + half / length * place)),
            None => [first.value; N],
        };
        let gain = product(simd, &rule.once, &slopes).map(|sum| sum * f64x8::fill(simd, half));
        StageValues {
            slopes,
            gain,
            relaxes,
        }
    }

    /// Takes new slopes, and returns by how much the state has changed.
    #[inline(always)]
    pub fn update(
        &mut self,
        simd: S,
        rule: &Rule<N>,
        half: f64,
        new: &[Slope<f64x8<S>>; R],
    ) -> Option<f64> {
        let value: Row<S, R> = std::array::from_fn(|r| new[r].value);
        self.slopes = if self.relaxes {
            let relaxation: Row<S, R> = std::array::from_fn(|r| new[r].relaxation);
            let right: Row<S, R> =
                std::array::from_fn(|r| Number::mul_add(relaxation[r], self.gain[r], value[r]));
            relaxed(rule, half, &store(&relaxation), &store(&right))?
        } else {
            store(&value)
        };
        let gain = product(simd, &rule.once, &self.slopes).map(|sum| sum * f64x8::fill(simd, half));
        let change = largest_change(&self.gain, &gain);
        self.gain = gain;
        Some(change)
    }

    /// The Legendre coefficients of the slopes.
    #[inline(always)]
    pub fn series(&self, simd: S, rule: &Rule<N>) -> Coefficients {
        series(simd, rule, &self.slopes)
    }
}

#[inline(always)]
pub(super) fn series<S: Simd, const N: usize>(
    _simd: S,
    rule: &Rule<N>,
    values: &[f64; N],
) -> Coefficients {
    let mut all = [0.0; TERMS];
    for (column, value) in rule.series.iter().zip(values) {
        for (term, share) in all.iter_mut().zip(column) {
            *term += share * value;
        }
    }
    all
}

#[inline(always)]
pub(super) fn largest_change<S: Simd, const R: usize>(old: &Row<S, R>, new: &Row<S, R>) -> f64 {
    let mut largest = 0.0_f64;
    for r in 0..R {
        let change = Lanes::abs(new[r] - old[r]).largest();
        // NaN is kept.
        largest = if change > largest || change.is_nan() {
            change
        } else {
            largest
        };
    }
    largest
}
