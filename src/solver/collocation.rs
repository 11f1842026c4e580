//! One substep of Gauss collocation with 2P nodes, order 4P at its end.
//!
//! Origin: J. C. Butcher, "Implicit Runge–Kutta processes", Math. Comp. 18
//! (1964) 50–64. The stages are solved by fixed-point (Picard) iteration, which
//! converges where the substep is not much longer than the motion's own time
//! scale; each sweep evaluates f in all nodes at once, in SIMD lanes.
//!
//! Accuracy: the end of a substep superconverges; between, the polynomial has
//! the error of interpolating f, estimated by the end of its Legendre series.
//! No arithmetic depends on the number of lanes, so that every SIMD level with
//! a fused multiply-add gives the same bits.

use std::ops::RangeInclusive;

use fearless_simd::Simd;

use super::lanes::Lanes;
use super::number::Number;
use super::tables::{Columns, Tables};
use super::{LocalEquation, State};

/// Sweeps after which an iteration that still moves is given up.
const MOST_SWEEPS: u32 = 40;

/// Corrections below this many ulps of the position are rounding.
pub const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// f over a substep: half² times its Legendre coefficients, where half is half
/// the length of the substep.
#[derive(Clone, Copy, Debug)]
pub struct Series<const P: usize> {
    /// Half the length of the substep.
    pub half: f64,
    /// half² · (a_0, a_2, …).
    pub even: [f64; P],
    /// half² · (a_1, a_3, …).
    pub odd: [f64; P],
}

/// A substep that has been solved.
#[derive(Clone, Copy, Debug)]
pub struct Substep<const P: usize> {
    /// The state at its end.
    pub end: State,
    /// f over it.
    pub series: Series<P>,
    /// Largest position at a node.
    pub highest: f64,
    /// Smallest position at a node.
    pub lowest: f64,
    /// By how much a sweep shrank the change of the one before.
    pub contraction: f64,
}

impl<const P: usize> Series<P> {
    /// The series of a constant f.
    #[must_use]
    pub fn constant(f: f64) -> Series<P> {
        let (mut even, odd) = ([0.0; P], [0.0; P]);
        even[0] = f;
        Series {
            half: 1.0,
            even,
            odd,
        }
    }
}

impl<const P: usize> Substep<P> {
    /// The size of the last two coefficients of f, in units of the position:
    /// what is neglected after them is smaller.
    #[must_use]
    pub fn tail(&self) -> f64 {
        self.series.even[P - 1].abs() + self.series.odd[P - 1].abs()
    }

    /// The range of positions at the nodes.
    #[must_use]
    pub fn nodes(&self) -> RangeInclusive<f64> {
        self.lowest..=self.highest
    }

    /// The range that holds the motion: between two nodes it may go a little
    /// beyond both.
    #[must_use]
    pub fn reach(&self) -> RangeInclusive<f64> {
        let beyond = 0.25 * (self.highest - self.lowest);
        self.lowest - beyond..=self.highest + beyond
    }
}

/// What a substep is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Task<'a, const P: usize> {
    /// The state at its begin.
    pub start: State,
    /// Its length.
    pub length: f64,
    /// The iteration ends where the position is this close to the solution of
    /// the stages.
    pub settled: f64,
    /// The substep before, whose f is continued for a first guess.
    pub before: Option<&'a Series<P>>,
    /// The contraction that is expected; 1 where nothing is known.
    pub contraction: f64,
}

/// The fixed-point iteration did not converge: the substep is too long.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diverged;

/// `Σ_j column[j] · value[j]`, in a fixed order.
#[inline(always)]
pub(super) fn product<S: Simd, V: Lanes<S, P>, const P: usize>(
    simd: S,
    columns: &Columns<P>,
    values: &[f64; P],
) -> V {
    // Two chains, so that one multiplication need not wait for the other.
    let mut even = V::load(simd, &columns[0]) * V::fill(simd, values[0]);
    let mut odd = V::load(simd, &columns[1]) * V::fill(simd, values[1]);
    for j in (2..P).step_by(2) {
        even = V::load(simd, &columns[j]).mul_add(V::fill(simd, values[j]), even);
        odd = V::load(simd, &columns[j + 1]).mul_add(V::fill(simd, values[j + 1]), odd);
    }
    even + odd
}

/// `Σ_j row[j] · value[j]`, in a fixed order.
#[inline(always)]
fn dot<const P: usize>(row: &[f64; P], values: &[f64; P]) -> f64 {
    let (mut even, mut odd) = (row[0] * values[0], row[1] * values[1]);
    for j in (2..P).step_by(2) {
        even += row[j] * values[j];
        odd += row[j + 1] * values[j + 1];
    }
    even + odd
}

