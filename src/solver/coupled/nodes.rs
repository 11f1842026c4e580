//! Numbers at all nodes of a step, as one number of the equation.
//!
//! Vectors of WebAssembly hold two numbers, so that each operation is eight: were all inlined, the library would take
//! half as long again to compile there, for a page that has no system with first-order states.

use std::ops::{Add, Div, Mul, Sub};

use fearless_simd::{Simd, f64x8};

use crate::arithmetic::lanes::Lanes;
use crate::arithmetic::number::Number;
use crate::solver::tables::Columns;

/// Nodes in a register.
const LANES: usize = 8;

/// Rows of the unit matrix; fewer nodes take the begin of a row.
static UNITS: [[f64; UNIT_NODES]; UNIT_NODES] = {
    let mut units = [[0.0; UNIT_NODES]; UNIT_NODES];
    let mut node = 0;
    while node < UNIT_NODES {
        units[node][node] = 1.0;
        node += 1;
    }
    units
};

/// The largest number of nodes.
const UNIT_NODES: usize = 16;

/// A number for each of 8 R nodes, in R registers.
#[derive(Clone, Copy)]
pub(super) struct Nodes<S: Simd, const R: usize>([f64x8<S>; R]);

impl<S: Simd, const R: usize> Nodes<S, R> {
    /// The same number at all nodes.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub fn fill(simd: S, value: f64) -> Self {
        Nodes([f64x8::fill(simd, value); R])
    }

    /// 1 at this node, 0 at the others.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub fn unit(simd: S, node: usize) -> Self {
        Nodes::load::<UNIT_NODES>(simd, &UNITS[node])
    }

    /// These numbers.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub fn load<const N: usize>(simd: S, values: &[f64; N]) -> Self {
        let mut nodes = Nodes::fill(simd, 0.0);
        for r in 0..R {
            let mut part = [0.0; LANES];
            part.copy_from_slice(&values[LANES * r..LANES * (r + 1)]);
            nodes.0[r] = f64x8::load(simd, &part);
        }
        nodes
    }

    /// The numbers.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub fn store<const N: usize>(self) -> [f64; N] {
        let mut values = [0.0; N];
        for r in 0..R {
            values[LANES * r..LANES * (r + 1)].copy_from_slice(&self.0[r].store());
        }
        values
    }

    /// `Σ_j column[j] · value[j]`, in a fixed order.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub fn product<const N: usize>(simd: S, columns: &Columns<N>, values: &[f64; N]) -> Self {
        let [mut even, mut odd] = [Nodes::fill(simd, 0.0); 2];
        // In pairs, so that both sums stay in registers.
        for pair in 0..N / 2 {
            let j = 2 * pair;
            let column: Self = Nodes::load(simd, &columns[j]);
            even = column.mul_add(Nodes::fill(simd, values[j]), even);
            let column: Self = Nodes::load(simd, &columns[j + 1]);
            odd = column.mul_add(Nodes::fill(simd, values[j + 1]), odd);
        }
        even + odd
    }

    /// The size of the largest number; NaN where one is that.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub fn largest(self) -> f64 {
        let mut largest = 0.0_f64;
        for r in 0..R {
            let here = Lanes::abs(self.0[r]).largest();
            largest = if here <= largest { largest } else { here };
        }
        largest
    }

    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn each(mut self, of: impl Fn(f64x8<S>) -> f64x8<S>) -> Self {
        for r in 0..R {
            self.0[r] = of(self.0[r]);
        }
        self
    }
}

macro_rules! operators {
    ($($operator:ident $name:ident),*) => {$(
        impl<S: Simd, const R: usize> $operator for Nodes<S, R> {
            type Output = Self;

            #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
            fn $name(mut self, other: Self) -> Self {
                for r in 0..R {
                    self.0[r] = $operator::$name(self.0[r], other.0[r]);
                }
                self
            }
        }
    )*};
}

operators!(Add add, Sub sub, Mul mul, Div div);

impl<S: Simd, const R: usize> Number for Nodes<S, R> {
    const IS_NARROW: bool = <f64x8<S> as Number>::IS_NARROW;

    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn same(self, value: f64) -> Self {
        Nodes([self.0[0].same(value); R])
    }

    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn mul_add(mut self, factor: Self, addend: Self) -> Self {
        for r in 0..R {
            self.0[r] = Number::mul_add(self.0[r], factor.0[r], addend.0[r]);
        }
        self
    }

    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn sin(self) -> Self {
        self.each(Number::sin)
    }

    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn exp(self) -> Self {
        self.each(Number::exp)
    }

    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn sqrt(self) -> Self {
        self.each(Number::sqrt)
    }

    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn magnitude(self) -> Self {
        self.each(Number::magnitude)
    }
}
