//! What describes an actuator.

/// The nondimensional parameters of the actuator (Eq. 15 of the paper).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// c = L²/H², the squared ratio of side to thickness.
    pub aspect: f64,
    /// γ̄_s, surface energy density.
    pub surface_energy: f64,
    /// τ̄_s, surface tension.
    pub surface_tension: f64,
    /// Ē_s, surface elasticity.
    pub surface_elasticity: f64,
}
