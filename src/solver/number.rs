//! What an equation may do with a number, so that one formula serves a single
//! value and a register of values.

use std::ops::{Add, Div, Mul, Sub};

use fearless_simd::{Simd, SimdBase, SimdFloat, f64x8};

/// A real number, or lanes of real numbers that are computed together.
pub trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// `value`, in as many lanes as `self` has.
    #[must_use]
    fn same(self, value: f64) -> Self;

    /// `self · factor + addend`; rounded once where the processor can, twice
    /// where that would be slow.
    #[must_use]
    fn mul_add(self, factor: Self, addend: Self) -> Self;

    /// Sine of the angle in radians.
    #[must_use]
    fn sin(self) -> Self;
}

impl Number for f64 {
    #[inline(always)]
    fn same(self, value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn mul_add(self, factor: f64, addend: f64) -> f64 {
        self * factor + addend
    }

    #[inline(always)]
    fn sin(self) -> f64 {
        f64::sin(self)
    }
}

impl<S: Simd> Number for f64x8<S> {
    #[inline(always)]
    fn same(self, value: f64) -> Self {
        f64x8::splat(self.simd, value)
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        SimdFloat::mul_add(self, factor, addend)
    }

    /// Taylor series after taking out multiples of π. Exact reduction below
    /// 1e6 radians; absolute error below 3e-16.
    #[inline(always)]
    fn sin(self) -> Self {
        let number = |value: f64| self.same(value);
        let halves = (self * number(std::f64::consts::FRAC_1_PI)).round_ties_even();
        let rest = self - halves * number(PI_HIGH) - halves * number(PI_LOW);
        let square = rest * rest;
        // −1 for an odd number of half turns.
        let odd = halves - (halves * number(0.5)).floor() * number(2.0);
        let sign = number(1.0) - odd * number(2.0);
        let mut sum = number(SINE[0]);
        for &coefficient in &SINE[1..] {
            sum = SimdFloat::mul_add(sum, square, number(coefficient));
        }
        rest * sum * sign
    }
}

/// π in 33 bits, so that small multiples are exact, and the rest.
const PI_HIGH: f64 = 3.141_592_653_468_251_2;
const PI_LOW: f64 = 1.215_420_101_301_238_4e-10;

/// Number of terms: the next one is below 1e-18 at π/2.
const TERMS: usize = 12;

/// (−1)ᵏ/(2k+1)!, the highest first: sin r = r · Σ r²ᵏ (−1)ᵏ/(2k+1)!.
const SINE: [f64; TERMS] = {
    let mut terms = [1.0; TERMS];
    let mut factorial = 1.0;
    let mut k = 1;
    while k < TERMS {
        factorial *= -((2 * k * (2 * k + 1)) as f64);
        terms[TERMS - 1 - k] = 1.0 / factorial;
        k += 1;
    }
    terms
};

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, SimdFrom, dispatch};

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
