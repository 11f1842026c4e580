//! SIMD registers as numbers: one lane for each node.

use std::hint::black_box;

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdFrom, f64x4, f64x8};

use super::number::Number;
use super::sine;

/// 0 to N − 1 for a loop that stays one: unrolled, it would be larger and no faster. The compiler does not see its
/// length, and would check an index that is not taken modulo the true one.
#[inline(always)]
pub fn rolled<const N: usize>() -> impl Iterator<Item = usize> {
    (0..black_box(N)).map(|i| i % N)
}

/// [`rolled`] where registers hold two numbers, so that a turn of the loop takes twice the instructions.
#[inline(always)]
pub fn rolled_if_narrow<S: Simd, const N: usize>() -> impl Iterator<Item = usize> {
    let is_narrow = <f64x4<S> as Number>::IS_NARROW;
    (0..if is_narrow { black_box(N) } else { N }).map(|i| i % N)
}

/// P numbers that are computed together.
pub trait Lanes<S: Simd, const P: usize>: Number {
    /// These values in the lanes.
    fn load(simd: S, values: &[f64; P]) -> Self;

    /// One value in all lanes.
    fn fill(simd: S, value: f64) -> Self;

    /// The values in the lanes.
    #[must_use]
    fn store(self) -> [f64; P];

    /// The absolute values.
    #[must_use]
    fn abs(self) -> Self;

    /// The larger one in each lane.
    #[must_use]
    fn max(self, other: Self) -> Self;

    /// The smaller one in each lane.
    #[must_use]
    fn min(self, other: Self) -> Self;

    /// The largest value in any lane.
    #[must_use]
    fn largest(self) -> f64;

    /// The smallest value in any lane.
    #[must_use]
    fn smallest(self) -> f64;
}

macro_rules! lanes {
    ($($register:ident of $lanes:literal),*) => {$(
        impl<S: Simd> Number for $register<S> {
            const IS_NARROW: bool = <S::f64s as SimdBase<S>>::LEN == 2;

            #[inline(always)]
            fn same(self, value: f64) -> Self {
                $register::splat(self.simd, value)
            }

            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                SimdFloat::mul_add(self, factor, addend)
            }

            #[inline(always)]
            fn sin(self) -> Self {
                sine::sine(self)
            }

            /// Lane by lane, as single numbers.
            #[inline(always)]
            fn exp(self) -> Self {
                let mut values = [0.0; $lanes];
                self.store_slice(&mut values);
                $register::simd_from(self.simd, values.map(f64::exp))
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                SimdFloat::sqrt(self)
            }

            #[inline(always)]
            fn magnitude(self) -> Self {
                <Self as SimdBase<S>>::abs(self)
            }
        }

        impl<S: Simd> Lanes<S, $lanes> for $register<S> {
            #[inline(always)]
            fn load(simd: S, values: &[f64; $lanes]) -> Self {
                $register::simd_from(simd, *values)
            }

            #[inline(always)]
            fn fill(simd: S, value: f64) -> Self {
                $register::splat(simd, value)
            }

            #[inline(always)]
            fn store(self) -> [f64; $lanes] {
                let mut values = [0.0; $lanes];
                self.store_slice(&mut values);
                values
            }

            #[inline(always)]
            fn abs(self) -> Self {
                <Self as SimdBase<S>>::abs(self)
            }

            #[inline(always)]
            fn max(self, other: Self) -> Self {
                <Self as SimdBase<S>>::max(self, other)
            }

            #[inline(always)]
            fn min(self, other: Self) -> Self {
                <Self as SimdBase<S>>::min(self, other)
            }

            #[inline(always)]
            fn largest(self) -> f64 {
                self.reduce_max()
            }

            #[inline(always)]
            fn smallest(self) -> f64 {
                self.reduce_min()
            }
        }
    )*};
}

lanes!(f64x4 of 4, f64x8 of 8);
