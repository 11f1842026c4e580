//! What an equation may do with a number, so that one formula serves a single
//! value and a register of values.

use std::ops::{Add, Div, Mul, Sub};

/// Numbers this large are whole: a small one that has been added is rounded. 1.5 · 2⁵².
const WHOLE: f64 = 6_755_399_441_055_744.0;

/// A real number, or lanes of real numbers that are computed together.
pub trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// Whether its registers hold no more than two numbers: a formula of fewer operations is then faster than one in
    /// which fewer wait for another.
    const IS_NARROW: bool = false;

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

    /// Exponential function.
    #[must_use]
    fn exp(self) -> Self;

    /// Square root.
    #[must_use]
    fn sqrt(self) -> Self;

    /// Absolute value.
    #[must_use]
    fn magnitude(self) -> Self;

    /// The nearest whole number, the even one of two, of a number whose absolute value is below
    /// 2⁵¹. It uses no rounding instruction: the oldest x86-64 would call a function for that.
    #[must_use]
    #[inline(always)]
    fn whole(self) -> Self {
        let large = self.same(WHOLE);
        (self + large) - large
    }
}

/// A number of which a formula is made, beside those that it is asked for: it may itself carry
/// derivatives along.
pub trait Parameter: Number {
    /// Its value.
    fn value(self) -> f64;

    /// Whether it is 0 and stays it.
    fn is_nothing(self) -> bool;

    /// Its derivatives with another value, where that is known better.
    #[must_use]
    fn with_value(self, value: f64) -> Self;
}

/// A [`Parameter`] of formulas over `N`.
pub trait ParameterOf<N>: Parameter {
    /// The parameter, in as many lanes as `like` has.
    fn lift(self, like: N) -> N;
}

impl Parameter for f64 {
    #[inline(always)]
    fn value(self) -> f64 {
        self
    }

    #[inline(always)]
    fn is_nothing(self) -> bool {
        self == 0.0
    }

    #[inline(always)]
    fn with_value(self, value: f64) -> f64 {
        value
    }
}

impl<N: Number> ParameterOf<N> for f64 {
    #[inline(always)]
    fn lift(self, like: N) -> N {
        like.same(self)
    }
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

    #[inline(always)]
    fn exp(self) -> f64 {
        f64::exp(self)
    }

    #[inline(always)]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn magnitude(self) -> f64 {
        f64::abs(self)
    }
}
