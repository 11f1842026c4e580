//! An input of the host as a function of time.

use serde::{Deserialize, Serialize};

use crate::solver::number::Number;

/// Derivatives of an input that are taken into account: orders 1 to 4.
pub const HIGHEST_DERIVATIVE: usize = 4;

/// An input from the time at which it was set: Σ `term[k]` sᵏ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Polynomial {
    pub(super) term: [f64; HIGHEST_DERIVATIVE + 1],
}

impl Polynomial {
    /// A constant input.
    #[must_use]
    pub const fn constant(value: f64) -> Polynomial {
        let mut term = [0.0; HIGHEST_DERIVATIVE + 1];
        term[0] = value;
        Polynomial { term }
    }

    /// The input with its value replaced.
    #[inline]
    pub fn set_value(&mut self, value: f64) {
        self.term[0] = value;
    }

    /// This input with its value replaced and its derivatives kept.
    #[must_use]
    pub fn with_value(mut self, value: f64) -> Polynomial {
        self.set_value(value);
        self
    }

    /// The input with its derivative of `order` 1 to 4 replaced.
    pub fn set_derivative(&mut self, order: usize, value: f64) {
        let factorial: f64 = (1..=order).map(|k| k as f64).product();
        self.term[order] = value / factorial;
    }

    /// Whether it is a polynomial in finite numbers.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.term.iter().all(|term| term.is_finite())
    }

    /// Whether the input keeps its value.
    #[must_use]
    #[inline(always)]
    pub fn is_constant(&self) -> bool {
        // Without a branch for each; the shift drops the sign of −0.
        let bits = |sum, term: &f64| sum | term.to_bits();
        self.term[1..].iter().fold(0, bits) << 1 == 0
    }

    /// Whether the input is of this degree at most.
    #[inline(always)]
    pub(super) fn is_of_degree(&self, degree: usize) -> bool {
        self.term[degree + 1..].iter().all(|term| *term == 0.0)
    }

    /// Moves the time from which its own counts by `shift`.
    #[inline(always)]
    pub fn shift(&mut self, shift: f64) {
        if self.is_constant() {
            return;
        }
        // Repeated synthetic division by (s − shift).
        for low in 0..HIGHEST_DERIVATIVE {
            for k in (low..HIGHEST_DERIVATIVE).rev() {
                self.term[k] += shift * self.term[k + 1];
            }
        }
    }

    /// The value at the time at which the input was set.
    #[must_use]
    #[inline]
    pub fn value(&self) -> f64 {
        self.term[0]
    }

    /// The value at `offset` later.
    #[inline(always)]
    pub fn at<N: Number>(&self, offset: N) -> N {
        let term = |k: usize| offset.same(self.term[k]);
        let mut sum = term(HIGHEST_DERIVATIVE);
        for k in (0..HIGHEST_DERIVATIVE).rev() {
            sum = sum.mul_add(offset, term(k));
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shifted_input_is_the_same_function() {
        let mut input = Polynomial::constant(0.5);
        for (order, value) in [(1, 0.2), (2, -0.3), (3, 0.7), (4, 1.1)] {
            input.set_derivative(order, value);
        }
        let s: f64 = 0.4;
        let direct = 0.5 + 0.2 * s - 0.15 * s * s + 0.7 / 6.0 * s.powi(3) + 1.1 / 24.0 * s.powi(4);
        assert!((input.at(s) - direct).abs() < 1e-15);
        input.shift(0.3);
        assert!((input.at(0.1) - direct).abs() < 1e-15);
    }
}
