//! The matrices of a slope: products and inverses of matrices over the nodes.

#![expect(
    clippy::needless_range_loop,
    reason = "iterators and closures are functions of their own, which are not compiled for the SIMD level"
)]

use fearless_simd::{Level, Simd, SimdBase, dispatch, f64x4};

use super::plan::{NODES, Pair, both_permuted, load, multiply, pair, scaled, unpair};
use super::table::{Dense, Diagonals, Matrices, TABLE};
use crate::arithmetic::lanes::rolled;
use crate::arithmetic::number::Number;

/// A matrix by rows.
type Matrix = [[f64; NODES]; NODES];

/// (1 − z·matrix)⁻¹·matrix by Gauss and Jordan; no pivoting is needed for z ≤ 0.
#[inline(always)]
fn quotient<S: Simd>(simd: S, z: f64, matrix: &Matrix) -> Matrix {
    let [mut left, mut right] = [*matrix; 2];
    for i in 0..rolled::<S>(NODES) {
        let i = i % NODES;
        left[i] = unpair(scaled(pair(simd, &left[i]), -z));
        left[i][i] += 1.0;
    }
    for p in 0..rolled::<S>(NODES) {
        let p = p % NODES;
        let pivot = 1.0 / left[p][p];
        let own = [
            scaled(pair(simd, &left[p]), pivot),
            scaled(pair(simd, &right[p]), pivot),
        ];
        [left[p], right[p]] = [unpair(own[0]), unpair(own[1])];
        for r in 0..rolled::<S>(NODES) {
            let r = r % NODES;
            if r != p {
                let factor = f64x4::splat(simd, -left[r][p]);
                left[r] = unpair(added(pair(simd, &left[r]), factor, own[0]));
                right[r] = unpair(added(pair(simd, &right[r]), factor, own[1]));
            }
        }
    }
    right
}

/// row + factor · other.
#[inline(always)]
fn added<S: Simd>(row: Pair<S>, factor: f64x4<S>, other: Pair<S>) -> Pair<S> {
    [
        other[0].mul_add(factor, row[0]),
        other[1].mul_add(factor, row[1]),
    ]
}

/// matrix + factor · left · right.
#[inline(always)]
fn sum<S: Simd>(simd: S, matrix: &Matrix, factor: f64, left: &Matrix, right: &Matrix) -> Matrix {
    let mut rows = *matrix;
    for i in 0..rolled::<S>(NODES) {
        let i = i % NODES;
        let mut row = pair(simd, &rows[i]);
        for k in 0..rolled::<S>(NODES) {
            let k = k % NODES;
            let factor = f64x4::splat(simd, factor * left[i][k]);
            row = added(row, factor, pair(simd, &right[k]));
        }
        rows[i] = unpair(row);
    }
    rows
}

/// The matrix by rows.
#[inline(never)]
fn rows(diagonals: &Diagonals) -> Matrix {
    let mut rows = [[0.0; NODES]; NODES];
    for i in 0..NODES {
        for j in 0..NODES {
            rows[i][j] = diagonals[i ^ j][i / 4][i % 4];
        }
    }
    rows
}

/// The matrix by diagonals.
#[inline(never)]
fn diagonals(matrix: &Matrix) -> Diagonals {
    let mut diagonals = [[[0.0; 4]; 2]; NODES];
    for i in 0..NODES {
        for j in 0..NODES {
            diagonals[i ^ j][i / 4][i % 4] = matrix[i][j];
        }
    }
    diagonals
}

/// Makes them the matrices of steps whose half is 1 with this slope.
#[inline(never)]
pub fn with_slope(level: Level, slope: f64, matrices: &mut Matrices) {
    dispatch!(level, simd => with_slope_by(simd, slope, matrices));
}

#[inline(always)]
fn with_slope_by<S: Simd>(simd: S, slope: f64, matrices: &mut Matrices) {
    let Dense { place, plain, .. } = &TABLE;
    let twice = rows(&plain.twice);
    // W·A, of which W is 1 + J·W·A.
    let twice = quotient(simd, slope, &twice);
    let once = rows(&plain.once);
    let once = sum(simd, &once, slope, &once, &twice);
    matrices.twice = diagonals(&twice);
    matrices.once = diagonals(&once);
    let places = both_permuted(scaled(pair(simd, place), slope));
    let from = |values| pair(simd, values);
    matrices.drift = unpair(multiply(simd, &matrices.twice, &places, from(&plain.drift)));
    matrices.gain = unpair(multiply(simd, &matrices.once, &places, from(&plain.gain)));
    let mut own = [f64x4::splat(simd, 0.0); NODES];
    let mut end_drift = load(simd, &plain.end_drift);
    for k in 0..NODES {
        own[k] = load(simd, &plain.end[k]) * slope;
        end_drift = own[k].mul_add(f64x4::splat(simd, matrices.drift[k]), end_drift);
    }
    for j in 0..rolled::<S>(NODES) {
        let j = j % NODES;
        let mut end = f64x4::splat(simd, 0.0);
        for k in 0..NODES {
            end = own[k].mul_add(f64x4::splat(simd, twice[k][j]), end);
        }
        (end + load(simd, &plain.end[j])).store_slice(&mut matrices.end[j]);
    }
    end_drift.store_slice(&mut matrices.end_drift);
}
