//! Sums of Legendre polynomials.

use std::hint::black_box;

use super::number::Number;

/// The most terms of a sum.
pub const MOST_TERMS: usize = 17;

/// For each degree k what Clenshaw's recurrence takes from the two sums before: (2k + 1)/(k + 1), times u, of
/// the last one, and −(k + 1)/(k + 2) of the other.
static RECURRENCE: [[f64; 2]; MOST_TERMS] = {
    let mut factors = [[0.0; 2]; MOST_TERMS];
    let mut degree = 0;
    while degree < MOST_TERMS {
        let k = degree as f64;
        factors[degree] = [(2.0 * k + 1.0) / (k + 1.0), -(k + 1.0) / (k + 2.0)];
        degree += 1;
    }
    factors
};

/// Σ a_k P_k(u) over the degrees k below `terms`, which are [`MOST_TERMS`] at most, by C. W. Clenshaw's
/// summation (Math. Comp. 9 (1955) 118–120).
#[inline(always)]
pub fn sum<N: Number>(u: N, terms: usize, coefficient: impl Fn(usize) -> N) -> N {
    let number = |value: f64| u.same(value);
    let (mut next, mut after) = (number(0.0), number(0.0));
    // Unrolled it would be large and no faster: each sum waits for the one before.
    for degree in (0..black_box(terms).min(MOST_TERMS)).rev() {
        let [rise, fall] = RECURRENCE[degree];
        let other = after.mul_add(number(fall), coefficient(degree));
        let sum = (u * number(rise)).mul_add(next, other);
        (next, after) = (sum, next);
    }
    next
}

#[cfg(test)]
mod tests {
    use super::*;

    /// P_0 to P_4 as they stand in the books.
    #[test]
    fn the_sum_is_that_of_the_polynomials() {
        let a = [3.0, -2.0, 0.5, 4.0, 1.5];
        for u in [-1.0_f64, -0.3, 0.0, 0.8, 1.7] {
            let p = [
                1.0,
                u,
                (3.0 * u * u - 1.0) / 2.0,
                (5.0 * u.powi(3) - 3.0 * u) / 2.0,
                (35.0 * u.powi(4) - 30.0 * u * u + 3.0) / 8.0,
            ];
            let exact: f64 = a.iter().zip(p).map(|(a, p)| a * p).sum();
            assert!((sum(u, a.len(), |k| a[k]) - exact).abs() < 1e-13);
        }
    }
}