/// Solves a substep.
///
/// # Errors
/// [`Diverged`] where the iteration does not converge or leaves the finite
/// numbers; a shorter substep will do.
#[inline(always)]
pub fn solve<S: Simd, V: Lanes<S, P>, L: LocalEquation, const P: usize>(
    simd: S,
    tables: &Tables<P>,
    equation: &L,
    task: &Task<P>,
) -> Result<Substep<P>, Diverged> {
    let &Task {
        start,
        length,
        settled,
        ..
    } = task;
    let half = 0.5 * length;
    let square = half * half;
    let node = V::load(simd, &tables.node);
    let splat = |value: f64| node.same(value);

    let load_right = equation.load(node.mul_add(splat(half), splat(half)));
    let load_left = equation.load(splat(half) - node * splat(half));
    let middle = start.position + half * start.rate;
    let drift = node * splat(half * start.rate);

    let mut f;
    match task.before {
        Some(before) => {
            let ratio = splat(half / before.half);
            let from = splat(1.0) + ratio;
            f = [
                continued(before, node.mul_add(ratio, from)),
                continued(before, from - node * ratio),
            ];
        }
        None => {
            let rate = splat(start.rate);
            f = [
                equation.acceleration(load_right, splat(middle) + drift, rate),
                equation.acceleration(load_left, splat(middle) - drift, rate),
            ];
        }
    }
    let mut old = [splat(f64::NAN); 2];
    let mut contraction = 0.0_f64;
    let mut last_change = f64::NAN;
    let mut sweeps = 0;
    loop {
        sweeps += 1;
        let sums = (f[0] + f[1]).store();
        let differences = (f[0] - f[1]).store();
        let mean = dot(&tables.mean, &sums);
        let tilt = dot(&tables.tilt, &differences);
        let once_odd: V = product(simd, &tables.once_from_sums, &sums);
        let once_even: V = product(simd, &tables.once_from_differences, &differences);
        let twice_even: V = product(simd, &tables.twice_from_sums, &sums);
        let twice_odd: V = product(simd, &tables.twice_from_differences, &differences);

        let rate = once_even.mul_add(splat(half), splat(start.rate + half * mean));
        let rate_odd = once_odd * splat(half);
        let position = twice_even.mul_add(splat(square), splat(middle - square * tilt));
        let position_odd = node
            .mul_add(splat(mean), twice_odd)
            .mul_add(splat(square), drift);
        let new = [position + position_odd, position - position_odd];
        let change = (new[0] - old[0])
            .abs()
            .max((new[1] - old[1]).abs())
            .largest();
        old = new;

        if sweeps > 1 {
            let rounding = ROUNDING * start.position.abs();
            let ratio = change / last_change;
            // The error left is the change times the rate of convergence.
            let expected = if sweeps == 2 {
                task.contraction
            } else {
                contraction.max(ratio)
            };
            let done = change <= rounding
                || change * expected <= settled * (1.0 - expected)
                || (sweeps > 4 && change >= last_change && change <= 16.0 * rounding);
            if sweeps == 2 && done {
                // A change that is nothing but rounding tells nothing of it.
                contraction = if change <= rounding { 0.0 } else { expected };
            } else if sweeps > 2 && !(done && ratio > 1.0) {
                contraction = contraction.max(ratio);
            }
            if done {
                let highest = new[0].max(new[1]).largest();
                let lowest = new[0].min(new[1]).smallest();
                let end = State {
                    position: start.position + (length * start.rate + 2.0 * square * (mean - tilt)),
                    rate: start.rate + length * mean,
                };
                if !(end.position.is_finite() && end.rate.is_finite() && lowest.is_finite()) {
                    return Err(Diverged);
                }
                let even: V = product(simd, &tables.series_from_sums, &sums);
                let odd: V = product(simd, &tables.series_from_differences, &differences);
                let series = Series {
                    half,
                    even: (even * splat(square)).store(),
                    odd: (odd * splat(square)).store(),
                };
                return Ok(Substep {
                    end,
                    series,
                    highest,
                    lowest,
                    contraction,
                });
            }
            // NaN fails each comparison and ends as divergence.
            let converging = change < last_change || sweeps == 2 && change.is_finite();
            if !converging || sweeps == MOST_SWEEPS {
                return Err(Diverged);
            }
            last_change = change;
        }
        f = [
            equation.acceleration(load_right, new[0], rate + rate_odd),
            equation.acceleration(load_left, new[1], rate - rate_odd),
        ];
    }
}

/// f of a substep continued to u.
#[inline(always)]
fn continued<N: Number, const P: usize>(series: &Series<P>, u: N) -> N {
    let size = 1.0 / (series.half * series.half);
    let coefficient = |degree: usize| {
        let half = if degree.is_multiple_of(2) {
            &series.even
        } else {
            &series.odd
        };
        u.same(half[degree / 2])
    };
    clenshaw::<N, P>(u, coefficient) * u.same(size)
}

/// A Legendre series of degree 2P − 1 at u, by Clenshaw's summation.
#[inline(always)]
pub(super) fn clenshaw<N: Number, const P: usize>(u: N, coefficient: impl Fn(usize) -> N) -> N {
    let number = |value: f64| u.same(value);
    let (mut next, mut after) = (number(0.0), number(0.0));
    for degree in (0..2 * P).rev() {
        let k = degree as f64;
        let rise = u * number((2.0 * k + 1.0) / (k + 1.0));
        let fall = number(-(k + 1.0) / (k + 2.0));
        let sum = rise.mul_add(next, after.mul_add(fall, coefficient(degree)));
        (next, after) = (sum, next);
    }
    next
}
