//! Double-double arithmetic: an unevaluated sum of two `f64`, about 32 digits.
//!
//! Origin: T. J. Dekker, "A floating-point technique for extending the
//! available precision", Numer. Math. 18 (1971) 224–242; the sums are Knuth's.
//! Everything is `const`, so that the tables of the collocation method are
//! made by the compiler, and the clock uses the same type at run time.
//!
//! Accuracy: relative error below 1e-30 for sums of equal sign, products and
//! quotients. Range: products of numbers above about 1e300 overflow in the
//! splitting; neither use comes near.

use serde::{Deserialize, Serialize};

/// A double-double number `high + low`. After all operations but [`DoubleDouble::plus`], `low`
/// is at most half an ulp of `high`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DoubleDouble {
    /// About the number rounded to `f64`.
    pub high: f64,
    /// The rest.
    pub low: f64,
}

impl DoubleDouble {
    /// Zero.
    pub const ZERO: DoubleDouble = DoubleDouble::new(0.0);
    /// One.
    pub const ONE: DoubleDouble = DoubleDouble::new(1.0);

    /// Whether it is finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.value().is_finite()
    }

    /// The number `value`, exactly.
    #[must_use]
    #[inline]
    pub const fn new(value: f64) -> DoubleDouble {
        DoubleDouble {
            high: value,
            low: 0.0,
        }
    }

    /// `self + other`.
    #[must_use]
    #[inline]
    pub const fn add(self, other: DoubleDouble) -> DoubleDouble {
        // The processor predicts the branch. The sums below depend on one another.
        if other.high == 0.0 && other.low == 0.0 {
            return self;
        }
        let sum = exact_sum(self.high, other.high);
        let tail = exact_sum(self.low, other.low);
        let head = exact_sum(sum.high, sum.low + tail.high);
        let DoubleDouble { high, low } = head;
        exact_sum(high, low + tail.low)
    }

    /// `self + addend`, for a clock: each sum waits for a single operation of the last one.
    /// What the roundings lose adds up in `low`; see [`DoubleDouble::renormalized`].
    #[must_use]
    #[inline]
    pub const fn plus(self, addend: f64) -> DoubleDouble {
        let sum = exact_sum(self.high, addend);
        DoubleDouble {
            high: sum.high,
            low: sum.low + self.low,
        }
    }

    /// Renormalizes: moves as much as possible into `high` and keeps the value. After thousands of
    /// [`DoubleDouble::plus`] the roundings of a grown `low` might be seen.
    #[must_use]
    #[inline]
    pub const fn renormalized(self) -> DoubleDouble {
        exact_sum(self.high, self.low)
    }

    /// `self − other`, rounded to `f64`: accurate also where the two are close.
    #[must_use]
    #[inline]
    pub const fn since(self, other: DoubleDouble) -> f64 {
        // One half after the other. Both in one register would be loaded together, and that load
        // waits until two stores of single numbers have ended (store forwarding).
        ((self.high - other.high) + self.low) - other.low
    }

    /// `self − other`.
    #[must_use]
    #[inline]
    pub const fn sub(self, other: DoubleDouble) -> DoubleDouble {
        self.add(DoubleDouble {
            high: -other.high,
            low: -other.low,
        })
    }

    /// `self · other`.
    #[must_use]
    #[inline]
    pub const fn mul(self, other: DoubleDouble) -> DoubleDouble {
        let product = exact_product(self.high, other.high);
        let cross = self.high * other.low + self.low * other.high;
        exact_sum(product.high, product.low + cross)
    }

    /// `self / other`.
    #[must_use]
    pub const fn div(self, other: DoubleDouble) -> DoubleDouble {
        let first = self.high / other.high;
        let rest = self.sub(other.mul(DoubleDouble::new(first)));
        let second = rest.high / other.high;
        let rest = rest.sub(other.mul(DoubleDouble::new(second)));
        exact_sum(first, second).add(DoubleDouble::new(rest.high / other.high))
    }

    /// `self · factor`.
    #[must_use]
    pub const fn scale(self, factor: f64) -> DoubleDouble {
        self.mul(DoubleDouble::new(factor))
    }

    /// `value · count` of a whole number up to 256: nothing is rounded.
    #[must_use]
    #[inline]
    pub const fn times(value: f64, count: f64) -> DoubleDouble {
        // Of 45 and of 8 bits.
        let high = f64::from_bits(value.to_bits() & !0xff);
        exact_sum(high * count, (value - high) * count)
    }

    /// `self · factor` of a power of 2, of either sign: nothing is rounded.
    #[must_use]
    #[inline]
    pub const fn scale_exactly(self, factor: f64) -> DoubleDouble {
        DoubleDouble {
            high: self.high * factor,
            low: self.low * factor,
        }
    }

    /// The square root of a number above 0: that of `f64` and one step of Newton's method.
    #[must_use]
    pub fn sqrt(self) -> DoubleDouble {
        let root = DoubleDouble::new(self.value().sqrt());
        let rest = self.sub(root.mul(root));
        root.add(rest.div(root.scale(2.0)))
    }

    /// The number rounded to `f64`.
    #[must_use]
    #[inline]
    pub const fn value(self) -> f64 {
        self.high + self.low
    }
}

