//! A first-order state over equal steps of 8 nodes.
//!
//! As a [`Plan`](super::plan::Plan) does for the position: with g = z' + r·(z − z_0) for a fixed rate r ≈ −∂z'/∂z the
//! stages solve z = z_0 + half·W·B·g, where W = (1 + half·r·B)⁻¹ and B integrates once. Steps of another length keep
//! W·B, with another r.

use fearless_simd::{Simd, SimdBase, f64x4};

use super::matrix::with_relaxation;
use super::plan::{NODES, Pair, both_permuted, largest, load, multiply, scaled, unpair};
use super::table::{Diagonals, TABLE};
use crate::arithmetic::number::Number;

/// What equal steps of one state have in common.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Relaxation {
    half: f64,
    /// r.
    pub rate: f64,
    /// half·r, NaN where there is none, and W·B.
    product: f64,
    matrix: Diagonals,
}

/// What a step makes of a state.
#[derive(Clone, Copy)]
pub struct Change {
    /// By how much it has moved.
    pub moved: f64,
    /// Half the length times the last two Legendre coefficients of z', by their size.
    pub tail: f64,
    /// Half the length times the largest |g|.
    pub size: f64,
}

impl Change {
    /// That of a state which a system does not have.
    pub const NONE: Change = Change {
        moved: 0.0,
        tail: 0.0,
        size: 0.0,
    };
}

impl Relaxation {
    /// None: of no length.
    pub const NONE: Relaxation = Relaxation {
        half: 0.0,
        rate: 0.0,
        product: f64::NAN,
        matrix: [[[0.0; 4]; 2]; NODES],
    };

    /// Makes it that of steps of this length with this half·r.
    #[inline(always)]
    pub fn prepare<S: Simd>(&mut self, simd: S, half: f64, product: f64) {
        (self.half, self.rate) = (half, product / half);
        if product != self.product {
            self.product = product;
            with_relaxation(simd.level(), product, &mut self.matrix);
        }
    }

    /// z − z_0 at the nodes from g.
    #[inline(always)]
    pub fn displacement<S: Simd>(&self, simd: S, g: Pair<S>) -> Pair<S> {
        let none = [f64x4::splat(simd, 0.0); 2];
        scaled(
            multiply(simd, &self.matrix, &both_permuted(g), none),
            self.half,
        )
    }

    /// The end of a step with this g and displacement at the nodes.
    #[inline(always)]
    pub fn end<S: Simd>(&self, simd: S, g: Pair<S>, displacement: Pair<S>) -> Change {
        let rate = f64x4::splat(simd, -self.rate);
        let slopes = unpair([
            displacement[0].mul_add(rate, g[0]),
            displacement[1].mul_add(rate, g[1]),
        ]);
        let mut sum = f64x4::splat(simd, 0.0);
        for j in 0..NODES {
            sum = load(simd, &TABLE.plain.end[j]).mul_add(f64x4::splat(simd, slopes[j]), sum);
        }
        let mut ends = [0.0; 4];
        (sum * f64x4::splat(simd, self.half)).store_slice(&mut ends);
        let [_, moved, sixth, seventh] = ends;
        Change {
            moved,
            tail: sixth.abs() + seventh.abs(),
            size: self.half * largest::<S>(g),
        }
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;
    use crate::solver::endpoint::plan::pair;

    /// z' = −r·z + u⁵ from z = 0, whose solution is a polynomial and an exponential.
    #[test]
    fn the_stages_solve_the_equation_of_a_state_that_relaxes() {
        let half = 0.7;
        for rate in [0.0, 0.3, 2.5] {
            let source = TABLE.place.map(|place| (place - 1.0).powi(5));
            let mut plan = Relaxation::NONE;
            let (z, change) = dispatch!(Level::new(), simd => {
                plan.prepare(simd, half, half * rate);
                let g = pair(simd, &source);
                let z = plan.displacement(simd, g);
                (unpair(z), plan.end(simd, g, z))
            });
            // The residual at the nodes, by the matrix that integrates once.
            for i in 0..NODES {
                let slope = |j: usize| source[j] - rate * z[j];
                let sum: f64 = (0..NODES)
                    .map(|x| TABLE.plain.once[x][i / 4][i % 4] * slope(i ^ x))
                    .sum();
                assert!((z[i] - half * sum).abs() < 1e-15, "{rate}: {}", z[i]);
            }
            // ∫ exp(−r(h − s)) u⁵ ds over the step, by many small parts.
            let parts = 20_000;
            let width = 2.0 * half / f64::from(parts);
            let exact: f64 = (0..parts)
                .map(|k| {
                    let s = (f64::from(k) + 0.5) * width;
                    (-rate * (2.0 * half - s)).exp() * (s / half - 1.0).powi(5) * width
                })
                .sum();
            assert!(
                (change.moved - exact).abs() < 1e-8,
                "{rate}: {}",
                change.moved
            );
        }
    }
}
