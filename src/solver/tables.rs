//! Constant tables of Gauss–Legendre collocation, made by the compiler.
//!
//! Method: on u ∈ [−1, 1] the second derivative f is replaced by the polynomial
//! of degree 2P−1 through its values at the 2P Gauss–Legendre nodes, written in
//! Legendre polynomials, f = Σ a_k P_k with a_k = (2k+1)/2 Σ_m w_m P_k(u_m) f_m,
//! and integrated once and twice from u = −1 in closed form:
//!
//! ```text
//! ∫P_0 = P_1 + P_0          ∫P_k = (P_{k+1} − P_{k−1}) / (2k+1)
//! ```
//!
//! The nodes lie symmetrically, so f is split into the sum and the difference of
//! its values at +u and −u: sums meet even polynomials only, differences odd
//! ones, and four P×P matrices do the work of two of 2P×2P.
//!
//! Source: E. Hairer, S. P. Nørsett, G. Wanner, "Solving Ordinary Differential
//! Equations I", 2nd ed., section II.7. Accuracy: each entry is computed in
//! double-length arithmetic and rounded once.

use super::double_double::DoubleDouble;

/// Nodes of the largest method.
pub(super) const MOST_NODES: usize = 16;

/// Legendre polynomials at one point: degrees 0 to the number of nodes + 1.
pub(super) type Legendre = [DoubleDouble; MOST_NODES + 2];

/// A matrix by columns: column j multiplies the value at node pair j.
pub type Columns<const P: usize> = [[f64; P]; P];

