//! One set of parameters, and the paper's equations in them.
//!
//! Written from Eqs. 16 and 19 in γ, τ, E, not in the folded coefficients, and
//! in λ, not in 1/λ: independent of what is tested.

use dielectric_elastomer_actuator::actuator::Coefficients;
use dielectric_elastomer_actuator::pull_in::{Threshold, dynamic, escape_voltage, quasi_static};

/// The surface parameters γ, τ, E of the paper and the prestress S.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    pub gamma: f64,
    pub tau: f64,
    pub elasticity: f64,
    pub prestress: f64,
}

impl Case {
    /// Without surface effects and prestress.
    pub const IDEAL: Self = Self {
        gamma: 0.0,
        tau: 0.0,
        elasticity: 0.0,
        prestress: 0.0,
    };

    /// c = L²/H²; no threshold depends on it.
    pub const INERTIA: f64 = 100.0;

    fn coefficients(&self) -> Coefficients {
        let Self {
            gamma,
            tau,
            elasticity,
            ..
        } = *self;
        Coefficients {
            inertia: Self::INERTIA,
            linear: 1.0 + 2.0 * gamma - 2.0 * tau + elasticity,
            cubic: 4.0 * tau - 4.0 * elasticity,
            quintic: 3.0 * elasticity,
        }
    }

    pub fn dynamic(&self) -> Option<Threshold> {
        dynamic(&self.coefficients(), self.prestress)
    }

    pub fn quasi_static(&self) -> Option<Threshold> {
        quasi_static(&self.coefficients(), self.prestress)
    }

    pub fn escape_voltage(&self) -> Option<f64> {
        escape_voltage(&self.coefficients(), self.prestress)
    }

    /// φ² of Eq. 19, with the factor λ² − 1 divided out of each printed term.
    pub fn stagnation(&self, stretch: f64) -> f64 {
        let square = stretch * stretch;
        let grown = (stretch - 1.0) * (stretch + 1.0);
        let elastic = grown * (2.0 * square + 1.0) / (square * square);
        let surface = self.gamma + self.tau * square + 0.5 * self.elasticity * square * grown;
        let prestress = self.prestress / (stretch + 1.0);
        (elastic - 4.0 * prestress + 4.0 * surface) / (square + 1.0)
    }

    /// The force that pulls inward without voltage, from Eq. 16 as printed.
    pub fn restoring_force(&self, stretch: f64) -> f64 {
        let square = stretch * stretch;
        let surface = self.gamma * stretch
            + self.tau * stretch * (2.0 * square - 1.0)
            + 0.5 * self.elasticity * stretch * (square - 1.0) * (3.0 * square - 1.0);
        stretch - stretch.powi(-5) - self.prestress + 2.0 * surface
    }
}

/// The stretch λ at a threshold.
pub fn stretch(threshold: Threshold) -> f64 {
    threshold.thickness_stretch.sqrt().recip()
}
