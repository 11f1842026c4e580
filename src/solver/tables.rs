//! Constant tables of collocation, made by the compiler.
//!
//! Over a step, u ∈ [−1, 1], the derivative f is the polynomial through its values at N nodes u_j,
//! written in Legendre polynomials and integrated from u = −1 in closed form. With N nodes the
//! rules of Gauss and of Radau integrate degree 2N − 2 exactly, so that the coefficients of a
//! polynomial of degree N − 1 follow from the weights w_j:
//!
//! ```text
//! f = Σ a_k P_k             a_k = (2k+1)/2 Σ_j w_j P_k(u_j) f_j
//! ∫P_0 = P_1 + P_0          ∫P_k = (P_{k+1} − P_{k−1}) / (2k+1)
//! ```
//!
//! [`Exact`] has the matrices that follow, in double-double. All tables are taken from it: [`Rule`]
//! as they stand, `paired` for nodes that are folded into pairs ±u, and those of the endpoint-only
//! steps. Each entry is rounded once.
//!
//! The right Radau nodes are the zeros of P_{N−1} − P_N. The last one is the end of the step, and
//! the method is stiffly accurate (L-stable): what decays much faster than the step is long is gone
//! at its end, where Gauss nodes keep it for ever with alternating sign. There the rate is
//! integrated from its own values at the nodes, as that of a system of first order: with f
//! integrated twice in closed form, the rate at the begin would count too, and what an overdamped
//! motion has forgotten would stay.
//!
//! Sources: E. Hairer, S. P. Nørsett, G. Wanner, "Solving Ordinary Differential Equations I",
//! 2nd ed., section II.7, and E. Hairer, G. Wanner, the same, II, section IV.5.

use crate::arithmetic::double_double::DoubleDouble;

mod paired;
pub mod product;

pub use paired::{PAIRED_16, PAIRS};

/// Nodes of the largest method.
const MOST_NODES: usize = 16;

/// Legendre polynomials at one point: degrees 0 to the number of nodes + 1.
type Legendre = [DoubleDouble; MOST_NODES + 2];

/// A matrix by columns: column j multiplies the value at node j.
pub type Columns<const N: usize> = [[f64; N]; N];

/// A method of N nodes.
pub(super) struct Exact<const N: usize> {
    /// The nodes, increasing.
    pub node: [DoubleDouble; N],
    /// The once and the twice integrated f at the nodes, by columns.
    pub once: [[DoubleDouble; N]; N],
    pub twice: [[DoubleDouble; N]; N],
    /// The Legendre coefficients of f, by columns.
    pub series: [[DoubleDouble; N]; N],
}

/// The tables of a method of N nodes, for computing with them.
#[derive(Debug)]
pub struct Rule<const N: usize> {
    /// 1 + u_i, increasing.
    pub place: [f64; N],
    /// The once integrated f at the nodes.
    pub once: Columns<N>,
    /// The twice integrated f at the nodes: with Gauss nodes in closed form, with Radau nodes as
    /// `once` of `once`.
    pub twice: Columns<N>,
    /// Its Legendre coefficients.
    pub series: Columns<N>,
}

/// Gauss nodes, 4 of them.
pub static GAUSS_4: Rule<4> = Rule::of(&Exact::gauss());
/// From f at these nodes: the twice and the once integrated f at the end, f itself there, and its
/// slope there times the length of the step.
pub static ENDS_4: Columns<4> = ends(&Exact::gauss());
/// Gauss nodes, 8 of them.
pub static GAUSS_8: Rule<8> = Rule::of(&Exact::gauss());
/// Gauss nodes, 16 of them.
pub static GAUSS_16: Rule<16> = Rule::of(&Exact::gauss());
/// Right Radau nodes, 8 of them.
pub static RADAU_8: Rule<8> = Rule::of(&Exact::radau());
/// Right Radau nodes, 16 of them.
pub static RADAU_16: Rule<16> = Rule::of(&Exact::radau());

