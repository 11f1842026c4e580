//! Products of a table with the values at the nodes.

use fearless_simd::Simd;
use nalgebra::{SMatrixView, SVector};

use super::Columns;
use crate::arithmetic::lanes::Lanes;

/// The product of a table with the values at the nodes.
pub(in crate::solver) fn product<const N: usize>(
    columns: &Columns<N>,
    values: &[f64; N],
) -> SVector<f64, N> {
    SMatrixView::<f64, N, N>::from_slice(columns.as_flattened()) * SVector::from(*values)
}

/// `Σ_j column[j] · value[j]`, in a fixed order.
#[inline(always)]
pub(in crate::solver) fn product_in_lanes<S: Simd, V: Lanes<S, P>, const P: usize>(
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
