//! What describes an actuator.

use serde::{Deserialize, Serialize};

use crate::arithmetic::jet::Dual;

/// The nondimensional parameters of the actuator (Eq. 15 of the paper).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameters<N = f64> {
    /// c = L²/H², the squared ratio of side to thickness.
    pub aspect: N,
    /// γ̄_s, surface energy density.
    pub surface_energy: N,
    /// τ̄_s, surface tension.
    pub surface_tension: N,
    /// Ē_s, surface elasticity.
    pub surface_elasticity: N,
}

impl Parameters {
    /// The parameters as they change in a direction, whose numbers are the rates
    /// of change of those in their places.
    #[must_use]
    pub fn along(&self, direction: &Parameters) -> Parameters<Dual> {
        Parameters {
            aspect: Dual::new(self.aspect, direction.aspect),
            surface_energy: Dual::new(self.surface_energy, direction.surface_energy),
            surface_tension: Dual::new(self.surface_tension, direction.surface_tension),
            surface_elasticity: Dual::new(self.surface_elasticity, direction.surface_elasticity),
        }
    }
}
