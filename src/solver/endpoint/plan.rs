//! The stages of equal steps of 8 nodes, one after another.
//!
//! A plan holds what depends on the length of a step alone, so that a step multiplies by
//! matrices that are there already. Its iteration is a simplified Newton method at the price
//! of fixed-point iteration: with g = f − J·(x − x_0) for a fixed slope J ≈ ∂f/∂x, the stages
//! solve x = x_0 + W·(t·x'_0) + half²·W·A·g, where W = (1 − half²·J·A)⁻¹ and A integrates
//! twice. Whatever J is, the solution is that of Gauss collocation; a good one makes f − J·x
//! nearly constant in x, and the iteration contract several times faster.
//!
//! Source: E. Hairer, G. Wanner, "Solving Ordinary Differential Equations II", 2nd ed.,
//! section IV.8.

use std::f64::consts::FRAC_PI_2;

use fearless_simd::{Level, Simd, SimdBase, dispatch, f64x4};

use super::continuation::{Bell, resampled};
use super::matrix::with_slope;
use super::table::{Diagonals, Matrices, TABLE};
use crate::arithmetic::lanes::{Lanes, rolled_if_narrow};
use crate::arithmetic::number::Number;
use crate::arithmetic::sine::{sine_of_sum, turned};

/// Nodes of a step.
pub const NODES: usize = 8;

/// A number at each node, in two registers.
pub type Pair<S> = [f64x4<S>; 2];

/// What equal steps have in common. Numbers at the nodes are in the order of the table. No register of
/// them lies across two lines of the cache.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Plan {
    /// Half their length.
    pub half: f64,
    /// J.
    pub slope: f64,
    /// half²·J, and the matrices of steps with this product whose half is 1.
    product: f64,
    unscaled: Matrices,
    /// Those of these steps.
    matrices: Matrices,
    /// What continues g to the next step.
    bell: Bell,
    /// The angular frequency with which the load alternates.
    frequency: f64,
    /// The time of the nodes since the begin of the step.
    offset: [f64; NODES],
    /// Sine and cosine of the angle by which the load turns until then, and until the end.
    turn: [[f64; NODES]; 2],
    turn_end: [f64; 2],
}

#[inline(always)]
pub fn load<S: Simd>(simd: S, values: &[f64]) -> f64x4<S> {
    f64x4::from_slice(simd, values)
}

/// Numbers at the nodes.
#[inline(always)]
pub fn pair<S: Simd>(simd: S, values: &[f64; NODES]) -> Pair<S> {
    [load(simd, &values[..4]), load(simd, &values[4..])]
}

/// The numbers at the nodes one by one.
#[inline(always)]
pub fn unpair<S: Simd>(values: Pair<S>) -> [f64; NODES] {
    let mut all = [0.0; NODES];
    values[0].store_slice(&mut all[..4]);
    values[1].store_slice(&mut all[4..]);
    all
}

/// Lane i takes the value of lane i ^ 1, i ^ 2, i ^ 3.
#[inline(always)]
fn permuted<S: Simd>(values: f64x4<S>) -> [f64x4<S>; 4] {
    let crossed = values.slide::<2>(values);
    [
        values,
        values.slide_within_blocks::<1>(values),
        crossed,
        crossed.slide_within_blocks::<1>(crossed),
    ]
}

#[inline(always)]
pub fn both_permuted<S: Simd>([low, high]: Pair<S>) -> [[f64x4<S>; 4]; 2] {
    [permuted(low), permuted(high)]
}

/// `first + matrix · values`, the values permuted.
#[inline(always)]
pub fn multiply<S: Simd>(
    simd: S,
    matrix: &Diagonals,
    values: &[[f64x4<S>; 4]; 2],
    first: Pair<S>,
) -> Pair<S> {
    let mut sums = first;
    for register in 0..2 {
        let own = &values[register];
        let other = &values[1 - register];
        let at = matrix.as_slice();
        // Four chains, so that no more than one operation waits for another.
        let a = load(simd, &at[0][register]).mul_add(own[0], first[register]);
        let a = load(simd, &at[2][register]).mul_add(own[2], a);
        let b = load(simd, &at[4][register]) * other[0];
        let b = load(simd, &at[6][register]).mul_add(other[2], b);
        let c = load(simd, &at[1][register]) * own[1];
        let c = load(simd, &at[3][register]).mul_add(own[3], c);
        let d = load(simd, &at[5][register]) * other[1];
        let d = load(simd, &at[7][register]).mul_add(other[3], d);
        sums[register] = (a + b) + (c + d);
    }
    sums
}

impl Default for Plan {
    fn default() -> Plan {
        Plan::NONE
    }
}

