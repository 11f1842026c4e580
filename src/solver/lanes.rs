//! SIMD registers as numbers: one lane for each node.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdFrom, f64x4, f64x8};

use super::number::Number;

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

    /// The angles less whole turns.
    #[must_use]
    fn within_a_turn(self) -> Self;

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
            #[inline(always)]
            fn same(self, value: f64) -> Self {
                $register::splat(self.simd, value)
            }

            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                SimdFloat::mul_add(self, factor, addend)
            }

            /// Taylor series after taking out multiples of π. Exact reduction
            /// below 1e6 radians; absolute error below 3e-16.
            #[inline(always)]
            fn sin(self) -> Self {
                let number = |value: f64| self.same(value);
                let halves = (self * number(std::f64::consts::FRAC_1_PI)).whole();
                let most = SimdFloat::mul_add(halves, number(-PI_HIGH), self);
                let rest = SimdFloat::mul_add(halves, number(-PI_LOW), most);
                let square = rest * rest;
                // −1 for an odd number of half turns, of which 1 or −1 is left.
                let turns = (halves * number(0.5)).whole();
                let odd = SimdFloat::mul_add(turns, number(-2.0), halves);
                let sign = SimdFloat::mul_add(odd * odd, number(-2.0), number(1.0));
                let turned = rest * sign;
                // By pairs of terms (Estrin), since each operation of a single sum would
                // wait for the last.
                let pair = |k: usize| SimdFloat::mul_add(number(SINE[k + 1]), square, number(SINE[k]));
                let fourth = square * square;
                let eighth = fourth * fourth;
                let low = SimdFloat::mul_add(pair(2), fourth, pair(0));
                let high = SimdFloat::mul_add(pair(6), fourth, pair(4));
                let high = SimdFloat::mul_add(pair(8), eighth, high);
                let sum = SimdFloat::mul_add(high, eighth, low);
                SimdFloat::mul_add(turned * square, sum, turned)
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
            fn within_a_turn(self) -> Self {
                let number = |value: f64| self.same(value);
                let turns = (self * number(0.5 * std::f64::consts::FRAC_1_PI)).whole();
                let most = SimdFloat::mul_add(turns, number(-2.0 * PI_HIGH), self);
                SimdFloat::mul_add(turns, number(-2.0 * PI_LOW), most)
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

/// π in 33 bits, so that small multiples are exact, and the rest.
const PI_HIGH: f64 = 3.141_592_653_468_251_2;
const PI_LOW: f64 = 1.215_420_101_301_238_4e-10;

/// Number of terms: the next one is below 2e-18 at π/2.
const TERMS: usize = 10;

/// (−1)ᵏ/(2k+1)! for k = 1 to 10: sin r = r + r³ · Σ r²ᵏ⁻² (−1)ᵏ/(2k+1)!.
const SINE: [f64; TERMS] = {
    let mut terms = [0.0; TERMS];
    let mut factorial = 1.0;
    let mut k = 1;
    while k <= TERMS {
        factorial *= -((2 * k * (2 * k + 1)) as f64);
        terms[k - 1] = 1.0 / factorial;
        k += 1;
    }
    terms
};

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    #[test]
    fn the_sine_of_lanes_is_that_of_single_numbers() {
        for step in 0..4000 {
            let angles: [f64; 8] =
                std::array::from_fn(|lane| -20.0 + 0.01 * f64::from(step) + 0.001 * lane as f64);
            let sine = dispatch!(Level::new(), simd => {
                <[f64; 8]>::from(Number::sin(f64x8::simd_from(simd, angles)))
            });
            for lane in 0..8 {
                let error = (sine[lane] - angles[lane].sin()).abs();
                assert!(error < 3e-16, "sin {}: {error}", angles[lane]);
            }
        }
    }
}
