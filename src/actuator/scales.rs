//! From SI units to nondimensional numbers and back: the only place with units.
//!
//! n layers of thickness H and side L × L lie on one another, electrically in parallel, with one
//! common stretch; T = nH is the thickness of the stack, µ the shear modulus, ρ the density and
//! ε the permittivity at λ = 1.
//!
//! | scale | formula |
//! |---|---|
//! | time t0 | T √(ρ/(12µ)) |
//! | voltage V0 | H √(µ/ε), a layer's |
//! | charge Q0 | n L² √(εµ) |
//! | energy E0 | µ L² T = V0 Q0 |
//! | force P0 | µ T L, the force on each pair of opposite edges |
//! | capacitance C0 | n ε L²/H = Q0/V0 |
//!
//! The inertia across the thickness is that of the whole stack, hence c = L²/T².

use serde::{Deserialize, Serialize};

use super::Parameters;
use super::device::parameters::MOST_BRANCHES;
use super::device::{
    Branch, Breakdown, Damping, Device, Elasticity, Locking, Permittivity, Port, Source, Spring,
};
use crate::solver::double::Double;

/// ε0 in F/m (CODATA 2022).
pub const VACUUM_PERMITTIVITY: f64 = 8.854_187_818_8e-12;

/// A real actuator in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SiDevice {
    /// µ in Pa, the shear modulus (2·C10 of a Yeoh material).
    pub shear_modulus: f64,
    /// ρ in kg/m³.
    pub density: f64,
    /// ε/ε0 at λ = 1.
    pub relative_permittivity: f64,
    /// H in m, the thickness of a layer.
    pub thickness: f64,
    /// L in m, the side of the sheet.
    pub side: f64,
    /// n, the number of layers.
    pub layers: f64,
    /// Surface energy in N/m.
    pub surface_energy: f64,
    /// Surface tension in N/m.
    pub surface_tension: f64,
    /// Surface elasticity in N/m.
    pub surface_elasticity: f64,
    /// The number of surfaces that carry surface energy; 2, the outer faces, in the paper.
    pub surfaces: f64,
    /// The law of its elastic stiffness, nondimensional.
    pub elasticity: SiElasticity,
    /// m in kg, the reduced mass of what sits on opposite edges, in each direction.
    pub load_mass: f64,
    /// k in N/m, a spring between opposite edges, in each direction.
    pub load_spring: f64,
    /// The length in m at which the spring is relaxed.
    pub load_spring_length: f64,
    /// k1, k2, k3 of the permittivity, nondimensional.
    pub permittivity_terms: [f64; 3],
    /// b in N s/m, a dashpot between opposite edges, in each direction.
    pub linear_damping: f64,
    /// η in Pa s, Kelvin–Voigt.
    pub viscosity: f64,
    /// The moduli µ_k of the Maxwell branches in Pa; 0 for none.
    pub branch_moduli: [f64; MOST_BRANCHES],
    /// Their relaxation times in s.
    pub branch_times: [f64; MOST_BRANCHES],
    /// The limits J of their Gent springs; infinite for neo-Hookean ones.
    pub branch_limits: [f64; MOST_BRANCHES],
    /// What the source imposes.
    pub source: Source,
    /// R_s in Ω, in series; 0 for an ideal source.
    pub series_resistance: f64,
    /// G_p in S, a fixed conductance in parallel.
    pub parallel_conductance: f64,
    /// σ in S/m, the conductivity of the material at a weak field.
    pub conductivity: f64,
    /// The field in V/m over which the conductivity grows by e; infinite for none.
    pub conduction_field: f64,
    /// The true breakdown field in V/m at λ = 1; infinite for none.
    pub breakdown_field: f64,
    /// n of E_b λⁿ.
    pub breakdown_exponent: f64,
}

/// The law of the elastic stiffness by its nondimensional constants.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum SiElasticity {
    /// No stiffening.
    NeoHookean,
    /// Gent with the limit J.
    Gent {
        /// J.
        limit: f64,
    },
    /// Yeoh with κ_j = C_j0/C10.
    Yeoh {
        /// κ2.
        second: f64,
        /// κ3.
        third: f64,
    },
}

/// The units of the nondimensional numbers, in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scales {
    /// t0 in s.
    pub time: Double,
    /// V0 in V.
    pub voltage: f64,
    /// Q0 in C.
    pub charge: f64,
    /// E0 in J.
    pub energy: f64,
    /// P0 in N.
    pub force: f64,
    /// C0 in F.
    pub capacitance: f64,
    /// L in m.
    pub length: f64,
    /// V0/H in V/m.
    pub field: f64,
}

