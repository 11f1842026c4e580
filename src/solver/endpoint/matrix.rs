//! The matrices of a slope.

use fearless_simd::{Level, Simd, SimdBase, dispatch, f64x4};

use super::plan::{NODES, both_permuted, load, multiply, pair, scaled, unpair};
use super::table::{Dense, Diagonals, Matrices, TABLE};
use crate::arithmetic::lanes::rolled;
use crate::arithmetic::number::Number;

/// A matrix by rows.
type Matrix = [[f64; NODES]; NODES];

/// Makes the matrices [A, B, …] to [W·A, B·W, …], where W = (1 − slope·A)⁻¹. The slope begins to act at one node after
/// the other, each time by a matrix of rank one (Sherman and Morrison); no pivoting is needed for a slope ≤ 0.
#[inline(always)]
fn include_slope<S: Simd, const M: usize>(simd: S, slope: f64, matrices: &mut [Matrix; M]) {
    for p in rolled::<NODES>() {
        let own = &matrices[0][p];
        let own = scaled(pair(simd, own), slope / (1.0 - slope * own[p]));
        for matrix in matrices.iter_mut() {
            for r in rolled::<NODES>() {
                let row = &mut matrix[r];
                let factor = f64x4::splat(simd, row[p]);
                let [low, high] = pair(simd, row);
                *row = unpair([own[0].mul_add(factor, low), own[1].mul_add(factor, high)]);
            }
        }
    }
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
    let mut both = [rows(&plain.twice), rows(&plain.once)];
    include_slope(simd, slope, &mut both);
    let [twice, once] = &both;
    matrices.twice = diagonals(twice);
    matrices.once = diagonals(once);
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
    for j in rolled::<NODES>() {
        let mut end = f64x4::splat(simd, 0.0);
        for k in 0..NODES {
            end = own[k].mul_add(f64x4::splat(simd, twice[k][j]), end);
        }
        (end + load(simd, &plain.end[j])).store_slice(&mut matrices.end[j]);
    }
    end_drift.store_slice(&mut matrices.end_drift);
}

/// Makes it W·B, where B integrates once over steps whose half is 1 and W = (1 + product·B)⁻¹.
#[inline(never)]
pub fn with_relaxation(level: Level, product: f64, matrix: &mut Diagonals) {
    dispatch!(level, simd => {
        let mut once = [rows(&TABLE.plain.once)];
        include_slope(simd, -product, &mut once);
        *matrix = diagonals(&once[0]);
    });
}
