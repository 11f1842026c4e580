//! One substep of Gauss collocation with 16 nodes, order 32 at its end.
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

use fearless_simd::{Level, Simd, SimdBase, SimdFloat, SimdFrom, dispatch, f64x8};

use super::segment::Segment;
use super::tables::{Columns, GAUSS_16, PAIRS};
use super::{LocalEquation, State};

/// Sweeps after which an iteration that still moves is given up.
const MOST_SWEEPS: u32 = 40;

/// Corrections below this many ulps of the position are rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// What is to be known of a substep that has been solved.
#[derive(Clone, Copy, Debug)]
pub struct Substep {
    /// Estimated largest error of the position inside the substep.
    pub error: f64,
    /// Largest position at a node.
    pub highest: f64,
    /// Smallest position at a node.
    pub lowest: f64,
    /// Fixed-point sweeps that were needed.
    pub sweeps: u32,
    /// By how much the slowest sweep shrank the change of the one before.
    pub contraction: f64,
}

impl Substep {
    /// The range of positions at the nodes.
    #[must_use]
    pub fn nodes(&self) -> RangeInclusive<f64> {
        self.lowest..=self.highest
    }
}

/// The fixed-point iteration did not converge: the substep is too long.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diverged;

/// Solves a substep of the given `length` from `start`, iterating until the
/// position is within `settled` of the solution of the stages, and leaves the
/// motion in `segment`.
///
/// # Errors
/// [`Diverged`] where the iteration does not converge or leaves the finite
/// numbers; a shorter substep will do.
pub fn solve<L: LocalEquation>(
    level: Level,
    equation: &L,
    start: State,
    length: f64,
    settled: f64,
    segment: &mut Segment,
) -> Result<Substep, Diverged> {
    dispatch!(level, simd => sweep(simd, equation, start, length, settled, segment))
}

/// `Σ_j column[j] · value[j]`, in a fixed order.
#[inline(always)]
fn product<S: Simd>(simd: S, columns: &Columns, values: &[f64; PAIRS]) -> f64x8<S> {
    let column = |j: usize| f64x8::simd_from(simd, columns[j]);
    let value = |j: usize| f64x8::splat(simd, values[j]);
    // Two chains, so that one multiplication need not wait for the other.
    let mut even = column(0) * value(0);
    let mut odd = column(1) * value(1);
    for j in (2..PAIRS).step_by(2) {
        even = column(j).mul_add(value(j), even);
        odd = column(j + 1).mul_add(value(j + 1), odd);
    }
    even + odd
}

/// `Σ_j row[j] · value[j]`, in a fixed order.
fn dot(row: &[f64; PAIRS], values: &[f64; PAIRS]) -> f64 {
    let p = |j: usize| row[j] * values[j];
    ((p(0) + p(4)) + (p(2) + p(6))) + ((p(1) + p(5)) + (p(3) + p(7)))
}

