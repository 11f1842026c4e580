//! Gauss nodes in pairs ±u. f is split into the sum and the difference of its values at +u and −u:
//! sums meet even polynomials only, differences odd ones, and four P×P matrices do the work of two
//! of 2P×2P.

use super::{Columns, DoubleDouble, Exact, MOST_NODES};

/// The tables of the method of P node pairs ±u, that is 2P nodes. Rows belong to the node pairs,
/// columns to the sums f(u_j) + f(−u_j) or differences f(u_j) − f(−u_j).
#[derive(Debug)]
pub struct Pairs<const P: usize> {
    /// The positive nodes u_i, increasing.
    pub node: [f64; P],
    /// Row of a_0, the mean of f: from sums.
    pub mean: [f64; P],
    /// Row of a_1/3: from differences.
    pub tilt: [f64; P],
    /// Odd part of the once integrated f, from sums.
    pub once_from_sums: Columns<P>,
    /// Even part of the once integrated f without its mean, from differences.
    pub once_from_differences: Columns<P>,
    /// Even part of the twice integrated f, from sums.
    pub twice_from_sums: Columns<P>,
    /// Odd part of the twice integrated f without u·mean, from differences.
    pub twice_from_differences: Columns<P>,
    /// Legendre coefficients a_0, a_2, …, a_2P−2, from sums.
    pub series_from_sums: Columns<P>,
    /// Legendre coefficients a_1, a_3, …, a_2P−1, from differences.
    pub series_from_differences: Columns<P>,
    /// Coefficients of u², u⁴, …, u²ᴾ of the twice integrated f: column k
    /// multiplies a_2k. Not taken from the sums directly, since the entries
    /// (up to 1e5) would magnify rounding that a decaying series does not have.
    pub powers_from_even: Columns<P>,
    /// Coefficients of u³, u⁵, …, u²ᴾ⁺¹: column k multiplies a_2k+1.
    pub powers_from_odd: Columns<P>,
}

/// The tables of the method of 16 nodes.
pub static PAIRED_16: Pairs<8> = Pairs::of(&Exact::<16>::gauss());

/// The tables of the method of 4 nodes ±u, unpaired: columns belong to the values of f in the nodes.
#[derive(Debug)]
pub struct Unpaired {
    /// 1 + u_i.
    pub place: [f64; 4],
    /// The once integrated f.
    pub once: Columns<4>,
    /// The twice integrated f.
    pub twice: Columns<4>,
    /// Legendre coefficients a_0 to a_3.
    pub series: Columns<4>,
    /// The twice and the once integrated f at the end, f itself at the end and at the begin.
    pub end: Columns<4>,
}

/// The tables of the method of 4 nodes.
pub static GAUSS_4: Unpaired = Unpaired::new(&Pairs::of(&Exact::<4>::gauss()));
impl Unpaired {
    /// Rows i and i + 2 belong to u_i and −u_i, columns likewise.
    const fn new(pairs: &Pairs<2>) -> Unpaired {
        const SIGN: [f64; 4] = [1.0, 1.0, -1.0, -1.0];
        let mut unpaired = Unpaired {
            place: [0.0; 4],
            once: [[0.0; 4]; 4],
            twice: [[0.0; 4]; 4],
            series: [[0.0; 4]; 4],
            end: [[0.0; 4]; 4],
        };
        let mut row = 0;
        while row < 4 {
            let i = row % 2;
            let u = SIGN[row] * pairs.node[i];
            unpaired.place[row] = 1.0 + u;
            let mut column = 0;
            while column < 4 {
                let j = column % 2;
                unpaired.once[column][row] = pairs.mean[j]
                    + SIGN[row] * pairs.once_from_sums[j][i]
                    + SIGN[column] * pairs.once_from_differences[j][i];
                unpaired.twice[column][row] = pairs.twice_from_sums[j][i]
                    + u * pairs.mean[j]
                    + SIGN[column]
                        * (SIGN[row] * pairs.twice_from_differences[j][i] - pairs.tilt[j]);
                unpaired.series[column][2 * i] = pairs.series_from_sums[j][i];
                unpaired.series[column][2 * i + 1] =
                    SIGN[column] * pairs.series_from_differences[j][i];
                column += 1;
            }
            row += 1;
        }
        let mut column = 0;
        while column < 4 {
            // Legendre polynomials are 1 at the end, and 1 or −1 at the begin.
            let [zeroth, first, second, third] = unpaired.series[column];
            unpaired.end[column] = [
                2.0 * (zeroth - first / 3.0),
                2.0 * zeroth,
                (zeroth + second) + (first + third),
                (zeroth + second) - (first + third),
            ];
            column += 1;
        }
        unpaired
    }
}