/// `a + b` without error (Knuth).
#[inline]
const fn exact_sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    let shadow = high - a;
    DoubleDouble {
        high,
        low: (a - (high - shadow)) + (b - shadow),
    }
}

/// `a · b` without error (Dekker; not by fused multiply-add, which is neither
/// `const` nor fast on every processor).
const fn exact_product(a: f64, b: f64) -> DoubleDouble {
    let high = a * b;
    let [a_high, a_low] = veltkamp_split(a);
    let [b_high, b_low] = veltkamp_split(b);
    let low = ((a_high * b_high - high) + a_high * b_low + a_low * b_high) + a_low * b_low;
    DoubleDouble { high, low }
}

/// `a` as a sum of two numbers of 26 bits, the larger one first (Veltkamp).
pub(crate) const fn veltkamp_split(a: f64) -> [f64; 2] {
    const FACTOR: f64 = 134_217_729.0; // 2^27 + 1
    let scaled = FACTOR * a;
    let high = scaled - (scaled - a);
    [high, a - high]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_times_three_is_one_to_thirty_digits() {
        let third = DoubleDouble::ONE.div(DoubleDouble::new(3.0));
        let rest = third.scale(3.0).sub(DoubleDouble::ONE);
        assert!(rest.value().abs() < 1e-31, "{rest:?}");
    }

    #[test]
    fn a_root_squared_is_the_number_to_thirty_digits() {
        let root = DoubleDouble::new(2.0).sqrt();
        let rest = root.mul(root).sub(DoubleDouble::new(2.0));
        assert!(rest.value().abs() < 1e-31, "{rest:?}");
    }

    #[test]
    fn a_few_times_a_number_is_exact() {
        for (value, count) in [(0.1, 7.0), (1.0 / 3.0, 16.0), (1e200, 255.0), (-12.7, 1.0)] {
            let exact = DoubleDouble::new(value).scale(count);
            assert_eq!(DoubleDouble::times(value, count), exact);
        }
    }

    #[test]
    fn a_sum_keeps_what_f64_loses() {
        let sum = DoubleDouble::new(1e9).add(DoubleDouble::new(1e-9));
        assert_eq!(sum.sub(DoubleDouble::new(1e9)).value(), 1e-9);
    }

    #[test]
    fn a_clock_keeps_what_a_million_steps_lose() {
        for (start, step) in [(0.0, 0.1), (1e9, 1e-3), (1e9, 1e-9)] {
            let mut clock = DoubleDouble::new(start);
            for _ in 0..1_000 {
                clock = (0..1_000).fold(clock, |clock, _| clock.plus(step));
                clock = clock.renormalized();
            }
            let exact = DoubleDouble::new(start).add(DoubleDouble::new(step).scale(1e6));
            let error = clock.since(exact);
            assert!(error.abs() < 1e-15, "{start} + 1e6 · {step}: {error}");
        }
    }

    #[test]
    fn a_difference_of_close_numbers_is_accurate() {
        let late = DoubleDouble::new(1e9).plus(0.1).plus(1e-9);
        let difference = late.since(DoubleDouble::new(1e9).plus(0.1));
        assert!((difference - 1e-9).abs() < 1e-23, "{difference:e}");
    }

    #[test]
    fn a_product_is_exact_in_both_halves() {
        let x = 1.0 + f64::EPSILON;
        let square = DoubleDouble::new(x).mul(DoubleDouble::new(x));
        assert_eq!(square.high, 1.0 + 2.0 * f64::EPSILON);
        assert_eq!(square.low, f64::EPSILON * f64::EPSILON);
    }
}