impl Plan {
    /// No plan: none of this length is asked for.
    pub const NONE: Plan = Plan {
        half: 0.0,
        slope: 0.0,
        product: 0.0,
        unscaled: Matrices::NONE,
        matrices: Matrices::NONE,
        bell: Bell::NONE,
        frequency: 0.0,
        offset: [0.0; NODES],
        turn: [[0.0; NODES]; 2],
        turn_end: [0.0; 2],
    };

    /// Makes it the plan of steps of this length and half²·J under this load.
    #[inline(always)]
    pub fn prepare<S: Simd>(&mut self, simd: S, half: f64, product: f64, frequency: f64) {
        let slope = product / (half * half);
        if (half, slope) != (self.half, self.slope) {
            if product != 0.0 && product != self.product {
                self.product = product;
                with_slope(simd.level(), product, &mut self.unscaled);
            }
            self.slope = slope;
            self.scale(simd, half, product != 0.0);
            self.bell = Bell::of(simd, product);
        }
        if (half, frequency) == (self.half, self.frequency) {
            return;
        }
        self.half = half;
        self.frequency = frequency;
        let offset = scaled(pair(simd, &TABLE.place), half);
        self.offset = unpair(offset);
        if frequency != 0.0 {
            let mut turns = [[0.0; NODES]; 3];
            turns[0] = unpair(scaled(offset, frequency));
            turns[1] = unpair(shifted(pair(simd, &turns[0]), FRAC_PI_2));
            let whole = 2.0 * half * frequency;
            turns[2][..2].copy_from_slice(&[whole, whole + FRAC_PI_2]);
            sines(simd.level(), &mut turns.as_flattened_mut()[..2 * NODES + 4]);
            let [sine, cosine, [by_sine, by_cosine, ..]] = turns;
            self.turn = [sine, cosine];
            self.turn_end = [by_sine, by_cosine];
        }
    }

    /// The matrices of steps of this length from those of steps whose half is 1.
    #[inline(always)]
    fn scale<S: Simd>(&mut self, simd: S, half: f64, slopes: bool) {
        let from = if slopes { &self.unscaled } else { &TABLE.plain };
        let square = half * half;
        let to = &mut self.matrices;
        for x in rolled_if_narrow::<S, NODES>() {
            for register in 0..2 {
                (load(simd, &from.twice[x][register]) * square)
                    .store_slice(&mut to.twice[x][register]);
                (load(simd, &from.once[x][register]) * half).store_slice(&mut to.once[x][register]);
            }
        }
        let by_values = load(simd, &[square, half, square, square]);
        for j in rolled_if_narrow::<S, NODES>() {
            (load(simd, &from.end[j]) * by_values).store_slice(&mut to.end[j]);
        }
        let by_rate = load(simd, &[half, 1.0, half, half]);
        (load(simd, &from.end_drift) * by_rate).store_slice(&mut to.end_drift);
        to.drift = unpair(scaled(pair(simd, &from.drift), half));
        to.gain = from.gain;
    }

    /// The sine of the load at the nodes, where it has this phase at the begin.
    #[inline(always)]
    pub fn sine<S: Simd>(&self, simd: S, [sine, cosine]: [f64; 2]) -> Pair<S> {
        let phase = [sine, cosine].map(|value| f64x4::splat(simd, value));
        let [sines, cosines] = [pair(simd, &self.turn[0]), pair(simd, &self.turn[1])];
        [
            sine_of_sum(phase, [sines[0], cosines[0]]),
            sine_of_sum(phase, [sines[1], cosines[1]]),
        ]
    }

    /// The phase at the end from that at the begin.
    #[inline(always)]
    pub fn turned(&self, phase: [f64; 2]) -> [f64; 2] {
        turned(phase, self.turn_end)
    }

    /// The time of the nodes since a moment that lies `passed` before the begin.
    #[inline(always)]
    pub fn offset<S: Simd>(&self, simd: S, passed: f64) -> Pair<S> {
        shifted(pair(simd, &self.offset), passed)
    }

    /// g continued from the step before, which has the same length and slope, plus `shift`: the slope times by how
    /// much that step has moved.
    #[inline(always)]
    pub fn ahead<S: Simd>(&self, simd: S, g: Pair<S>, shift: f64) -> Pair<S> {
        self.bell.ahead(simd, g, shift)
    }

    /// g at the nodes, from its values at the nodes of a step before of half the length `before` with half²·J
    /// being `product`.
    #[inline(always)]
    pub fn resampled<S: Simd>(&self, simd: S, g: Pair<S>, before: f64, product: f64) -> Pair<S> {
        resampled(simd, g, before, product, pair(simd, &self.offset))
    }

    /// What x'_0 alone does to displacement and rate at the nodes.
    #[inline(always)]
    pub fn free<S: Simd>(&self, simd: S, rate: f64) -> [Pair<S>; 2] {
        [
            scaled(pair(simd, &self.matrices.drift), rate),
            scaled(pair(simd, &self.matrices.gain), rate),
        ]
    }

