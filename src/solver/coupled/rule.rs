//! Constant tables of collocation for systems of first order: Gauss nodes, and Radau IIA nodes
//! for what is stiff.
//!
//! The slope over a step is the polynomial through its values at the nodes u ∈ [−1, 1], written
//! in Legendre polynomials and integrated once and twice from u = −1 in closed form. With N
//! nodes both rules integrate degree 2N − 2 exactly, so that the coefficients of a polynomial of
//! degree N − 1 follow from the weights: a_k = (2k+1)/2 Σ_j w_j P_k(u_j) f_j.
//!
//! The right Radau nodes are the zeros of P_{N−1} − P_N. The last one is the end of the step,
//! and the method is stiffly accurate (L-stable): what decays much faster than the step is long
//! is gone at its end, where Gauss nodes keep it for ever with alternating sign. There the rate is integrated
//! from its own values at the nodes, as that of a system of first order: with the slope integrated twice in closed form, its
//! value at the begin would count too, and what an overdamped motion has forgotten would stay (1.6 % less a step instead
//! of 99 %, where the step is 200 times as long as the relaxation).
//!
//! Source: E. Hairer, G. Wanner, "Solving Ordinary Differential Equations II", 2nd ed.,
//! section IV.5. Each entry is computed in double-length arithmetic and rounded once.

use crate::solver::double_double::DoubleDouble;
use crate::solver::tables::{
    Legendre, MOST_NODES, gauss_node, gauss_weight, legendre, legendre_slope, once, twice,
};

/// A matrix by columns: column j multiplies the value at node j.
pub type Columns<const N: usize> = [[f64; N]; N];

/// The tables of a method of N nodes u_i.
#[derive(Debug)]
pub struct Rule<const N: usize> {
    /// 1 + u_i, increasing.
    pub place: [f64; N],
    /// The once integrated slope at the nodes.
    pub once: Columns<N>,
    /// The twice integrated slope at the nodes: with Gauss nodes in closed form, with Radau nodes as
    /// `once` of `once`.
    pub twice: Columns<N>,
    /// Its Legendre coefficients.
    pub series: Columns<N>,
}

/// Gauss nodes, 8 of them.
pub static GAUSS_8: Rule<8> = Rule::gauss();
/// Gauss nodes, 16 of them.
pub static GAUSS_16: Rule<16> = Rule::gauss();
/// Right Radau nodes, 8 of them.
pub static RADAU_8: Rule<8> = Rule::radau();
/// Right Radau nodes, 16 of them.
pub static RADAU_16: Rule<16> = Rule::radau();

impl<const N: usize> Rule<N> {
    const fn gauss() -> Rule<N> {
        let mut nodes = [DoubleDouble::ZERO; N];
        let mut weights = [DoubleDouble::ZERO; N];
        let mut i = 0;
        while i < N {
            let half = N / 2;
            nodes[i] = if i < half {
                gauss_node(half - 1 - i, N).scale(-1.0)
            } else {
                gauss_node(i - half, N)
            };
            weights[i] = gauss_weight(nodes[i], &legendre(nodes[i]), N);
            i += 1;
        }
        Rule::new(&nodes, &weights, true)
    }

    const fn radau() -> Rule<N> {
        let mut nodes = [DoubleDouble::ONE; N];
        let mut weights = [DoubleDouble::ZERO; N];
        let mut i = 0;
        while i < N {
            if i + 1 < N {
                nodes[i] = radau_node(i, N);
            }
            // (1 + u) / (N P_{N−1}(u))².
            let size = legendre(nodes[i])[N - 1].scale(N as f64);
            weights[i] = nodes[i].add(DoubleDouble::ONE).div(size.mul(size));
            i += 1;
        }
        Rule::new(&nodes, &weights, false)
    }

