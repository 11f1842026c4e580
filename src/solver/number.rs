//! What an equation may do with a number, so that one formula serves a single
//! value and a register of values.

use std::ops::{Add, Div, Mul, Sub};

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
