//! Gauss nodes in pairs ±u. f is split into the sum and the difference of its values at +u and −u:
//! sums meet even polynomials only, differences odd ones, and four P×P matrices do the work of two
//! of 2P×2P.

use super::{Columns, DoubleDouble, Exact, MOST_NODES};

/// The number of pairs.
pub const PAIRS: usize = 8;

/// The tables of the method of 16 nodes, P = 8 pairs. Rows belong to the node pairs,
/// columns to the sums f(u_j) + f(−u_j) or differences f(u_j) − f(−u_j).
#[derive(Debug)]
pub struct Pairs {
    /// The positive nodes u_i, increasing.
    pub node: [f64; PAIRS],
    /// Row of a_0, the mean of f: from sums.
    pub mean: [f64; PAIRS],
    /// Row of a_1/3: from differences.
    pub tilt: [f64; PAIRS],
    /// Odd part of the once integrated f, from sums.
    pub once_from_sums: Columns<PAIRS>,
    /// Even part of the once integrated f without its mean, from differences.
    pub once_from_differences: Columns<PAIRS>,
    /// Even part of the twice integrated f, from sums.
    pub twice_from_sums: Columns<PAIRS>,
    /// Odd part of the twice integrated f without u·mean, from differences.
    pub twice_from_differences: Columns<PAIRS>,
    /// Legendre coefficients a_0, a_2, …, a_2P−2, from sums.
    pub series_from_sums: Columns<PAIRS>,
    /// Legendre coefficients a_1, a_3, …, a_2P−1, from differences.
    pub series_from_differences: Columns<PAIRS>,
    /// Coefficients of u², u⁴, …, u²ᴾ of the twice integrated f: column k
    /// multiplies a_2k. Not taken from the sums directly, since the entries
    /// (up to 1e5) would magnify rounding that a decaying series does not have.
    pub powers_from_even: Columns<PAIRS>,
    /// Coefficients of u³, u⁵, …, u²ᴾ⁺¹: column k multiplies a_2k+1.
    pub powers_from_odd: Columns<PAIRS>,
}

/// The tables of the method of 16 nodes.
pub static PAIRED_16: Pairs = Pairs::of(&Exact::gauss());

impl Pairs {
    const fn of(exact: &Exact<{ 2 * PAIRS }>) -> Pairs {
        let mut pairs = Pairs {
            node: [0.0; PAIRS],
            mean: [0.0; PAIRS],
            tilt: [0.0; PAIRS],
            once_from_sums: [[0.0; PAIRS]; PAIRS],
            once_from_differences: [[0.0; PAIRS]; PAIRS],
            twice_from_sums: [[0.0; PAIRS]; PAIRS],
            twice_from_differences: [[0.0; PAIRS]; PAIRS],
            series_from_sums: [[0.0; PAIRS]; PAIRS],
            series_from_differences: [[0.0; PAIRS]; PAIRS],
            powers_from_even: [[0.0; PAIRS]; PAIRS],
            powers_from_odd: [[0.0; PAIRS]; PAIRS],
        };
        let powers = legendre_powers();
        let mut j = 0;
        while j < PAIRS {
            let [low, high] = [PAIRS - 1 - j, PAIRS + j];
            let node = exact.node[high];
            pairs.node[j] = node.value();
            let mean = exact.series[high][0];
            let tilt = exact.series[high][1].div(DoubleDouble::new(3.0));
            (pairs.mean[j], pairs.tilt[j]) = (mean.value(), tilt.value());
            let mut i = 0;
            while i < PAIRS {
                let at = PAIRS + i;
                let [sums, differences] = parts(exact.once[high][at], exact.once[low][at]);
                pairs.once_from_sums[j][i] = sums.sub(mean).value();
                pairs.once_from_differences[j][i] = differences.value();
                let [sums, differences] = parts(exact.twice[high][at], exact.twice[low][at]);
                pairs.twice_from_sums[j][i] = sums.sub(mean.mul(exact.node[at])).value();
                pairs.twice_from_differences[j][i] = differences.add(tilt).value();
                pairs.series_from_sums[j][i] = exact.series[high][2 * i].value();
                pairs.series_from_differences[j][i] = exact.series[high][2 * i + 1].value();
                pairs.powers_from_even[j][i] = integrated(powers[2 * j][2 * i], 2 * i);
                pairs.powers_from_odd[j][i] = integrated(powers[2 * j + 1][2 * i + 1], 2 * i + 1);
                i += 1;
            }
            j += 1;
        }
        pairs
    }
}

