//! Constant tables of Gauss–Legendre collocation, made by the compiler.
//!
//! Method: on u ∈ [−1, 1] the second derivative f is replaced by the polynomial
//! of degree 15 through its values at the 16 Gauss–Legendre nodes, written in
//! Legendre polynomials, f = Σ a_k P_k with a_k = (2k+1)/2 Σ_m w_m P_k(u_m) f_m,
//! and integrated once and twice from u = −1 in closed form:
//!
//! ```text
//! ∫P_0 = P_1 + P_0          ∫P_k = (P_{k+1} − P_{k−1}) / (2k+1)
//! ```
//!
//! The nodes lie symmetrically, so f is split into the sum and the difference of
//! its values at +u and −u: sums meet even polynomials only, differences odd
//! ones, and four 8×8 matrices do the work of two of 16×16.
//!
//! Source: E. Hairer, S. P. Nørsett, G. Wanner, "Solving Ordinary Differential
//! Equations I", 2nd ed., section II.7. Accuracy: each entry is computed in
//! double-length arithmetic and rounded once.

use super::double::Double;

/// Number of node pairs ±u; the method has twice as many nodes.
pub const PAIRS: usize = 8;

const NODES: usize = 2 * PAIRS;

/// Legendre polynomials needed at one point: degrees 0 to `NODES + 1`.
type Legendre = [Double; NODES + 2];

/// A matrix by columns: column j multiplies the value at node pair j.
pub type Columns = [[f64; PAIRS]; PAIRS];

/// The tables of the method of 16 nodes. Rows belong to the node pairs,
/// columns to the sums f(u_j) + f(−u_j) or differences f(u_j) − f(−u_j).
#[derive(Debug)]
pub struct Tables {
    /// The positive nodes u_i, increasing.
    pub node: [f64; PAIRS],
    /// Row of a_0, the mean of f: from sums.
    pub mean: [f64; PAIRS],
    /// Row of a_1/3: from differences.
    pub tilt: [f64; PAIRS],
    /// Odd part of the once integrated f, from sums.
    pub once_from_sums: Columns,
    /// Even part of the once integrated f without its mean, from differences.
    pub once_from_differences: Columns,
    /// Even part of the twice integrated f, from sums.
    pub twice_from_sums: Columns,
    /// Odd part of the twice integrated f without u·mean, from differences.
    pub twice_from_differences: Columns,
    /// Legendre coefficients a_0, a_2, …, a_14, from sums.
    pub series_from_sums: Columns,
    /// Legendre coefficients a_1, a_3, …, a_15, from differences.
    pub series_from_differences: Columns,
    /// Coefficients of u², u⁴, …, u¹⁶ of the twice integrated f: column k
    /// multiplies a_2k. Not taken from the sums directly, since the entries
    /// (up to 1e5) would magnify rounding that a decaying series does not have.
    pub powers_from_even: Columns,
    /// Coefficients of u³, u⁵, …, u¹⁷: column k multiplies a_2k+1.
    pub powers_from_odd: Columns,
}

/// The tables of the method of 16 nodes.
pub static GAUSS_16: Tables = Tables::new();

