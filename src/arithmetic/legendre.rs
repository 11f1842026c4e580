//! Sums of Legendre polynomials.

use super::number::Number;

/// Σ a_k P_k(u) over the degrees k below `terms`, by C. W. Clenshaw's summation (Math. Comp. 9 (1955)
/// 118–120).
#[inline(always)]
pub fn sum<N: Number>(u: N, terms: usize, coefficient: impl Fn(usize) -> N) -> N {
    let number = |value: f64| u.same(value);
    let (mut next, mut after) = (number(0.0), number(0.0));
    for degree in (0..terms).rev() {
        let k = degree as f64;
        let rise = u * number((2.0 * k + 1.0) / (k + 1.0));
        let fall = number(-(k + 1.0) / (k + 2.0));
        let sum = rise.mul_add(next, after.mul_add(fall, coefficient(degree)));
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