/// What multiplies the sum and the difference of two values, where `own` and `other` multiply the
/// values.
const fn parts(own: DoubleDouble, other: DoubleDouble) -> [DoubleDouble; 2] {
    [own.add(other).scale(0.5), own.sub(other).scale(0.5)]
}

/// The factor of uᵖ⁺² in the twice integrated `coefficient`·uᵖ.
const fn integrated(coefficient: DoubleDouble, p: usize) -> f64 {
    coefficient
        .div(DoubleDouble::new(((p + 1) * (p + 2)) as f64))
        .value()
}

/// `[k][m]`: the coefficient of u^m in P_k.
const fn legendre_powers() -> [[DoubleDouble; MOST_NODES]; MOST_NODES] {
    let mut c = [[DoubleDouble::ZERO; MOST_NODES]; MOST_NODES];
    c[0][0] = DoubleDouble::ONE;
    c[1][1] = DoubleDouble::ONE;
    let mut k = 1;
    while k + 1 < MOST_NODES {
        let divisor = DoubleDouble::new((k + 1) as f64);
        let mut m = 0;
        while m <= k + 1 {
            let lifted = if m == 0 {
                DoubleDouble::ZERO
            } else {
                c[k][m - 1]
            };
            c[k + 1][m] = lifted
                .scale((2 * k + 1) as f64)
                .sub(c[k - 1][m].scale(k as f64))
                .div(divisor);
            m += 1;
        }
        k += 1;
    }
    c
}

#[cfg(test)]
mod tests {
    use super::super::GAUSS_16;
    use super::*;

    fn apply<const N: usize>(matrix: &Columns<N>, values: &[f64; N], row: usize) -> f64 {
        (0..N).map(|j| matrix[j][row] * values[j]).sum()
    }

    #[test]
    fn pairs_integrate_as_the_nodes_one_by_one_do() {
        let t = &PAIRED_16;
        let f: [f64; 16] = std::array::from_fn(|k| (1.7 * k as f64).sin());
        let sums: [f64; 8] = std::array::from_fn(|j| f[8 + j] + f[7 - j]);
        let differences: [f64; 8] = std::array::from_fn(|j| f[8 + j] - f[7 - j]);
        let dot = |row: &[f64; 8], values: &[f64; 8]| -> f64 {
            row.iter().zip(values).map(|(a, b)| a * b).sum()
        };
        let [mean, tilt] = [dot(&t.mean, &sums), dot(&t.tilt, &differences)];
        let even: [f64; 8] = std::array::from_fn(|i| apply(&t.series_from_sums, &sums, i));
        let odd = std::array::from_fn(|i| apply(&t.series_from_differences, &differences, i));
        for (i, at, sign) in (0..8).flat_map(|i| [(i, 8 + i, 1.0), (i, 7 - i, -1.0)]) {
            let u = sign * t.node[i];
            assert!((1.0 + u - GAUSS_16.place[at]).abs() < 1e-15);
            let once = mean
                + sign * apply(&t.once_from_sums, &sums, i)
                + apply(&t.once_from_differences, &differences, i);
            assert!((once - apply(&GAUSS_16.once, &f, at)).abs() < 1e-15);
            let twice = apply(&t.twice_from_sums, &sums, i) + u * mean - tilt
                + sign * apply(&t.twice_from_differences, &differences, i);
            assert!((twice - apply(&GAUSS_16.twice, &f, at)).abs() < 1e-15);
            // The polynomial of the twice integrated f, but for its first two terms.
            let powers = |u: f64| -> f64 {
                let terms = (0..8).map(|k| {
                    let even = apply(&t.powers_from_even, &even, k);
                    let odd = apply(&t.powers_from_odd, &odd, k);
                    (even + u * odd) * u.powi(2 * k as i32 + 2)
                });
                terms.sum()
            };
            let slope = (1..=8).fold(0.0, |sum, k| {
                let [even, odd] = [
                    apply(&t.powers_from_even, &even, k - 1),
                    apply(&t.powers_from_odd, &odd, k - 1),
                ];
                sum + 2.0 * k as f64 * even - (2.0 * k as f64 + 1.0) * odd
            });
            let whole = powers(u) - powers(-1.0) + slope * (u + 1.0);
            assert!((twice - whole).abs() < 1e-12, "{twice} {whole}");
        }
        for k in 0..8 {
            assert!((even[k] - apply(&GAUSS_16.series, &f, 2 * k)).abs() < 1e-15);
            assert!((odd[k] - apply(&GAUSS_16.series, &f, 2 * k + 1)).abs() < 1e-15);
        }
    }
}