impl<const P: usize> Pairs<P> {
    const fn of<const N: usize>(exact: &Exact<N>) -> Pairs<P> {
        let mut pairs = Pairs {
            node: [0.0; P],
            mean: [0.0; P],
            tilt: [0.0; P],
            once_from_sums: [[0.0; P]; P],
            once_from_differences: [[0.0; P]; P],
            twice_from_sums: [[0.0; P]; P],
            twice_from_differences: [[0.0; P]; P],
            series_from_sums: [[0.0; P]; P],
            series_from_differences: [[0.0; P]; P],
            powers_from_even: [[0.0; P]; P],
            powers_from_odd: [[0.0; P]; P],
        };
        let powers = legendre_powers();
        let mut j = 0;
        while j < P {
            let [low, high] = [P - 1 - j, P + j];
            let node = exact.node[high];
            pairs.node[j] = node.value();
            let mean = exact.series[high][0];
            let tilt = exact.series[high][1].div(DoubleDouble::new(3.0));
            (pairs.mean[j], pairs.tilt[j]) = (mean.value(), tilt.value());
            let mut i = 0;
            while i < P {
                let at = P + i;
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
    use super::super::{GAUSS_16, Rule};
    use super::*;

    fn apply<const N: usize>(matrix: &Columns<N>, values: &[f64; N], row: usize) -> f64 {
        (0..N).map(|j| matrix[j][row] * values[j]).sum()
    }

    fn wave<const N: usize>() -> [f64; N] {
        std::array::from_fn(|k| (1.7 * k as f64).sin())
    }

    #[test]
    fn pairs_integrate_as_the_nodes_one_by_one_do() {
        let t = &PAIRED_16;
        let f = wave::<16>();
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

    #[test]
    fn four_unpaired_nodes_integrate_as_those_that_increase_do() {
        let rule = Rule::of(&Exact::<4>::gauss());
        let increasing = wave::<4>();
        let at = [2, 3, 1, 0];
        let f = at.map(|place| increasing[place]);
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-15, "{a} {b}");
        for (row, place) in at.into_iter().enumerate() {
            close(GAUSS_4.place[row], rule.place[place]);
            close(
                apply(&GAUSS_4.once, &f, row),
                apply(&rule.once, &increasing, place),
            );
            close(
                apply(&GAUSS_4.twice, &f, row),
                apply(&rule.twice, &increasing, place),
            );
        }
        let series: [f64; 4] = std::array::from_fn(|k| apply(&rule.series, &increasing, k));
        for (k, term) in series.into_iter().enumerate() {
            close(apply(&GAUSS_4.series, &f, k), term);
        }
        let [zeroth, first, second, third] = series;
        close(apply(&GAUSS_4.end, &f, 0), 2.0 * (zeroth - first / 3.0));
        close(apply(&GAUSS_4.end, &f, 1), 2.0 * zeroth);
        close(apply(&GAUSS_4.end, &f, 2), zeroth + second + first + third);
        close(apply(&GAUSS_4.end, &f, 3), zeroth + second - first - third);
    }
}