    const fn new(nodes: &[DoubleDouble; N], weights: &[DoubleDouble; N], closed: bool) -> Rule<N> {
        let mut rule = Rule {
            place: [0.0; N],
            once: [[0.0; N]; N],
            twice: [[0.0; N]; N],
            series: [[0.0; N]; N],
        };
        let mut integrated = [[[DoubleDouble::ZERO; MOST_NODES]; 2]; N];
        let mut i = 0;
        while i < N {
            rule.place[i] = nodes[i].add(DoubleDouble::ONE).value();
            let p = legendre(nodes[i]);
            let mut k = 0;
            while k < N {
                integrated[i][0][k] = once_from_begin(&p, k);
                integrated[i][1][k] = twice_from_begin(&p, k);
                k += 1;
            }
            i += 1;
        }
        let mut exact = [[DoubleDouble::ZERO; N]; N];
        let mut j = 0;
        while j < N {
            let p = legendre(nodes[j]);
            let mut share = [DoubleDouble::ZERO; MOST_NODES];
            let mut k = 0;
            while k < N {
                share[k] = weights[j].mul(p[k]).scale(0.5 * (2 * k + 1) as f64);
                rule.series[j][k] = share[k].value();
                k += 1;
            }
            let mut i = 0;
            while i < N {
                exact[j][i] = dot(&share, &integrated[i][0], N);
                rule.once[j][i] = exact[j][i].value();
                rule.twice[j][i] = dot(&share, &integrated[i][1], N).value();
                i += 1;
            }
            j += 1;
        }
        let mut j = 0;
        while j < N && !closed {
            let mut i = 0;
            while i < N {
                let mut sum = DoubleDouble::ZERO;
                let mut k = 0;
                while k < N {
                    sum = sum.add(exact[k][i].mul(exact[j][k]));
                    k += 1;
                }
                rule.twice[j][i] = sum.value();
                i += 1;
            }
            j += 1;
        }
        rule
    }
}

const fn dot(
    a: &[DoubleDouble; MOST_NODES],
    b: &[DoubleDouble; MOST_NODES],
    terms: usize,
) -> DoubleDouble {
    let mut sum = DoubleDouble::ZERO;
    let mut k = 0;
    while k < terms {
        sum = sum.add(a[k].mul(b[k]));
        k += 1;
    }
    sum
}

/// The integral of P_k from −1.
const fn once_from_begin(p: &Legendre, k: usize) -> DoubleDouble {
    match k {
        0 => once(p, 0).add(DoubleDouble::ONE),
        _ => once(p, k),
    }
}

/// The twice repeated integral of P_k from −1.
const fn twice_from_begin(p: &Legendre, k: usize) -> DoubleDouble {
    match k {
        0 => twice(p, 0).add(p[1]),
        1 => twice(p, 1).sub(DoubleDouble::ONE.div(DoubleDouble::new(3.0))),
        _ => twice(p, k),
    }
}

/// The i-th of the N − 1 zeros of P_{N−1} − P_N below 1, by Newton's method.
const fn radau_node(i: usize, n: usize) -> DoubleDouble {
    // The asymptotic zeros of the Jacobi polynomial P^(1,0), cos(π(k + 1/4)/N).
    let angle = std::f64::consts::PI * ((n - 1 - i) as f64 + 0.25) / n as f64;
    let (mut term, mut cosine, mut m) = (1.0, 1.0, 0);
    while m < 20 {
        m += 1;
        term *= -angle * angle / ((2 * m - 1) * (2 * m)) as f64;
        cosine += term;
    }
    let mut u = DoubleDouble::new(cosine);
    let mut round = 0;
    while round < 7 {
        let p = legendre(u);
        let slope = legendre_slope(u, &p, n - 1).sub(legendre_slope(u, &p, n));
        u = u.sub(p[n - 1].sub(p[n]).div(slope));
        round += 1;
    }
    u
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f(u) = (1 + u)ⁿ: once and twice integrated at the nodes, and the mean, by hand.
    #[test]
    fn powers_below_the_number_of_nodes_are_integrated_exactly() {
        check(&GAUSS_8, 8);
        check(&GAUSS_16, 16);
        // The rate, of a degree more, is taken from its values at the nodes.
        check(&RADAU_8, 7);
        check(&RADAU_16, 15);
    }

    fn check<const N: usize>(rule: &Rule<N>, powers: i32) {
        for n in 0..powers {
            let values = rule.place.map(|place| place.powi(n));
            let apply =
                |m: &Columns<N>, i: usize| -> f64 { (0..N).map(|j| m[j][i] * values[j]).sum() };
            let (order, next) = (f64::from(n + 1), f64::from(n + 2));
            let size = 2.0_f64.powi(n);
            for (i, place) in rule.place.into_iter().enumerate() {
                let by_hand = place.powi(n + 1) / order;
                let once = apply(&rule.once, i);
                assert!(
                    (once - by_hand).abs() < 4e-15 * size,
                    "{n} {once} {by_hand}"
                );
                let twice = apply(&rule.twice, i);
                assert!((twice - by_hand * place / next).abs() < 4e-15 * size, "{n}");
            }
            let mean = apply(&rule.series, 0);
            assert!((mean - size / order).abs() < 4e-15 * size, "{n}");
        }
    }

    #[test]
    fn the_last_radau_node_is_the_end() {
        assert_eq!(RADAU_8.place[7], 2.0);
        assert_eq!(RADAU_16.place[15], 2.0);
        assert!(RADAU_16.place.is_sorted());
    }
}
