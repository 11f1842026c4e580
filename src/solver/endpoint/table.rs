//! The table of Gauss–Legendre collocation with 8 nodes that are not paired, made by the
//! compiler (see [`crate::solver::tables`]).

use crate::arithmetic::double_double::DoubleDouble;
use crate::solver::tables::{Exact, dot, legendre};

/// Numbers at the nodes, in two registers.
pub type Eight = [[f64; 4]; 2];

/// An 8×8 matrix by the diagonals of an exclusive or: diagonal x multiplies, at node i, the
/// value of node i ^ x. Registers are permuted for that, not stored and spread.
pub type Diagonals = [Eight; 8];

/// What leads from g at the nodes, and from the rate at the begin, to the motion over a step.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
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
pub static TABLE: Dense = Dense::new(&Exact::gauss());

impl Dense {
    const fn new(exact: &Exact<8>) -> Dense {
        const N: usize = 8;
        /// The nodes in the order of the table, of those that increase.
        const PLACE: [usize; N] = [4, 5, 6, 7, 3, 2, 1, 0];
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
        // Legendre polynomials are 1 at the end.
        let at_end = [DoubleDouble::ONE; N];
        let mut j = 0;
        while j < N {
            let series = &exact.series[PLACE[j]];
            let mut k = 0;
            while k < N {
                dense.series[j][k] = series[k].value();
                k += 1;
            }
            dense.last[j] = dot(series, &at_end).value();
            dense.place[j] = DoubleDouble::ONE.add(exact.node[PLACE[j]]).value();
            dense.plain.drift[j] = dense.place[j];
            let tilt = series[1].div(DoubleDouble::new(3.0));
            dense.plain.end[j] = [
                series[0].sub(tilt).scale(2.0).value(),
                series[0].scale(2.0).value(),
                series[N - 2].value(),
                series[N - 1].value(),
            ];
            let mut i = 0;
            while i < N {
                let next = legendre(exact.node[PLACE[i]].add(DoubleDouble::new(2.0)));
                let [column, row] = [PLACE[j], PLACE[i]];
                let [x, register, lane] = [i ^ j, i / 4, i % 4];
                dense.plain.once[x][register][lane] = exact.once[column][row].value();
                dense.plain.twice[x][register][lane] = exact.twice[column][row].value();
                dense.ahead[x][register][lane] = dot(series, &next).value();
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
    use crate::solver::tables::GAUSS_8;

    /// Against the nodes that increase; the continuation against powers.
    #[test]
    fn the_diagonals_are_the_matrices_of_the_nodes_in_another_order() {
        let node = TABLE.place.map(|place| place - 1.0);
        let at = TABLE.place.map(|place| {
            let same = |other: &f64| *other == place;
            GAUSS_8.place.iter().position(same).expect("a node")
        });
        let entry = |matrix: &Diagonals, i: usize, j: usize| matrix[i ^ j][i / 4][i % 4];
        for (i, j) in (0..8).flat_map(|i| (0..8).map(move |j| (i, j))) {
            assert_eq!(entry(&TABLE.plain.once, i, j), GAUSS_8.once[at[j]][at[i]]);
            assert_eq!(entry(&TABLE.plain.twice, i, j), GAUSS_8.twice[at[j]][at[i]]);
            assert_eq!(TABLE.series[j][i], GAUSS_8.series[at[j]][i]);
        }
        for n in 0..8_i32 {
            let values = node.map(|u| u.powi(n));
            let sum = |weight: &dyn Fn(usize) -> f64| -> f64 {
                (0..8).map(|j| weight(j) * values[j]).sum()
            };
            for (i, u) in node.into_iter().enumerate() {
                let ahead = sum(&|j| entry(&TABLE.ahead, i, j));
                assert!((ahead - (u + 2.0).powi(n)).abs() < 1e-9, "u^{n}");
            }
            // ∫∫uⁿ and ∫uⁿ from −1 to 1, uⁿ at 1.
            let mean = if n % 2 == 0 {
                1.0 / f64::from(n + 1)
            } else {
                0.0
            };
            let tilt = if n % 2 == 0 {
                0.0
            } else {
                1.0 / f64::from(n + 2)
            };
            let displacement = sum(&|j| TABLE.plain.end[j][0]);
            assert!((displacement - 2.0 * (mean - tilt)).abs() < 2e-15, "u^{n}");
            assert!((sum(&|j| TABLE.plain.end[j][1]) - 2.0 * mean).abs() < 2e-15);
            assert!((sum(&|j| TABLE.last[j]) - 1.0).abs() < 4e-15, "u^{n}");
        }
    }
}
