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
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::jet::Dual;
use crate::arithmetic::number::{Number, Parameter};

/// ε0 in F/m (CODATA 2022).
pub const VACUUM_PERMITTIVITY: f64 = 8.854_187_818_8e-12;

/// A real actuator in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SiDevice<P = f64> {
    /// µ in Pa, the shear modulus (2·C10 of a Yeoh material).
    pub shear_modulus: P,
    /// ρ in kg/m³.
    pub density: P,
    /// ε/ε0 at λ = 1.
    pub relative_permittivity: P,
    /// H in m, the thickness of a layer.
    pub thickness: P,
    /// L in m, the side of the sheet.
    pub side: P,
    /// n, the number of layers.
    pub layers: P,
    /// Surface energy in N/m.
    pub surface_energy: P,
    /// Surface tension in N/m.
    pub surface_tension: P,
    /// Surface elasticity in N/m.
    pub surface_elasticity: P,
    /// The number of surfaces that carry surface energy; 2, the outer faces, in the paper.
    pub surfaces: P,
    /// The law of its elastic stiffness, nondimensional.
    pub elasticity: SiElasticity<P>,
    /// m in kg, the reduced mass of what sits on opposite edges, in each direction.
    pub load_mass: P,
    /// k in N/m, a spring between opposite edges, in each direction.
    pub load_spring: P,
    /// The length in m at which the spring is relaxed.
    pub load_spring_length: P,
    /// k1, k2, k3 of the permittivity, nondimensional.
    pub permittivity_terms: [P; 3],
    /// b in N s/m, a dashpot between opposite edges, in each direction.
    pub linear_damping: P,
    /// η in Pa s, Kelvin–Voigt.
    pub viscosity: P,
    /// The moduli µ_k of the Maxwell branches in Pa; 0 for none.
    pub branch_moduli: [P; MOST_BRANCHES],
    /// Their relaxation times in s.
    pub branch_times: [P; MOST_BRANCHES],
    /// The limits J of their Gent springs; infinite for neo-Hookean ones.
    pub branch_limits: [P; MOST_BRANCHES],
    /// What the source imposes.
    pub source: Source,
    /// R_s in Ω, in series; 0 for an ideal source.
    pub series_resistance: P,
    /// G_p in S, a fixed conductance in parallel.
    pub parallel_conductance: P,
    /// σ in S/m, the conductivity of the material at a weak field.
    pub conductivity: P,
    /// The field in V/m over which the conductivity grows by e; infinite for none.
    pub conduction_field: P,
    /// The true breakdown field in V/m at λ = 1; infinite for none.
    pub breakdown_field: P,
    /// n of E_b λⁿ.
    pub breakdown_exponent: P,
}

/// The law of the elastic stiffness by its nondimensional constants.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum SiElasticity<P = f64> {
    /// No stiffening.
    NeoHookean,
    /// Gent with the limit J.
    Gent {
        /// J.
        limit: P,
    },
    /// Yeoh with κ_j = C_j0/C10.
    Yeoh {
        /// κ2.
        second: P,
        /// κ3.
        third: P,
    },
}

/// The units of the nondimensional numbers, in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scales<P = f64> {
    /// t0 in s.
    pub time: P,
    /// 1/t0 in 1/s, as a double-double number.
    pub exact_frequency: DoubleDouble,
    /// V0 in V.
    pub voltage: P,
    /// Q0 in C.
    pub charge: P,
    /// E0 in J.
    pub energy: P,
    /// P0 in N.
    pub force: P,
    /// C0 in F.
    pub capacitance: P,
    /// L in m.
    pub length: P,
    /// V0/H in V/m.
    pub field: P,
}

impl Scales {
    /// The scales of an actuator.
    #[must_use]
    pub fn of(device: &SiDevice) -> Scales {
        let ratio = DoubleDouble::new(device.density)
            .div(DoubleDouble::new(device.shear_modulus).scale(12.0));
        let exact_time = ratio
            .sqrt()
            .mul(DoubleDouble::new(device.layers).scale(device.thickness));
        let exact_frequency = DoubleDouble::ONE.div(exact_time);
        Scales::in_time(device, exact_time.value(), exact_frequency)
    }

    /// A time in s, as a nondimensional double-double number. It is converted as a whole, so
    /// that no rounding adds up from step to step.
    #[must_use]
    #[inline]
    pub fn time(&self, seconds: DoubleDouble) -> DoubleDouble {
        seconds.mul(self.exact_frequency)
    }

    /// The nondimensional time that a second takes.
    #[must_use]
    pub fn exact_frequency(&self) -> DoubleDouble {
        self.exact_frequency
    }