    /// Displacement and rate at the nodes from g.
    #[inline(always)]
    pub fn stages<S: Simd>(
        &self,
        simd: S,
        g: Pair<S>,
        [drift, gain]: [Pair<S>; 2],
    ) -> [Pair<S>; 2] {
        let values = both_permuted(g);
        [
            multiply(simd, &self.matrices.twice, &values, drift),
            multiply(simd, &self.matrices.once, &values, gain),
        ]
    }

    /// Displacement and change of x' at the end, and the last two Legendre coefficients of f
    /// times half².
    #[inline(always)]
    pub fn end<S: Simd>(&self, simd: S, g: Pair<S>, rate: f64) -> [f64; 4] {
        let g = unpair(g);
        let Matrices { end, end_drift, .. } = &self.matrices;
        // Four chains, as above.
        let mut sums = [f64x4::splat(simd, 0.0); 4];
        sums[0] = load(simd, end_drift) * rate;
        for j in 0..NODES {
            let value = f64x4::splat(simd, g[j]);
            sums[j % 4] = load(simd, &end[j]).mul_add(value, sums[j % 4]);
        }
        let mut ends = [0.0; 4];
        ((sums[0] + sums[1]) + (sums[2] + sums[3])).store_slice(&mut ends);
        ends
    }
}

/// g at the end of a step.
#[inline(always)]
pub fn last<S: Simd>(simd: S, g: Pair<S>) -> f64 {
    let [low, high] = pair(simd, &TABLE.last);
    let sums = Lanes::<S, 4>::store(high.mul_add(g[1], low * g[0]));
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

/// factor · values.
#[inline(always)]
pub fn scaled<S: Simd>([low, high]: Pair<S>, factor: f64) -> Pair<S> {
    [low * factor, high * factor]
}

/// values + by.
#[inline(always)]
pub fn shifted<S: Simd>([low, high]: Pair<S>, by: f64) -> Pair<S> {
    [low + by, high + by]
}

/// The largest value by size.
#[inline(always)]
pub fn largest<S: Simd>([low, high]: Pair<S>) -> f64 {
    let [low, high] = [Lanes::<S, 4>::abs(low), Lanes::<S, 4>::abs(high)];
    Lanes::<S, 4>::max(low, high).largest()
}

/// Sine and cosine of an angle.
#[inline(always)]
pub fn sine_and_cosine<S: Simd>(simd: S, angle: f64) -> [f64; 2] {
    let mut values = [angle, angle + FRAC_PI_2, 0.0, 0.0];
    sines(simd.level(), &mut values);
    [values[0], values[1]]
}

/// Takes the sine of each of the angles, whose number is a multiple of 4: in a function of its own,
/// since it is long and not hot.
#[inline(never)]
fn sines(level: Level, angles: &mut [f64]) {
    dispatch!(level, simd => {
        for four in angles.chunks_exact_mut(4) {
            load(simd, four).sin().store_slice(four);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    /// x'' = J·(x − x_0) + g, of which the plan takes the first part into its matrices.
    #[test]
    fn the_stages_solve_the_equation_with_its_slope() {
        let (half, rate) = (0.9, 0.3);
        let g: [f64; NODES] = std::array::from_fn(|k| 0.2 - 0.05 * (k as f64).sin());
        for slope in [0.0, -0.4, -2.0] {
            let mut plan = Plan::NONE;
            let ([x, v], end) = dispatch!(Level::new(), simd => {
                plan.prepare(simd, half, half * half * slope, 0.0);
                let g = pair(simd, &g);
                let [x, v] = plan.stages(simd, g, plan.free(simd, rate));
                ([unpair(x), unpair(v)], plan.end(simd, g, rate))
            });
            let f: [f64; NODES] = std::array::from_fn(|j| slope * x[j] + g[j]);
            let plain = &TABLE.plain;
            let apply = |matrix: &Diagonals, i: usize| -> f64 {
                (0..NODES).map(|x| matrix[x][i / 4][i % 4] * f[i ^ x]).sum()
            };
            for i in 0..NODES {
                let free = half * TABLE.place[i] * rate;
                let position = free + half * half * apply(&plain.twice, i);
                assert!((x[i] - position).abs() < 4e-16, "J = {slope}: {position}");
                let speed = rate + half * apply(&plain.once, i);
                assert!((v[i] - speed).abs() < 4e-16, "J = {slope}: {speed}");
            }
            let column = |row: usize| -> f64 { (0..NODES).map(|j| plain.end[j][row] * f[j]).sum() };
            let moved = 2.0 * half * rate + half * half * column(0);
            assert!((end[0] - moved).abs() < 8e-16, "J = {slope}: {moved}");
            assert!((end[1] - half * column(1)).abs() < 8e-16, "J = {slope}");
            assert!(
                (end[2] - half * half * column(2)).abs() < 8e-16,
                "J = {slope}"
            );
        }
    }
}
