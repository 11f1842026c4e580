//! Surface effects folded into the coefficients of the equation of motion.

use crate::actuator::Parameters;

/// The coefficients of Eq. 16 in powers of the stretch λ:
///
/// ```text
/// (c + 2λ⁻⁶) λ'' − 6λ⁻⁷ λ'² = S + λ⁻⁵ − linear·λ − (cubic − φ²)·λ³ − quintic·λ⁵
/// ```
///
/// Surface energy, surface tension and surface elasticity enter nowhere else,
/// so they cost nothing while the motion is integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// c, the inertia of the motion in the plane.
    pub inertia: f64,
    /// 1 + 2γ − 2τ + E.
    pub linear: f64,
    /// 4τ − 4E.
    pub cubic: f64,
    /// 3E.
    pub quintic: f64,
}

impl Coefficients {
    /// Folds the parameters.
    #[must_use]
    pub fn fold(parameters: &Parameters) -> Coefficients {
        let Parameters {
            aspect,
            surface_energy,
            surface_tension,
            surface_elasticity,
        } = *parameters;
        Coefficients {
            inertia: aspect,
            linear: 1.0 + 2.0 * (surface_energy - surface_tension) + surface_elasticity,
            cubic: 4.0 * (surface_tension - surface_elasticity),
            quintic: 3.0 * surface_elasticity,
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