/// The tables of the method of P node pairs ±u, that is 2P nodes. Rows belong to the node pairs,
/// columns to the sums f(u_j) + f(−u_j) or differences f(u_j) − f(−u_j).
#[derive(Debug)]
pub struct Tables<const P: usize> {
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
pub static GAUSS_16: Tables<8> = Tables::new();

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
pub static GAUSS_4: Unpaired = Unpaired::new(&Tables::new());

impl Unpaired {
    /// Rows i and i + 2 belong to u_i and −u_i, columns likewise.
    const fn new(pairs: &Tables<2>) -> Unpaired {
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

impl<const P: usize> Tables<P> {
    /// Number of nodes.
    const NODES: usize = 2 * P;

    const fn new() -> Tables<P> {
        let mut tables = Tables {
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
        let mut node = [DoubleDouble::ZERO; P];
        let mut at_node = [[DoubleDouble::ZERO; MOST_NODES + 2]; P];
        let mut i = 0;
        while i < P {
            node[i] = gauss_node(i, Self::NODES);
            at_node[i] = legendre(node[i]);
            tables.node[i] = node[i].value();
            i += 1;
        }
        let powers = legendre_powers();
        let mut j = 0;
        while j < P {
            // Row of a_k over sums or differences: (2k+1)/2 · w_j · P_k(u_j).
            let weight = gauss_weight(node[j], &at_node[j], Self::NODES);
            let mut share = [DoubleDouble::ZERO; MOST_NODES];
            let mut k = 0;
            while k < Self::NODES {
                share[k] = weight.mul(at_node[j][k]).scale(0.5 * (2 * k + 1) as f64);
                k += 1;
            }
            tables.mean[j] = share[0].value();
            tables.tilt[j] = share[1].div(DoubleDouble::new(3.0)).value();
            let mut i = 0;
            while i < P {
                let p = &at_node[i];
                tables.once_from_sums[j][i] = sum_once(&share, p, 0).value();
                tables.once_from_differences[j][i] = sum_once(&share, p, 1).value();
                tables.twice_from_sums[j][i] = sum_twice(&share, p, 0).value();
                tables.twice_from_differences[j][i] = sum_twice(&share, p, 1).value();
                tables.series_from_sums[j][i] = share[2 * i].value();
                tables.series_from_differences[j][i] = share[2 * i + 1].value();
                tables.powers_from_even[j][i] = integrated(powers[2 * j][2 * i], 2 * i);
                tables.powers_from_odd[j][i] = integrated(powers[2 * j + 1][2 * i + 1], 2 * i + 1);
                i += 1;
            }
            j += 1;
        }
        tables
    }
}

/// The integral of P_k from −1, without the constant of k = 0.
pub(super) const fn once(p: &Legendre, k: usize) -> DoubleDouble {
    if k == 0 {
        return p[1];
    }
    p[k + 1]
        .sub(p[k - 1])
        .div(DoubleDouble::new((2 * k + 1) as f64))
}

/// The twice repeated integral of P_k from −1, without the terms that the
/// caller adds by itself: u for k = 0 and the constant −1/3 for k = 1.
pub(super) const fn twice(p: &Legendre, k: usize) -> DoubleDouble {
    match k {
        // (u² + 1)/2, from (u + 1)²/2.
        0 => p[1].mul(p[1]).add(DoubleDouble::ONE).scale(0.5),
        // (∫P_2 − u)/3, from (∫P_2 − ∫P_0)/3.
        1 => once(p, 2).sub(p[1]).div(DoubleDouble::new(3.0)),
        _ => once(p, k + 1)
            .sub(once(p, k - 1))
            .div(DoubleDouble::new((2 * k + 1) as f64)),
    }
}

pub(super) const fn sum_once(
    share: &[DoubleDouble; MOST_NODES],
    p: &Legendre,
    parity: usize,
) -> DoubleDouble {
    let mut sum = DoubleDouble::ZERO;
    let mut k = parity;
    while k < MOST_NODES {
        sum = sum.add(share[k].mul(once(p, k)));
        k += 2;
    }
    sum
}

pub(super) const fn sum_twice(
    share: &[DoubleDouble; MOST_NODES],
    p: &Legendre,
    parity: usize,
) -> DoubleDouble {
    let mut sum = DoubleDouble::ZERO;
    let mut k = parity;
    while k < MOST_NODES {
        sum = sum.add(share[k].mul(twice(p, k)));
        k += 2;
    }
    sum
}

/// The factor of uᵖ⁺² in the twice integrated `coefficient`·uᵖ.
const fn integrated(coefficient: DoubleDouble, p: usize) -> f64 {
    coefficient
        .div(DoubleDouble::new(((p + 1) * (p + 2)) as f64))
        .value()
}

/// P_0 to P_n+1 at `u`, by Bonnet's recursion.
pub(super) const fn legendre(u: DoubleDouble) -> Legendre {
    let mut p = [DoubleDouble::ONE; MOST_NODES + 2];
    p[1] = u;
    let mut k = 1;
    while k < MOST_NODES + 1 {
        p[k + 1] = u
            .mul(p[k])
            .scale((2 * k + 1) as f64)
            .sub(p[k - 1].scale(k as f64))
            .div(DoubleDouble::new((k + 1) as f64));
        k += 1;
    }
    p
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

/// The derivative of P_n at `u`.
pub(super) const fn legendre_slope(u: DoubleDouble, p: &Legendre, n: usize) -> DoubleDouble {
    p[n - 1]
        .sub(u.mul(p[n]))
        .scale(n as f64)
        .div(DoubleDouble::ONE.sub(u.mul(u)))
}

/// The i-th positive zero of P_n, by Newton's method from Tricomi's estimate.
pub(super) const fn gauss_node(i: usize, n: usize) -> DoubleDouble {
    // cos(π(4k−1)/(4n+2)) for the k-th largest zero, by its power series.
    let k = n / 2 - i;
    let angle = std::f64::consts::PI * (4 * k - 1) as f64 / (4 * n + 2) as f64;
    let (mut term, mut cosine, mut m) = (1.0, 1.0, 0);
    while m < 12 {
        m += 1;
        term *= -angle * angle / ((2 * m - 1) * (2 * m)) as f64;
        cosine += term;
    }
    let mut u = DoubleDouble::new(cosine);
    let mut round = 0;
    while round < 6 {
        let p = legendre(u);
        u = u.sub(p[n].div(legendre_slope(u, &p, n)));
        round += 1;
    }
    u
}

/// The weight of a node: 2 / ((1 − u²) P'_n(u)²).
pub(super) const fn gauss_weight(u: DoubleDouble, p: &Legendre, n: usize) -> DoubleDouble {
    let slope = legendre_slope(u, p, n);
    DoubleDouble::new(2.0).div(DoubleDouble::ONE.sub(u.mul(u)).mul(slope.mul(slope)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f(u) = uⁿ: every table against the integral done by hand.
    #[test]
    fn powers_up_to_the_number_of_nodes_are_integrated_exactly() {
        check::<4>(&Tables::new());
        check(&GAUSS_16);
    }

    /// Unpaired nodes: f(u) = (1 + u)ⁿ, every table against the integral done by hand.
    #[test]
    fn unpaired_nodes_integrate_powers_exactly() {
        let Unpaired {
            place,
            once,
            twice,
            series,
            end,
        } = &GAUSS_4;
        for n in 0..4 {
            let values = place.map(|place| place.powi(n));
            let apply =
                |m: &Columns<4>, i: usize| -> f64 { (0..4).map(|j| m[j][i] * values[j]).sum() };
            let (order, next) = (f64::from(n + 1), f64::from(n + 2));
            for (i, place) in place.iter().enumerate() {
                let by_hand = place.powi(n + 1) / order;
                assert!((apply(once, i) - by_hand).abs() < 4e-15, "{n}");
                assert!(
                    (apply(twice, i) - by_hand * place / next).abs() < 4e-15,
                    "{n}"
                );
            }
            let last: f64 = (0..4).map(|k| apply(series, k)).sum();
            assert!((last - 2.0_f64.powi(n)).abs() < 4e-15, "{n}");
            let mean = 2.0_f64.powi(n) / order;
            assert!((apply(series, 0) - mean).abs() < 4e-15, "{n}");
            let [first, last] = [0.0_f64, 2.0].map(|place| place.powi(n));
            let by_hand = [4.0 * mean / next, 2.0 * mean, last, first];
            for (row, by_hand) in by_hand.into_iter().enumerate() {
                assert!((apply(end, row) - by_hand).abs() < 8e-15, "{n}, {row}");
            }
        }
    }

    fn check<const P: usize>(t: &Tables<P>) {
        for n in 0..2 * P as i32 {
            let even = n % 2 == 0;
            let values = t.node.map(|u| 2.0 * u.powi(n));
            let dot = |row: &[f64; P]| -> f64 { row.iter().zip(values).map(|(a, b)| a * b).sum() };
            let apply =
                |m: &Columns<P>, i: usize| -> f64 { (0..P).map(|j| m[j][i] * values[j]).sum() };
            let expand = |powers: &Columns<P>, series: &Columns<P>, i: usize| -> f64 {
                (0..P).map(|k| powers[k][i] * apply(series, k)).sum()
            };
            let order = f64::from(n + 1);
            let next = f64::from(n + 2);
            if even {
                assert!((dot(&t.mean) - 1.0 / order).abs() < 4e-16, "mean of u^{n}");
            } else {
                assert!((dot(&t.tilt) - 1.0 / next).abs() < 4e-16, "tilt of u^{n}");
            }
            for (i, &u) in t.node.iter().enumerate() {
                let power = if even { n / 2 } else { (n - 1) / 2 } as usize;
                let own = |k: usize| {
                    if k == power {
                        1.0 / (order * next)
                    } else {
                        0.0
                    }
                };
                if even {
                    let once = u.powi(n + 1) / order;
                    assert!((apply(&t.once_from_sums, i) - once).abs() < 1e-15, "u^{n}");
                    // (uⁿ⁺² − 1)/((n+1)(n+2)) + 1/(n+1), without u/(n+1).
                    let twice = (u.powi(n + 2) - 1.0) / (order * next) + 1.0 / order;
                    assert!(
                        (apply(&t.twice_from_sums, i) - twice).abs() < 1e-15,
                        "u^{n}"
                    );
                    let found = expand(&t.powers_from_even, &t.series_from_sums, i);
                    assert!((found - own(i)).abs() < 1e-11, "power {i} of u^{n}");
                } else {
                    let once = (u.powi(n + 1) - 1.0) / order;
                    let found = apply(&t.once_from_differences, i);
                    assert!((found - once).abs() < 1e-15, "u^{n}");
                    // uⁿ⁺²/((n+1)(n+2)) − u/(n+1), without the constant.
                    let twice = u.powi(n + 2) / (order * next) - u / order;
                    let found = apply(&t.twice_from_differences, i);
                    assert!((found - twice).abs() < 1e-15, "u^{n}");
                    let found = expand(&t.powers_from_odd, &t.series_from_differences, i);
                    assert!((found - own(i)).abs() < 1e-11, "power {i} of u^{n}");
                }
            }
        }
    }
}