#[inline(always)]
fn sweep<S: Simd, L: LocalEquation>(
    simd: S,
    equation: &L,
    start: State,
    length: f64,
    settled: f64,
    segment: &mut Segment,
) -> Result<Substep, Diverged> {
    let tables = &GAUSS_16;
    let half = 0.5 * length;
    let square = half * half;
    let node = f64x8::simd_from(simd, tables.node);
    let splat = |value: f64| f64x8::splat(simd, value);

    let load_right = equation.load(splat(half) + node * splat(half));
    let load_left = equation.load(splat(half) - node * splat(half));
    let load_start = equation.load(0.0);
    let at_start = equation.acceleration(load_start, start.position, start.rate);

    let middle = start.position + half * start.rate;
    let drift = node * splat(half * start.rate);
    let one = splat(1.0);
    let mut right = first_guess(start, half, at_start, one + node);
    let mut left = first_guess(start, half, at_start, one - node);
    let (mut sums, mut differences);
    let (mut mean, mut tilt);

    let mut sweeps = 0;
    let mut last_change = f64::INFINITY;
    let mut contraction = 0.0_f64;
    loop {
        sweeps += 1;
        let f_right = equation.acceleration(load_right, right.0, right.1);
        let f_left = equation.acceleration(load_left, left.0, left.1);
        sums = array(f_right + f_left);
        differences = array(f_right - f_left);

        mean = dot(&tables.mean, &sums);
        tilt = dot(&tables.tilt, &differences);
        let once_odd = product(simd, &tables.once_from_sums, &sums);
        let once_even = product(simd, &tables.once_from_differences, &differences);
        let twice_even = product(simd, &tables.twice_from_sums, &sums);
        let twice_odd = product(simd, &tables.twice_from_differences, &differences);

        let rate = once_even.mul_add(splat(half), splat(start.rate + half * mean));
        let rate_odd = once_odd * splat(half);
        let position = twice_even.mul_add(splat(square), splat(middle - square * tilt));
        let position_odd = (twice_odd + node * splat(mean)).mul_add(splat(square), drift);
        let new_right = position + position_odd;
        let new_left = position - position_odd;
        let change = (new_right - right.0)
            .abs()
            .max((new_left - left.0).abs())
            .reduce_max();
        right = (new_right, rate + rate_odd);
        left = (new_left, rate - rate_odd);

        let rounding = ROUNDING * start.position.abs();
        // NaN fails each comparison and ends as divergence.
        if change <= rounding {
            break;
        }
        if sweeps > 1 && change < last_change {
            // The error left is the change times the rate of convergence.
            let ratio = change / last_change;
            contraction = contraction.max(ratio);
            if change * ratio <= settled * (1.0 - ratio) {
                break;
            }
        } else if sweeps > 3 && change <= 16.0 * rounding {
            break;
        } else if sweeps > 2 || change.is_nan() {
            return Err(Diverged);
        }
        if sweeps == MOST_SWEEPS {
            return Err(Diverged);
        }
        last_change = change;
    }

    let highest = right.0.max(left.0).reduce_max();
    let lowest = right.0.min(left.0).reduce_min();
    let end = State {
        position: start.position + (length * start.rate + 2.0 * square * (mean - tilt)),
        rate: start.rate + length * mean,
    };
    if !(end.position.is_finite() && end.rate.is_finite() && lowest.is_finite()) {
        return Err(Diverged);
    }

    let even = product(simd, &tables.series_from_sums, &sums) * splat(square);
    let odd = product(simd, &tables.series_from_differences, &differences) * splat(square);
    segment.assign(half, start, end, array(even), array(odd));
    Ok(Substep {
        error: segment.tail() / NEGLECTED,
        highest,
        lowest,
        sweeps,
        contraction,
    })
}

/// Position and rate under a constant acceleration, `since` counted in halves
/// of the substep. A function, since closures would not be inlined here and
/// then not be compiled for the lanes' instructions.
#[inline(always)]
fn first_guess<S: Simd>(
    start: State,
    half: f64,
    acceleration: f64,
    since: f64x8<S>,
) -> (f64x8<S>, f64x8<S>) {
    let splat = |value: f64| f64x8::splat(since.simd, value);
    let gain = since * splat(half * acceleration);
    let rate = gain + splat(start.rate);
    let mean_rate = gain.mul_add(splat(0.5), splat(start.rate));
    let position = (since * splat(half)).mul_add(mean_rate, splat(start.position));
    (position, rate)
}

/// Between the nodes the position misses less than this part of the last two
/// Legendre coefficients: f is integrated twice, which divides degree 16 by
/// some 16², and its series goes on falling. Measured on DC and AC motions with
/// substeps of 6 to 14: 5 to 18 times less, which leaves room for the rate,
/// whose error is larger by the inverse of the motion's time scale.
const NEGLECTED: f64 = 1000.0;

#[inline(always)]
fn array<S: Simd>(lanes: f64x8<S>) -> [f64; PAIRS] {
    let mut values = [0.0; PAIRS];
    lanes.store_slice(&mut values);
    values
}