impl Tables {
    const fn new() -> Tables {
        let mut tables = Tables {
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
        let mut node = [Double::ZERO; PAIRS];
        let mut at_node = [[Double::ZERO; NODES + 2]; PAIRS];
        let mut i = 0;
        while i < PAIRS {
            node[i] = gauss_node(i);
            at_node[i] = legendre(node[i]);
            tables.node[i] = node[i].value();
            i += 1;
        }
        let powers = legendre_powers();
        let mut j = 0;
        while j < PAIRS {
            // Row of a_k over sums or differences: (2k+1)/2 · w_j · P_k(u_j).
            let weight = gauss_weight(node[j], &at_node[j]);
            let mut share = [Double::ZERO; NODES];
            let mut k = 0;
            while k < NODES {
                share[k] = weight.mul(at_node[j][k]).scale(0.5 * (2 * k + 1) as f64);
                k += 1;
            }
            tables.mean[j] = share[0].value();
            tables.tilt[j] = share[1].div(Double::new(3.0)).value();
            let mut i = 0;
            while i < PAIRS {
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
const fn once(p: &Legendre, k: usize) -> Double {
    if k == 0 {
        return p[1];
    }
    p[k + 1].sub(p[k - 1]).div(Double::new((2 * k + 1) as f64))
}

/// The twice repeated integral of P_k from −1, without the terms that the
/// caller adds by itself: u for k = 0 and the constant −1/3 for k = 1.
const fn twice(p: &Legendre, k: usize) -> Double {
    match k {
        // (u² + 1)/2, from (u + 1)²/2.
        0 => p[1].mul(p[1]).add(Double::ONE).scale(0.5),
        // (∫P_2 − u)/3, from (∫P_2 − ∫P_0)/3.
        1 => once(p, 2).sub(p[1]).div(Double::new(3.0)),
        _ => once(p, k + 1)
            .sub(once(p, k - 1))
            .div(Double::new((2 * k + 1) as f64)),
    }
}

const fn sum_once(share: &[Double; NODES], p: &Legendre, parity: usize) -> Double {
    let mut sum = Double::ZERO;
    let mut k = parity;
    while k < NODES {
        sum = sum.add(share[k].mul(once(p, k)));
        k += 2;
    }
    sum
}

const fn sum_twice(share: &[Double; NODES], p: &Legendre, parity: usize) -> Double {
    let mut sum = Double::ZERO;
    let mut k = parity;
    while k < NODES {
        sum = sum.add(share[k].mul(twice(p, k)));
        k += 2;
    }
    sum
}

/// The factor of uᵖ⁺² in the twice integrated `coefficient`·uᵖ.
const fn integrated(coefficient: Double, p: usize) -> f64 {
    coefficient
        .div(Double::new(((p + 1) * (p + 2)) as f64))
        .value()
}

/// P_0 to P_17 at `u`, by Bonnet's recursion.
const fn legendre(u: Double) -> Legendre {
    let mut p = [Double::ONE; NODES + 2];
    p[1] = u;
    let mut k = 1;
    while k < NODES + 1 {
        p[k + 1] = u
            .mul(p[k])
            .scale((2 * k + 1) as f64)
            .sub(p[k - 1].scale(k as f64))
            .div(Double::new((k + 1) as f64));
        k += 1;
    }
    p
}

/// `[k][m]`: the coefficient of u^m in P_k.
const fn legendre_powers() -> [[Double; NODES]; NODES] {
    let mut c = [[Double::ZERO; NODES]; NODES];
    c[0][0] = Double::ONE;
    c[1][1] = Double::ONE;
    let mut k = 1;
    while k + 1 < NODES {
        let divisor = Double::new((k + 1) as f64);
        let mut m = 0;
        while m <= k + 1 {
            let lifted = if m == 0 { Double::ZERO } else { c[k][m - 1] };
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

/// The derivative of P_16 at `u`.
const fn legendre_slope(u: Double, p: &Legendre) -> Double {
    p[NODES - 1]
        .sub(u.mul(p[NODES]))
        .scale(NODES as f64)
        .div(Double::ONE.sub(u.mul(u)))
}

/// The i-th positive zero of P_16, by Newton's method from Tricomi's estimate.
const fn gauss_node(i: usize) -> Double {
    // cos(π(4k−1)/(4n+2)) for the k-th largest zero, by its power series.
    let k = PAIRS - i;
    let angle = std::f64::consts::PI * (4 * k - 1) as f64 / (4 * NODES + 2) as f64;
    let (mut term, mut cosine, mut n) = (1.0, 1.0, 0);
    while n < 12 {
        n += 1;
        term *= -angle * angle / ((2 * n - 1) * (2 * n)) as f64;
        cosine += term;
    }
    let mut u = Double::new(cosine);
    let mut round = 0;
    while round < 6 {
        let p = legendre(u);
        u = u.sub(p[NODES].div(legendre_slope(u, &p)));
        round += 1;
    }
    u
}

/// The weight of a node: 2 / ((1 − u²) P'_16(u)²).
const fn gauss_weight(u: Double, p: &Legendre) -> Double {
    let slope = legendre_slope(u, p);
    Double::new(2.0).div(Double::ONE.sub(u.mul(u)).mul(slope.mul(slope)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f(u) = uⁿ: every table against the integral done by hand.
    #[test]
    fn powers_up_to_degree_fifteen_are_integrated_exactly() {
        let t = &GAUSS_16;
        for n in 0..NODES as i32 {
            let even = n % 2 == 0;
            let values = t.node.map(|u| 2.0 * u.powi(n));
            let dot =
                |row: &[f64; PAIRS]| -> f64 { row.iter().zip(values).map(|(a, b)| a * b).sum() };
            let apply =
                |m: &Columns, i: usize| -> f64 { (0..PAIRS).map(|j| m[j][i] * values[j]).sum() };
            let expand = |powers: &Columns, series: &Columns, i: usize| -> f64 {
                (0..PAIRS).map(|k| powers[k][i] * apply(series, k)).sum()
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
