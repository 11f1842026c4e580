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

#![expect(
    clippy::needless_range_loop,
    reason = "iterators and closures are functions of their own, which are not compiled for the SIMD level"
)]

use fearless_simd::{Level, Simd, SimdBase, dispatch, f64x4};

use super::matrix::{diagonals, inverse_of_one_less, product};
use super::table::{Diagonals, TABLE};
use crate::solver::collocation::clenshaw;
use crate::solver::lanes::Lanes;
use crate::solver::number::Number;

/// Nodes of a step.
pub const NODES: usize = 8;

/// A number at each node, in two registers.
pub type Pair<S> = [f64x4<S>; 2];

/// What equal steps have in common. Numbers at the nodes are in the order of the table.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Half their length.
    pub half: f64,
    /// J.
    pub slope: f64,
    /// The angular frequency with which the load alternates.
    frequency: f64,
    /// The time of the nodes since the begin of the step.
    offset: [f64; NODES],
    /// Sine and cosine of the angle by which the load turns until then, and until the end.
    turn: [[f64; NODES]; 2],
    turn_end: [f64; 2],
    /// The displacement x − x_0 from x'_0.
    drift: [f64; NODES],
    /// x' from x'_0.
    gain: [f64; NODES],
    /// half²·W·A and half·(Â·W), where Â integrates once.
    twice: Diagonals,
    once: Diagonals,
    /// From each value of g, and from x'_0: displacement and change of x' at the end, and half²
    /// times the last two Legendre coefficients of f.
    end: [[f64; 4]; NODES],
    end_drift: [f64; 4],
}

