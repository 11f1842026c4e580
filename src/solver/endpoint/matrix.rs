//! Products and inverses of matrices over the nodes.

#![expect(
    clippy::needless_range_loop,
    reason = "iterators and closures are functions of their own, which are not compiled for the SIMD level"
)]

use fearless_simd::{Simd, SimdBase, f64x4};

use super::plan::{NODES, pair, scaled, unpair};
use super::table::Diagonals;
use crate::solver::number::Number;

/// A matrix by rows.
pub type Matrix = [[f64; NODES]; NODES];

/// (1 − z·matrix)⁻¹ by Gauss and Jordan; no pivoting is needed for z ≤ 0.
#[inline(always)]
pub fn inverse_of_one_less<S: Simd>(simd: S, z: f64, matrix: &Matrix) -> Matrix {
    let mut rows = *matrix;
    for i in 0..NODES {
        rows[i] = unpair(scaled(pair(simd, &rows[i]), -z));
        rows[i][i] += 1.0;
    }
    for p in 0..NODES {
        let pivot = 1.0 / rows[p][p];
        rows[p][p] = 1.0;
        let own = scaled(pair(simd, &rows[p]), pivot);
        rows[p] = unpair(own);
        for r in 0..NODES {
            if r != p {
                let factor = f64x4::splat(simd, -rows[r][p]);
                rows[r][p] = 0.0;
                let [left, right] = pair(simd, &rows[r]);
                rows[r] = unpair([own[0].mul_add(factor, left), own[1].mul_add(factor, right)]);
            }
        }
    }
    rows
}

/// left · right.
#[inline(always)]
pub fn product<S: Simd>(simd: S, left: &Matrix, right: &Matrix) -> Matrix {
    let mut rows = [[0.0; NODES]; NODES];
    for i in 0..NODES {
        let mut row = [f64x4::splat(simd, 0.0); 2];
        for k in 0..NODES {
            let factor = f64x4::splat(simd, left[i][k]);
            let [low, high] = pair(simd, &right[k]);
            row = [low.mul_add(factor, row[0]), high.mul_add(factor, row[1])];
        }
        rows[i] = unpair(row);
    }
    rows
}

/// The matrix by diagonals.
#[inline(always)]
pub fn diagonals(matrix: &Matrix) -> Diagonals {
    let mut diagonals = [[[0.0; 4]; 2]; NODES];
    for i in 0..NODES {
        for j in 0..NODES {
            diagonals[i ^ j][i / 4][i % 4] = matrix[i][j];
        }
    }
    diagonals
}
