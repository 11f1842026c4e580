//! Truncated power series, for derivatives without differences: whatever is
//! computed from numbers can be computed from these, and then carries its
//! derivatives along, exact to rounding.
//!
//! With two terms a jet is a dual number: a value and its change in one
//! direction. With more it is a Taylor series, for instance in time. The
//! recurrences are those of A. Griewank and A. Walther, "Evaluating
//! Derivatives", 2nd ed. (2008), section 13.2.

use std::ops::{Add, Div, Mul, Sub};

use super::number::{Number, Parameter, ParameterOf};

/// Σ term\[k\] εᵏ for k < `TERMS`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet<const TERMS: usize> {
    /// The coefficients: the k-th derivative over k!.
    pub term: [f64; TERMS],
}

/// A value and its change in one direction.
pub type Dual = Jet<2>;

/// Highest order of the derivatives with respect to time that are offered.
pub const HIGHEST_ORDER: usize = 5;

/// A quantity as a power series in the time from now on, right up to
/// [`HIGHEST_ORDER`] even for the second derivative of a state.
pub type TimeSeries = Jet<{ HIGHEST_ORDER + 3 }>;

impl Dual {
    /// A number that changes at the rate `slope`.
    #[must_use]
    pub const fn new(value: f64, slope: f64) -> Dual {
        Jet {
            term: [value, slope],
        }
    }

    /// The change in the direction.
    #[must_use]
    pub const fn slope(self) -> f64 {
        self.term[1]
    }
}

impl<const TERMS: usize> Jet<TERMS> {
    /// A number that does not change.
    #[must_use]
    pub const fn constant(value: f64) -> Jet<TERMS> {
        let mut term = [0.0; TERMS];
        term[0] = value;
        Jet { term }
    }

    /// ε itself: the variable in which the series are.
    #[must_use]
    pub const fn variable() -> Jet<TERMS> {
        let mut term = [0.0; TERMS];
        term[1] = 1.0;
        Jet { term }
    }
}

/// Σ first\[j\] · second\[last − j\] for `j` in the range.
fn convolution(
    first: &[f64],
    second: &[f64],
    last: usize,
    range: std::ops::RangeInclusive<usize>,
) -> f64 {
    range.map(|j| first[j] * second[last - j]).sum()
}

impl<const TERMS: usize> Add for Jet<TERMS> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Jet {
            term: std::array::from_fn(|k| self.term[k] + other.term[k]),
        }
    }
}

impl<const TERMS: usize> Sub for Jet<TERMS> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Jet {
            term: std::array::from_fn(|k| self.term[k] - other.term[k]),
        }
    }
}

impl<const TERMS: usize> Mul for Jet<TERMS> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Jet {
            term: std::array::from_fn(|k| convolution(&self.term, &other.term, k, 0..=k)),
        }
    }
}

impl<const TERMS: usize> Div for Jet<TERMS> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let mut term = [0.0; TERMS];
        for k in 0..TERMS {
            let known = if k == 0 {
                0.0
            } else {
                convolution(&term, &other.term, k, 0..=k - 1)
            };
            term[k] = (self.term[k] - known) / other.term[0];
        }
        Jet { term }
    }
}

impl<const TERMS: usize> Number for Jet<TERMS> {
    fn same(self, value: f64) -> Self {
        Jet::constant(value)
    }

    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }

    /// From s' = c a' and c' = −s a'.
    fn sin(self) -> Self {
        let slope: [f64; TERMS] = std::array::from_fn(|k| k as f64 * self.term[k]);
        let (mut sine, mut cosine) = ([0.0; TERMS], [0.0; TERMS]);
        (sine[0], cosine[0]) = self.term[0].sin_cos();
        for k in 1..TERMS {
            sine[k] = convolution(&slope, &cosine, k, 1..=k) / k as f64;
            cosine[k] = -convolution(&slope, &sine, k, 1..=k) / k as f64;
        }
        Jet { term: sine }
    }

    /// From e' = e a'.
    fn exp(self) -> Self {
        let slope: [f64; TERMS] = std::array::from_fn(|k| k as f64 * self.term[k]);
        let mut term = [0.0; TERMS];
        term[0] = self.term[0].exp();
        for k in 1..TERMS {
            term[k] = convolution(&slope, &term, k, 1..=k) / k as f64;
        }
        Jet { term }
    }

    /// From r² = a.
    fn sqrt(self) -> Self {
        let mut term = [0.0; TERMS];
        term[0] = self.term[0].sqrt();
        for k in 1..TERMS {
            let known = convolution(&term, &term, k, 1..=k - 1);
            term[k] = (self.term[k] - known) / (2.0 * term[0]);
        }
        Jet { term }
    }

    /// Of a series that begins below 0, the negative.
    fn magnitude(self) -> Self {
        if self.term[0] < 0.0 {
            return Jet::constant(0.0) - self;
        }
        self
    }
}

impl Parameter for Dual {
    fn value(self) -> f64 {
        self.term[0]
    }

    fn is_nothing(self) -> bool {
        self.term == [0.0; 2]
    }

    fn with_value(self, value: f64) -> Dual {
        Dual::new(value, self.slope())
    }
}

impl ParameterOf<Dual> for Dual {
    fn lift(self, _like: Dual) -> Dual {
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quotient_is_the_geometric_series() {
        let one = Jet::<6>::constant(1.0);
        assert_eq!((one / (one - Jet::variable())).term, [1.0; 6]);
    }

    /// e^(0.3 + 2ε) against its derivatives; its root squared is itself.
    #[test]
    fn the_series_of_exponential_and_root_are_those_of_their_derivatives() {
        let two = Jet::<7>::constant(2.0);
        let power = (Jet::constant(0.3) + two * Jet::variable()).exp();
        let mut expected = 0.3_f64.exp();
        for (k, term) in power.term.into_iter().enumerate() {
            assert!((term - expected).abs() < 1e-15 * expected, "{k}");
            expected *= 2.0 / (k + 1) as f64;
        }
        let root = power.sqrt();
        for (square, term) in (root * root).term.into_iter().zip(power.term) {
            assert!((square - term).abs() < 1e-15 * term);
        }
    }

    /// sin(0.3 + 2ε) against its derivatives, and against 2 sin(a/2) cos(a/2)
    /// by multiplication.
    #[test]
    fn the_series_of_the_sine_is_that_of_its_derivatives() {
        let two = Jet::<7>::constant(2.0);
        let angle = Jet::constant(0.3) + two * Jet::variable();
        let (sine, cosine) = 0.3_f64.sin_cos();
        let cycle = [sine, cosine, -sine, -cosine];
        let mut factorial = 1.0;
        for (k, term) in angle.sin().term.into_iter().enumerate() {
            factorial *= (k as f64).max(1.0);
            let expected = 2.0_f64.powi(k as i32) * cycle[k % 4] / factorial;
            assert!((term - expected).abs() < 1e-15, "order {k}");
        }
    }

    #[test]
    fn a_product_and_a_quotient_undo_each_other() {
        let a = Jet {
            term: [0.7, -1.2, 0.4, 2.0, -0.1],
        };
        let b = Jet {
            term: [-1.5, 0.3, 0.9, -0.6, 1.1],
        };
        for (back, term) in (a * b / b).term.into_iter().zip(a.term) {
            assert!((back - term).abs() < 1e-14);
        }
    }
}