    /// Whether the numbers can be scales: to be checked where they do not come from this process.
    #[must_use]
    pub fn are_valid(&self) -> bool {
        let Scales {
            time,
            exact_frequency,
            voltage,
            charge,
            energy,
            force,
            capacitance,
            length,
            field,
        } = *self;
        let electrical = [voltage, charge, capacitance, field];
        let mechanical = [time, exact_frequency.value(), energy, force, length];
        let mut all = electrical.into_iter().chain(mechanical);
        all.all(|scale| scale > 0.0 && scale.is_finite())
    }
}

impl Scales<Dual> {
    /// The scales of an actuator that changes in a direction.
    #[must_use]
    pub fn along(device: &SiDevice<Dual>) -> Scales<Dual> {
        let ratio = device.density / (Dual::constant(12.0) * device.shear_modulus);
        let time = ratio.sqrt() * device.layers * device.thickness;
        let exact_frequency = DoubleDouble::ONE.div(DoubleDouble::new(time.value()));
        Scales::in_time(device, time, exact_frequency)
    }
}

impl<P: Parameter> Scales<P> {
    fn in_time(device: &SiDevice<P>, time: P, exact_frequency: DoubleDouble) -> Scales<P> {
        let (mu, side) = (device.shear_modulus, device.side);
        let permittivity = device.relative_permittivity * mu.same(VACUUM_PERMITTIVITY);
        let stack = device.layers * device.thickness;
        let field = (mu / permittivity).sqrt();
        Scales {
            time,
            exact_frequency,
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
    pub fn current(&self) -> P {
        self.charge / self.time
    }

    /// The unit of power in W.
    #[must_use]
    pub fn power(&self) -> P {
        self.energy / self.time
    }

    /// The unit of resistance in Ω.
    #[must_use]
    pub fn resistance(&self) -> P {
        self.time / self.capacitance
    }

    /// The unit of what the source imposes.
    #[must_use]
    pub fn source(&self, source: Source) -> P {
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
        self.in_scales(&Scales::of(self), Locking::new)
    }

    /// This actuator as it changes in a direction, whose numbers are the rates of change of those
    /// in their places.
    #[must_use]
    pub fn along(&self, change: &SiDevice) -> SiDevice<Dual> {
        macro_rules! dual {
            ($($name:ident),*; $($list:ident),*) => {
                SiDevice {
                    elasticity: SiElasticity::NeoHookean,
                    source: self.source,
                    $($name: Dual::new(self.$name, change.$name),)*
                    $($list: std::array::from_fn(|k| Dual::new(self.$list[k], change.$list[k])),)*
                }
            };
        }
        dual!(
            shear_modulus, density, relative_permittivity, thickness, side, layers,
            surface_energy, surface_tension, surface_elasticity, surfaces, load_mass, load_spring,
            load_spring_length, linear_damping, viscosity, series_resistance,
            parallel_conductance, conductivity, conduction_field, breakdown_field,
            breakdown_exponent;
            permittivity_terms, branch_moduli, branch_times, branch_limits
        )
    }
}

impl SiDevice<Dual> {
    /// [`SiDevice::nondimensional`] of an actuator that changes in a direction.
    #[must_use]
    pub fn nondimensional_along(&self) -> Device<Dual> {
        self.in_scales(&Scales::along(self), Locking::along)
    }
}

impl<P: Parameter> SiDevice<P> {
    fn in_scales(&self, scales: &Scales<P>, locking: fn(P) -> Locking<P>) -> Device<P> {
        let number = |value: f64| self.side.same(value);
        let stack = self.layers * self.thickness;
        let time = scales.time;
        let shear = self.shear_modulus * stack;
        let surface = self.surfaces / (number(2.0) * shear);
        let permittivity = self.relative_permittivity * number(VACUUM_PERMITTIVITY);
        let slenderness = self.side / stack;
        Device {
            sheet: Parameters {
                aspect: slenderness * slenderness
                    + number(12.0) * self.load_mass / (self.density * stack * stack * stack),
                surface_energy: self.surface_energy * surface,
                surface_tension: self.surface_tension * surface,
                surface_elasticity: self.surface_elasticity * surface,
            },
            elasticity: match self.elasticity {
                SiElasticity::NeoHookean => Elasticity::NeoHookean,
                SiElasticity::Gent { limit } => Elasticity::Gent(locking(limit)),
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
            breakdown: self.breakdown_field.value().is_finite().then(|| Breakdown {
                field: self.breakdown_field / scales.field,
                exponent: self.breakdown_exponent,
            }),
        }
    }
}