impl<const N: usize> Exact<N> {
    /// The method with Gauss nodes.
    pub const fn gauss() -> Exact<N> {
        let mut nodes = [DoubleDouble::ZERO; N];
        let mut weights = [DoubleDouble::ZERO; N];
        let mut i = 0;
        while i < N / 2 {
            let u = positive_gauss_node(i, N);
            let slope = legendre_slope(u, &legendre(u), N);
            // 2 / ((1 − u²) P'_N(u)²).
            let size = DoubleDouble::ONE.sub(u.mul(u)).mul(slope.mul(slope));
            let weight = DoubleDouble::new(2.0).div(size);
            let [low, high] = [N / 2 - 1 - i, N / 2 + i];
            (nodes[low], nodes[high]) = (u.scale(-1.0), u);
            (weights[low], weights[high]) = (weight, weight);
            i += 1;
        }
        Exact::new(nodes, &weights)
    }

    /// The method with right Radau nodes.
    const fn radau() -> Exact<N> {
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
        let mut exact = Exact::new(nodes, &weights);
        let mut j = 0;
        while j < N {
            let mut i = 0;
            while i < N {
                let (mut sum, mut k) = (DoubleDouble::ZERO, 0);
                while k < N {
                    sum = sum.add(exact.once[k][i].mul(exact.once[j][k]));
                    k += 1;
                }
                exact.twice[j][i] = sum;
                i += 1;
            }
            j += 1;
        }
        exact
    }

    const fn new(node: [DoubleDouble; N], weights: &[DoubleDouble; N]) -> Exact<N> {
        let mut exact = Exact {
            node,
            once: [[DoubleDouble::ZERO; N]; N],
            twice: [[DoubleDouble::ZERO; N]; N],
            series: [[DoubleDouble::ZERO; N]; N],
        };
        let mut i = 0;
        while i < N {
            let p = legendre(node[i]);
            let mut k = 0;
            while k < N {
                // Row i of `once` and `twice` waits until all columns of `series` are known.
                let part = weights[i].mul(p[k]);
                exact.series[i][k] = part.scale(0.5 * (2 * k + 1) as f64);
                k += 1;
            }
            i += 1;
        }
        let mut i = 0;
        while i < N {
            let p = legendre(node[i]);
            let (mut once, mut twice, mut k) = ([p[0]; N], [p[0]; N], 0);
            while k < N {
                (once[k], twice[k]) = (integral(&p, k), twice_integral(&p, k));
                k += 1;
            }
            let mut j = 0;
            while j < N {
                exact.once[j][i] = dot(&exact.series[j], &once);
                exact.twice[j][i] = dot(&exact.series[j], &twice);
                j += 1;
            }
            i += 1;
        }
        exact
    }
}

impl<const N: usize> Rule<N> {
    const fn of(exact: &Exact<N>) -> Rule<N> {
        let mut place = [0.0; N];
        let mut i = 0;
        while i < N {
            place[i] = DoubleDouble::ONE.add(exact.node[i]).value();
            i += 1;
        }
        Rule {
            place,
            once: rounded(&exact.once),
            twice: rounded(&exact.twice),
            series: rounded(&exact.series),
        }
    }
}

const fn rounded<const N: usize>(exact: &[[DoubleDouble; N]; N]) -> Columns<N> {
    let mut columns = [[0.0; N]; N];
    let mut at = 0;
    while at < N * N {
        columns[at / N][at % N] = exact[at / N][at % N].value();
        at += 1;
    }
    columns
}

const fn ends(exact: &Exact<4>) -> Columns<4> {
    let mut columns = [[0.0; 4]; 4];
    let mut j = 0;
    while j < 4 {
        // The Legendre polynomial of degree k is 1 at the end, its slope k(k + 1)/2.
        let [zeroth, first, second, third] = exact.series[j];
        let tilt = first.div(DoubleDouble::new(3.0));
        let slope = first.add(second.scale(3.0)).add(third.scale(6.0));
        columns[j] = [
            zeroth.sub(tilt).scale(2.0).value(),
            zeroth.scale(2.0).value(),
            zeroth.add(second).add(first.add(third)).value(),
            slope.scale(2.0).value(),
        ];
        j += 1;
    }
    columns
}

/// Σ a_k b_k.
pub(super) const fn dot(a: &[DoubleDouble], b: &[DoubleDouble]) -> DoubleDouble {
    let (mut sum, mut k) = (DoubleDouble::ZERO, 0);
    while k < a.len() {
        sum = sum.add(a[k].mul(b[k]));
        k += 1;
    }
    sum
}