impl Scales {
    /// The scales of an actuator.
    #[must_use]
    pub fn of(device: &SiDevice) -> Scales {
        let permittivity = device.relative_permittivity * VACUUM_PERMITTIVITY;
        let (mu, side) = (device.shear_modulus, device.side);
        let stack = device.layers * device.thickness;
        let field = (mu / permittivity).sqrt();
        let ratio = Double::new(device.density).div(Double::new(mu).scale(12.0));
        Scales {
            time: ratio
                .sqrt()
                .mul(Double::new(device.layers).scale(device.thickness)),
            voltage: device.thickness * field,
            charge: device.layers * side * side * (permittivity * mu).sqrt(),
            energy: mu * side * side * stack,
            force: mu * stack * side,
            capacitance: device.layers * permittivity * side * side / device.thickness,
            length: side,
            field,
        }
    }

    /// The unit of the current in A.
    #[must_use]
    pub fn current(&self) -> f64 {
        self.charge / self.time.value()
    }

    /// The unit of power in W.
    #[must_use]
    pub fn power(&self) -> f64 {
        self.energy / self.time.value()
    }

    /// The unit of resistance in Ω.
    #[must_use]
    pub fn resistance(&self) -> f64 {
        self.time.value() / self.capacitance
    }

    /// A time in s, kept as a double-length sum, as a nondimensional one. Divided once, no
    /// rounding adds up from step to step.
    #[must_use]
    pub fn time(&self, seconds: Double) -> Double {
        seconds.div(self.time)
    }

    /// The unit of what the source imposes.
    #[must_use]
    pub fn source(&self, source: Source) -> f64 {
        match source {
            Source::Voltage => self.voltage,
            Source::Current => self.current(),
            Source::Charge => self.charge,
        }
    }
}

impl SiDevice {
    /// A neo-Hookean sheet without load, losses or leaks, under an ideal source of voltage.
    #[must_use]
    pub const fn sheet(
        shear_modulus: f64,
        density: f64,
        relative_permittivity: f64,
        [thickness, side]: [f64; 2],
    ) -> SiDevice {
        SiDevice {
            shear_modulus,
            density,
            relative_permittivity,
            thickness,
            side,
            layers: 1.0,
            surface_energy: 0.0,
            surface_tension: 0.0,
            surface_elasticity: 0.0,
            surfaces: 2.0,
            elasticity: SiElasticity::NeoHookean,
            load_mass: 0.0,
            load_spring: 0.0,
            load_spring_length: side,
            permittivity_terms: [0.0; 3],
            linear_damping: 0.0,
            viscosity: 0.0,
            branch_moduli: [0.0; MOST_BRANCHES],
            branch_times: [1.0; MOST_BRANCHES],
            branch_limits: [f64::INFINITY; MOST_BRANCHES],
            source: Source::Voltage,
            series_resistance: 0.0,
            parallel_conductance: 0.0,
            conductivity: 0.0,
            conduction_field: f64::INFINITY,
            breakdown_field: f64::INFINITY,
            breakdown_exponent: 0.0,
        }
    }

    /// This actuator in nondimensional numbers.
    #[must_use]
    pub fn nondimensional(&self) -> Device {
        let scales = Scales::of(self);
        let stack = self.layers * self.thickness;
        let time = scales.time.value();
        let shear = self.shear_modulus * stack;
        let surface = self.surfaces / (2.0 * shear);
        let permittivity = self.relative_permittivity * VACUUM_PERMITTIVITY;
        let slenderness = self.side / stack;
        Device {
            sheet: Parameters {
                aspect: slenderness * slenderness
                    + 12.0 * self.load_mass / (self.density * stack * stack * stack),
                surface_energy: self.surface_energy * surface,
                surface_tension: self.surface_tension * surface,
                surface_elasticity: self.surface_elasticity * surface,
            },
            elasticity: match self.elasticity {
                SiElasticity::NeoHookean => Elasticity::NeoHookean,
                SiElasticity::Gent { limit } => Elasticity::Gent(Locking::new(limit)),
                SiElasticity::Yeoh { second, third } => Elasticity::Yeoh { second, third },
            },
            spring: Spring {
                stiffness: self.load_spring / shear,
                rest: self.load_spring_length / self.side,
            },
            permittivity: Permittivity {
                terms: self.permittivity_terms,
            },
            damping: Damping {
                linear: self.linear_damping / (shear * time),
                viscosity: self.viscosity / (self.shear_modulus * time),
            },
            branches: std::array::from_fn(|k| Branch {
                modulus: self.branch_moduli[k] / self.shear_modulus,
                relaxation_time: self.branch_times[k] / time,
                limit: self.branch_limits[k],
            }),
            port: Port {
                source: self.source,
                resistance: self.series_resistance / scales.resistance(),
                conductance: self.parallel_conductance * scales.resistance(),
                conductivity: self.conductivity * time / permittivity,
                conduction_field: self.conduction_field / scales.field,
            },
            breakdown: self.breakdown_field.is_finite().then(|| Breakdown {
                field: self.breakdown_field / scales.field,
                exponent: self.breakdown_exponent,
            }),
        }
    }
}