#[inline(always)]
fn load<S: Simd>(simd: S, values: &[f64]) -> f64x4<S> {
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
fn both_permuted<S: Simd>([low, high]: Pair<S>) -> [[f64x4<S>; 4]; 2] {
    [permuted(low), permuted(high)]
}

/// `first + matrix · values`, the values permuted.
#[inline(always)]
fn multiply<S: Simd>(
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
        frequency: 0.0,
        offset: [0.0; NODES],
        turn: [[0.0; NODES]; 2],
        turn_end: [0.0; 2],
        drift: [0.0; NODES],
        gain: [0.0; NODES],
        twice: [[[0.0; 4]; 2]; NODES],
        once: [[[0.0; 4]; 2]; NODES],
        end: [[0.0; 4]; NODES],
        end_drift: [0.0; 4],
    };

    /// Makes it the plan of steps of this length under this load.
    #[inline(always)]
    pub fn prepare<S: Simd>(&mut self, simd: S, half: f64, slope: f64, frequency: f64) {
        if (half, slope) != (self.half, self.slope) {
            self.half = half;
            self.slope = slope;
            self.solve();
        } else if frequency == self.frequency {
            return;
        }
        self.frequency = frequency;
        let quarter = f64x4::splat(simd, std::f64::consts::FRAC_PI_2);
        let offset = pair(simd, &self.offset);
        let mut turn = [offset; 2];
        for k in 0..2 {
            let angle = offset[k] * frequency;
            turn[0][k] = angle.sin();
            turn[1][k] = (angle + quarter).sin();
        }
        self.turn = [unpair(turn[0]), unpair(turn[1])];
        self.turn_end = sine_and_cosine(simd, 2.0 * half * frequency);
    }

    /// Works out the matrices, with the instructions of every processor: that is rare, and so one
    /// copy of the code serves all levels.
    #[inline(never)]
    fn solve(&mut self) {
        dispatch!(Level::baseline(), simd => self.solve_with(simd));
    }

    #[inline(always)]
    fn solve_with<S: Simd>(&mut self, simd: S) {
        let Plan { half, slope, .. } = *self;
        let square = half * half;
        let table = &TABLE;
        let splat = |value: f64| f64x4::splat(simd, value);
        let place = pair(simd, &table.place);
        let z = square * slope;
        self.offset = unpair(scaled(place, half));
        self.drift = self.offset;
        self.gain = [1.0; NODES];
        self.end = table.end;
        self.end_drift = [2.0 * half, 0.0, 0.0, 0.0];
        let scale = load(simd, &[square, half, square, square]);
        let mut twice = table.twice;
        let mut once = table.once;
        if z != 0.0 {
            let inverse = inverse_of_one_less(simd, z, &table.twice);
            twice = product(simd, &inverse, &table.twice);
            once = product(simd, &table.once, &inverse);
            let mut drift = [0.0; NODES];
            let mut gain = [0.0; NODES];
            for i in 0..NODES {
                for k in 0..NODES {
                    drift[i] += inverse[i][k] * table.place[k];
                    gain[i] += once[i][k] * table.place[k];
                }
                gain[i] = 1.0 + z * gain[i];
            }
            self.drift = unpair(scaled(pair(simd, &drift), half));
            self.gain = gain;
            let mut end_drift = splat(0.0);
            for j in 0..NODES {
                let mut column = splat(0.0);
                for k in 0..NODES {
                    column = load(simd, &table.end[k]).mul_add(splat(inverse[k][j]), column);
                }
                column.store_slice(&mut self.end[j]);
                end_drift = load(simd, &table.end[j]).mul_add(splat(drift[j]), end_drift);
            }
            let ends = (end_drift * (half * slope)).mul_add(scale, load(simd, &self.end_drift));
            ends.store_slice(&mut self.end_drift);
        }
        for j in 0..NODES {
            (load(simd, &self.end[j]) * scale).store_slice(&mut self.end[j]);
        }
        self.twice = diagonals(&twice);
        self.once = diagonals(&once);
        for x in 0..NODES {
            for register in 0..2 {
                let twice = &mut self.twice[x][register];
                (load(simd, twice) * square).store_slice(twice);
                let once = &mut self.once[x][register];
                (load(simd, once) * half).store_slice(once);
            }
        }
    }

    /// The sine of the load at the nodes, where it has this phase at the begin.
    #[inline(always)]
    pub fn sine<S: Simd>(&self, simd: S, [sine, cosine]: [f64; 2]) -> Pair<S> {
        let by_sine = scaled(pair(simd, &self.turn[0]), cosine);
        let by_cosine = pair(simd, &self.turn[1]);
        let sine = f64x4::splat(simd, sine);
        [
            by_cosine[0].mul_add(sine, by_sine[0]),
            by_cosine[1].mul_add(sine, by_sine[1]),
        ]
    }

    /// The phase at the end from that at the begin.
    #[inline(always)]
    pub fn turned(&self, [sine, cosine]: [f64; 2]) -> [f64; 2] {
        let [by_sine, by_cosine] = self.turn_end;
        [
            sine * by_cosine + cosine * by_sine,
            cosine * by_cosine - sine * by_sine,
        ]
    }

    /// The time of the nodes since a moment that lies `passed` before the begin.
    #[inline(always)]
    pub fn offset<S: Simd>(&self, simd: S, passed: f64) -> Pair<S> {
        shifted(pair(simd, &self.offset), passed)
    }

    /// g continued from the step before, which has the same length and slope, and has moved
    /// the position by `moved`.
    #[inline(always)]
    pub fn ahead<S: Simd>(&self, simd: S, g: Pair<S>, moved: f64) -> Pair<S> {
        let shift = f64x4::splat(simd, self.slope * moved);
        multiply(simd, &TABLE.ahead, &both_permuted(g), [shift; 2])
    }

    /// g at the nodes, from its values at the nodes of a step before of half the length `before`.
    #[inline(always)]
    pub fn resampled<S: Simd>(&self, simd: S, g: &[f64; NODES], before: f64) -> Pair<S> {
        let mut series = [f64x4::splat(simd, 0.0); 2];
        for j in 0..NODES {
            let value = f64x4::splat(simd, g[j]);
            let [low, high] = pair(simd, &TABLE.series[j]);
            series = [
                low.mul_add(value, series[0]),
                high.mul_add(value, series[1]),
            ];
        }
        let series = unpair(series);
        let inverse = f64x4::splat(simd, 1.0 / before);
        let one = f64x4::splat(simd, 1.0);
        let mut values = pair(simd, &self.offset);
        for k in 0..2 {
            let u = values[k].mul_add(inverse, one);
            values[k] = clenshaw::<_, { NODES / 2 }>(u, |degree| u.same(series[degree]));
        }
        values
    }

    /// What x'_0 alone does to displacement and rate at the nodes.
    #[inline(always)]
    pub fn free<S: Simd>(&self, simd: S, rate: f64) -> [Pair<S>; 2] {
        [
            scaled(pair(simd, &self.drift), rate),
            scaled(pair(simd, &self.gain), rate),
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
            multiply(simd, &self.twice, &values, drift),
            multiply(simd, &self.once, &values, gain),
        ]
    }

    /// Displacement and change of x' at the end, and the last two Legendre coefficients of f
    /// times half².
    #[inline(always)]
    pub fn end<S: Simd>(&self, simd: S, g: Pair<S>, rate: f64) -> [f64; 4] {
        let g = unpair(g);
        let mut even = load(simd, &self.end_drift) * rate;
        let mut odd = load(simd, &self.end[1]) * g[1];
        for j in 0..NODES / 2 {
            let value = f64x4::splat(simd, g[2 * j]);
            even = load(simd, &self.end[2 * j]).mul_add(value, even);
            if j > 0 {
                let value = f64x4::splat(simd, g[2 * j + 1]);
                odd = load(simd, &self.end[2 * j + 1]).mul_add(value, odd);
            }
        }
        let mut ends = [0.0; 4];
        (even + odd).store_slice(&mut ends);
        ends
    }
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
    let quarter = std::f64::consts::FRAC_PI_2;
    let both = load(simd, &[angle, angle + quarter, 0.0, 0.0]).sin();
    let mut values = [0.0; 4];
    both.store_slice(&mut values);
    [values[0], values[1]]
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
                plan.prepare(simd, half, slope, 0.0);
                let g = pair(simd, &g);
                let [x, v] = plan.stages(simd, g, plan.free(simd, rate));
                ([unpair(x), unpair(v)], plan.end(simd, g, rate))
            });
            let f: [f64; NODES] = std::array::from_fn(|j| slope * x[j] + g[j]);
            let apply = |row: &[f64; NODES]| -> f64 { row.iter().zip(f).map(|(a, f)| a * f).sum() };
            for i in 0..NODES {
                let free = half * TABLE.place[i] * rate;
                let position = free + half * half * apply(&TABLE.twice[i]);
                assert!((x[i] - position).abs() < 4e-16, "J = {slope}: {position}");
                let speed = rate + half * apply(&TABLE.once[i]);
                assert!((v[i] - speed).abs() < 4e-16, "J = {slope}: {speed}");
            }
            let column = |row: usize| -> f64 { (0..NODES).map(|j| TABLE.end[j][row] * f[j]).sum() };
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