/// The integral of P_k from −1.
const fn integral(p: &Legendre, k: usize) -> DoubleDouble {
    match k {
        0 => p[1].add(DoubleDouble::ONE),
        _ => {
            let order = DoubleDouble::new((2 * k + 1) as f64);
            p[k + 1].sub(p[k - 1]).div(order)
        }
    }
}

/// The twice repeated integral of P_k from −1.
const fn twice_integral(p: &Legendre, k: usize) -> DoubleDouble {
    match k {
        // (u + 1)²/2.
        0 => {
            let place = integral(p, 0);
            place.mul(place).scale(0.5)
        }
        _ => {
            let order = DoubleDouble::new((2 * k + 1) as f64);
            integral(p, k + 1).sub(integral(p, k - 1)).div(order)
        }
    }
}

/// P_0 to P_N+1 at `u`, by Bonnet's recursion.
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

/// The derivative of P_n at `u`.
const fn legendre_slope(u: DoubleDouble, p: &Legendre, n: usize) -> DoubleDouble {
    p[n - 1]
        .sub(u.mul(p[n]))
        .scale(n as f64)
        .div(DoubleDouble::ONE.sub(u.mul(u)))
}

/// The i-th positive zero of P_n, by Newton's method from Tricomi's estimate.
const fn positive_gauss_node(i: usize, n: usize) -> DoubleDouble {
    // cos(π(4k−1)/(4n+2)) for the k-th largest zero.
    let k = n / 2 - i;
    let mut u = cosine(std::f64::consts::PI * (4 * k - 1) as f64 / (4 * n + 2) as f64);
    let mut round = 0;
    while round < 6 {
        let p = legendre(u);
        u = u.sub(p[n].div(legendre_slope(u, &p, n)));
        round += 1;
    }
    u
}

/// The i-th of the N − 1 zeros of P_{N−1} − P_N below 1, by Newton's method.
const fn radau_node(i: usize, n: usize) -> DoubleDouble {
    // The asymptotic zeros of the Jacobi polynomial P^(1,0), cos(π(k + 1/4)/N).
    let mut u = cosine(std::f64::consts::PI * ((n - 1 - i) as f64 + 0.25) / n as f64);
    let mut round = 0;
    while round < 7 {
        let p = legendre(u);
        let slope = legendre_slope(u, &p, n - 1).sub(legendre_slope(u, &p, n));
        u = u.sub(p[n - 1].sub(p[n]).div(slope));
        round += 1;
    }
    u
}

/// The cosine of an angle between 0 and π by its power series: a first guess.
const fn cosine(angle: f64) -> DoubleDouble {
    let (mut term, mut sum, mut m) = (1.0, 1.0, 0);
    while m < 20 {
        m += 1;
        term *= -angle * angle / ((2 * m - 1) * (2 * m)) as f64;
        sum += term;
    }
    DoubleDouble::new(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f(u) = (1 + u)ⁿ: once and twice integrated at the nodes, and the mean, by hand.
    #[test]
    fn powers_below_the_number_of_nodes_are_integrated_exactly() {
        check(&GAUSS_4, 4);
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

    /// f(u) = (1 + u)ⁿ.
    #[test]
    fn four_nodes_lead_to_the_ends() {
        for n in 0..4 {
            let values = GAUSS_4.place.map(|place| place.powi(n));
            let (order, next) = (f64::from(n + 1), f64::from(n + 2));
            let once = 2.0_f64.powi(n + 1) / order;
            let power = 2.0_f64.powi(n);
            let expected = [2.0 * once / next, once, power, f64::from(n) * power];
            for (row, expected) in expected.into_iter().enumerate() {
                let end: f64 = (0..4).map(|j| ENDS_4[j][row] * values[j]).sum();
                assert!(
                    (end - expected).abs() < 8e-15 * expected.max(1.0),
                    "{n}, {row}"
                );
            }
        }
    }

    #[test]
    fn the_last_radau_node_is_the_end() {
        assert_eq!(RADAU_8.place[7], 2.0);
        assert_eq!(RADAU_16.place[15], 2.0);
        assert!(RADAU_16.place.is_sorted());
    }
}
