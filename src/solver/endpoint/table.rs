//! The table of Gauss–Legendre collocation with 8 nodes that are not paired, made by the
//! compiler (see [`crate::solver::tables`]).

use crate::solver::double_double::DoubleDouble;
use crate::solver::tables::{MOST_NODES, gauss_node, gauss_weight, legendre, sum_once, sum_twice};

/// Numbers at the nodes, in two registers.
pub type Eight = [[f64; 4]; 2];

/// An 8×8 matrix by the diagonals of an exclusive or: diagonal x multiplies, at node i, the
/// value of node i ^ x. Registers are permuted for that, not stored and spread.
pub type Diagonals = [Eight; 8];

/// What leads from g at the nodes, and from the rate at the begin, to the motion over a step.
#[derive(Clone, Copy, Debug)]
pub struct Matrices {
    /// The displacement x − x_0 at the nodes, from g and from x'_0.
    pub twice: Diagonals,
    pub drift: [f64; 8],
    /// x' at the nodes, from g and from x'_0.
    pub once: Diagonals,
    pub gain: [f64; 8],
    /// From each value of g, and from x'_0: displacement and change of x' at the end, and half²
    /// times the last two Legendre coefficients of f.
    pub end: [[f64; 4]; 8],
    pub end_drift: [f64; 4],
}

impl Matrices {
    /// None: all numbers are 0.
    pub const NONE: Matrices = Matrices {
        twice: [[[0.0; 4]; 2]; 8],
        drift: [0.0; 8],
        once: [[[0.0; 4]; 2]; 8],
        gain: [0.0; 8],
        end: [[0.0; 4]; 8],
        end_drift: [0.0; 4],
    };
}

/// What is needed of the nodes: u_0 to u_3 increasing, then −u_0 to −u_3.
#[derive(Debug)]
pub struct Dense {
    /// 1 + u_i.
    pub place: [f64; 8],
    /// The matrices of a step of half the length 1 with the slope 0.
    pub plain: Matrices,
    /// The polynomial through the values at the nodes, one step of the same length later.
    pub ahead: Diagonals,
    /// The value at the end from those at the nodes.
    pub last: [f64; 8],
    /// For the value at each node: all Legendre coefficients.
    pub series: [[f64; 8]; 8],
}

/// The table of the method.
pub static TABLE: Dense = Dense::new();

impl Dense {
    const fn new() -> Dense {
        const N: usize = 8;
        let mut dense = Dense {
            place: [0.0; N],
            plain: Matrices {
                gain: [1.0; N],
                end_drift: [2.0, 0.0, 0.0, 0.0],
                ..Matrices::NONE
            },
            ahead: [[[0.0; 4]; 2]; N],
            last: [0.0; N],
            series: [[0.0; N]; N],
        };
        let mut node = [DoubleDouble::ZERO; N];
        let mut i = 0;
        while i < N / 2 {
            node[i] = gauss_node(i, N);
            node[i + N / 2] = DoubleDouble::ZERO.sub(node[i]);
            i += 1;
        }
        let mut j = 0;
        while j < N {
            let p = legendre(node[j]);
            let weight = gauss_weight(node[j], &p, N);
            let mut share = [DoubleDouble::ZERO; MOST_NODES];
            let mut last = DoubleDouble::ZERO;
            let mut k = 0;
            while k < N {
                share[k] = weight.mul(p[k]).scale(0.5 * (2 * k + 1) as f64);
                dense.series[j][k] = share[k].value();
                // Legendre polynomials are 1 there.
                last = last.add(share[k]);
                k += 1;
            }
            dense.last[j] = last.value();
            dense.place[j] = DoubleDouble::ONE.add(node[j]).value();
            dense.plain.drift[j] = dense.place[j];
            let tilt = share[1].div(DoubleDouble::new(3.0));
            dense.plain.end[j] = [
                share[0].sub(tilt).scale(2.0).value(),
                share[0].scale(2.0).value(),
                share[N - 2].value(),
                share[N - 1].value(),
            ];
            let mut i = 0;
            while i < N {
                let p = legendre(node[i]);
                let next = legendre(node[i].add(DoubleDouble::new(2.0)));
                let (mut once, mut twice, mut ahead) =
                    (share[0], DoubleDouble::ZERO.sub(tilt), DoubleDouble::ZERO);
                // The parts that `once` and `twice` leave out.
                twice = twice.add(share[0].mul(node[i]));
                once = once.add(sum_once(&share, &p, 0));
                once = once.add(sum_once(&share, &p, 1));
                twice = twice.add(sum_twice(&share, &p, 0));
                twice = twice.add(sum_twice(&share, &p, 1));
                let mut k = 0;
                while k < N {
                    ahead = ahead.add(share[k].mul(next[k]));
                    k += 1;
                }
                dense.plain.once[i ^ j][i / 4][i % 4] = once.value();
                dense.plain.twice[i ^ j][i / 4][i % 4] = twice.value();
                dense.ahead[i ^ j][i / 4][i % 4] = ahead.value();
                i += 1;
            }
            j += 1;
        }
        dense
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Powers of u, each integrated, continued and expanded as it should be.
    #[test]
    fn the_table_integrates_polynomials() {
        for n in 0..8_i32 {
            let node = TABLE.place.map(|place| place - 1.0);
            let values = node.map(|u| u.powi(n));
            let apply = |matrix: &Diagonals, i: usize| -> f64 {
                (0..8)
                    .map(|x| matrix[x][i / 4][i % 4] * values[i ^ x])
                    .sum()
            };
            let begin = (-1.0_f64).powi(n + 1);
            let [order, next] = [f64::from(n + 1), f64::from(n + 2)];
            let once = |u: f64| (u.powi(n + 1) - begin) / order;
            let twice =
                |u: f64| (u.powi(n + 2) + begin) / (order * next) - begin * (1.0 + u) / order;
            for (i, u) in node.into_iter().enumerate() {
                let matrices = &TABLE.plain;
                assert!((apply(&matrices.once, i) - once(u)).abs() < 2e-15, "u^{n}");
                assert!(
                    (apply(&matrices.twice, i) - twice(u)).abs() < 2e-15,
                    "u^{n}"
                );
                let ahead = apply(&TABLE.ahead, i);
                assert!((ahead - (u + 2.0).powi(n)).abs() < 1e-9, "u^{n}: {ahead}");
            }
            let column =
                |row: usize| -> f64 { (0..8).map(|j| TABLE.plain.end[j][row] * values[j]).sum() };
            assert!((column(0) - twice(1.0)).abs() < 2e-15, "u^{n}");
            assert!((column(1) - once(1.0)).abs() < 2e-15, "u^{n}");
            let last: f64 = (0..8).map(|j| TABLE.last[j] * values[j]).sum();
            assert!((last - 1.0).abs() < 4e-15, "u^{n}: {last}");
            // P_0 to P_7 are all 1 at u = 1.
            let sum: f64 = (0..8)
                .map(|k| -> f64 { (0..8).map(|j| TABLE.series[j][k] * values[j]).sum() })
                .sum();
            assert!((sum - 1.0).abs() < 4e-15, "u^{n}: {sum}");
        }
    }
}
