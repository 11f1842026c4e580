//! Surface effects folded into the coefficients of the equation of motion.

use serde::{Deserialize, Serialize};

use crate::actuator::Parameters;
use crate::arithmetic::number::Number;

/// The coefficients of Eq. 16 in powers of the stretch λ:
///
/// ```text
/// (c + 2λ⁻⁶) λ'' − 6λ⁻⁷ λ'² = S + λ⁻⁵ − linear·λ − (cubic − φ²)·λ³ − quintic·λ⁵
/// ```
///
/// Surface energy, surface tension and surface elasticity enter nowhere else,
/// so they cost nothing while the motion is integrated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coefficients<N = f64> {
    /// c, the inertia of the motion in the plane.
    pub inertia: N,
    /// 1 + 2γ − 2τ + E.
    pub linear: N,
    /// 4τ − 4E.
    pub cubic: N,
    /// 3E.
    pub quintic: N,
}

impl<N: Number> Coefficients<N> {
    /// Folds the parameters.
    #[must_use]
    #[inline(always)]
    pub fn fold(parameters: &Parameters<N>) -> Coefficients<N> {
        let Parameters {
            aspect,
            surface_energy,
            surface_tension,
            surface_elasticity,
        } = *parameters;
        let number = |value: f64| aspect.same(value);
        Coefficients {
            inertia: aspect,
            linear: number(1.0)
                + number(2.0) * (surface_energy - surface_tension)
                + surface_elasticity,
            cubic: number(4.0) * (surface_tension - surface_elasticity),
            quintic: number(3.0) * surface_elasticity,
        }
    }
}

impl Coefficients {
    /// The coefficients as numbers of the kind of `like`, in each of its lanes.
    #[inline(always)]
    #[must_use]
    pub fn same<N: Number>(&self, like: N) -> Coefficients<N> {
        Coefficients {
            inertia: like.same(self.inertia),
            linear: like.same(self.linear),
            cubic: like.same(self.cubic),
            quintic: like.same(self.quintic),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bracket of Eq. 16 against the folded force, term by term.
    #[test]
    fn the_folded_force_is_that_of_the_paper() {
        for (gamma, tau, elasticity) in [(0.05, 0.03, 0.2), (0.0, 0.1, 0.0), (0.1, 0.0, 0.4)] {
            let folded = Coefficients::fold(&Parameters {
                aspect: 100.0,
                surface_energy: gamma,
                surface_tension: tau,
                surface_elasticity: elasticity,
            });
            for stretch in [0.7_f64, 1.0, 1.3, 2.0] {
                let square = stretch * stretch;
                let paper = stretch
                    + 2.0
                        * (gamma * stretch
                            + tau * (2.0 * stretch.powi(3) - stretch)
                            + 0.5 * elasticity * stretch * (square - 1.0) * (3.0 * square - 1.0));
                let ours = folded.linear * stretch
                    + folded.cubic * stretch.powi(3)
                    + folded.quintic * stretch.powi(5);
                assert!((paper - ours).abs() < 1e-14 * paper.abs().max(1.0));
            }
        }
    }
}
