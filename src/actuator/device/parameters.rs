//! The parameters of a real actuator: the sheet of the paper with a load, losses, stiffening and an
//! electrical port. All numbers are nondimensional, in the units of [`super::super::scales`]. By default nothing
//! is added to the sheet.

use serde::{Deserialize, Serialize};

use super::elasticity::Elasticity;
use crate::actuator::{Coefficients, Parameters};
use crate::arithmetic::number::{Number, Parameter, ParameterOf};

/// Maxwell branches that an actuator may have.
pub const MOST_BRANCHES: usize = 3;

/// A real actuator.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Device<P = f64> {
    /// The sheet (Eq. 15 of the paper). Its aspect c is L²/T² with the thickness T of the whole
    /// stack; a load mass adds 12m/(ρT³).
    pub sheet: Parameters<P>,
    /// The law of its elastic stiffness.
    pub elasticity: Elasticity<P>,
    /// A spring between opposite edges.
    pub spring: Spring<P>,
    /// How the permittivity depends on the stretch.
    pub permittivity: Permittivity<P>,
    /// Viscous losses.
    pub damping: Damping<P>,
    /// Maxwell branches; those with a modulus of 0 are absent.
    pub branches: [Branch<P>; MOST_BRANCHES],
    /// The electrical port.
    pub port: Port<P>,
    /// The true field at which the material breaks down.
    pub breakdown: Option<Breakdown<P>>,
}

/// A spring between opposite edges, in each direction: force k̄(λ − l̄).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spring<P = f64> {
    /// k̄ = k/(µT).
    pub stiffness: P,
    /// l̄, the stretch at which it is relaxed.
    pub rest: P,
}

/// e(λ) = ε(λ)/ε(1) = 1 + k1 x + k2 x² + k3 x³, x = λ − 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Permittivity<P = f64> {
    /// k1, k2, k3.
    pub terms: [P; 3],
}

/// Viscous losses.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Damping<P = f64> {
    /// b̄ = b/(µTt0), a dashpot between opposite edges in each direction.
    pub linear: P,
    /// η̄ = η/(µt0), Kelvin–Voigt: a Newtonian viscosity beside the elastic stress.
    pub viscosity: P,
}

/// A Maxwell branch: a spring in series with a Newtonian dashpot (C. C. Foo, S. Cai, S. J. A.
/// Koh, S. Bauer, Z. Suo, J. Appl. Phys. 111 (2012) 034102). Its state is g = ξ², the squared
/// stretch of the dashpot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Branch<P = f64> {
    /// m = µ_k/µ.
    pub modulus: P,
    /// τ̄ = τ/t0.
    pub relaxation_time: P,
    /// The limit J of its own Gent spring; infinite for a neo-Hookean one.
    pub limit: P,
}

/// What the source imposes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Source {
    /// The supply voltage.
    Voltage,
    /// The current into the actuator.
    Current,
    /// The charge on the electrodes.
    Charge,
}

/// The electrical port.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Port<P = f64> {
    /// What the source imposes.
    pub source: Source,
    /// r_s = R_s C0/t0, the resistance in series; 0 for an ideal source.
    pub resistance: P,
    /// ḡ_p = G_p t0/C0, a fixed conductance in parallel.
    pub conductance: P,
    /// σ̄ = σ t0/ε, the conductivity of the material at a weak field.
    pub conductivity: P,
    /// Ē_c, the field over which the conductivity grows by e: σ̄ exp(E/Ē_c); infinite for none.
    pub conduction_field: P,
}

impl Port {
    /// Whether the current of the leak, σ̄ E exp(|E|/Ē_c), bends where the field E changes its sign: its second derivative
    /// jumps there.
    #[must_use]
    pub fn leak_bends(&self) -> bool {
        self.conductivity > 0.0 && self.conduction_field.is_finite()
    }
}

/// The breakdown field E_b λⁿ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Breakdown<P = f64> {
    /// E_b at λ = 1, in units of V0/H.
    pub field: P,
    /// n.
    pub exponent: P,
}

/// The damping at λ = 1, over √(c + 2), from which it is strong: a damping ratio of 0.8. Up to a ratio of 1 the
/// integrator of the paper's equation was the faster one on a step and on an alternating voltage.
const STRONG_DAMPING: f64 = 4.0;

impl Device {
    /// The actuator of the paper: the sheet alone, with an ideal voltage source.
    #[must_use]
    pub const fn plain(sheet: Parameters) -> Device {
        Device {
            sheet,
            elasticity: Elasticity::NeoHookean,
            spring: Spring {
                stiffness: 0.0,
                rest: 1.0,
            },
            permittivity: Permittivity { terms: [0.0; 3] },
            damping: Damping::NONE,
            branches: [Branch::NONE; MOST_BRANCHES],
            port: Port {
                source: Source::Voltage,
                resistance: 0.0,
                conductance: 0.0,
                conductivity: 0.0,
                conduction_field: f64::INFINITY,
            },
            breakdown: None,
        }
    }

    /// Whether the paper's equation describes the motion, with damping or without. A load mass and a spring may be
    /// there: they are folded into its coefficients ([`Device::folded`]) and the prestress ([`Spring::preload`]).
    /// Strong damping is left to the integrator of coupled systems, which solves stiff ones.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        self.elasticity == Elasticity::NeoHookean
            && self.permittivity.is_constant()
            && self.damping.coefficient(1.0) <= STRONG_DAMPING * (self.sheet.aspect + 2.0).sqrt()
            && self.branches.iter().all(|branch| branch.modulus == 0.0)
            && self.port.source == Source::Voltage
            && self.port.resistance == 0.0
            && self.breakdown.is_none()
    }
}

impl<P: Parameter> Device<P> {
    /// The coefficients of Eq. 16 with the spring.
    #[must_use]
    pub fn folded(&self) -> Coefficients<P> {
        let mut folded = Coefficients::fold(&self.sheet);
        folded.linear = folded.linear + self.spring.stiffness;
        folded
    }

    /// Whether the charge is a state: it does not follow from the voltage, and the source does not impose it.
    #[must_use]
    pub fn has_charge_state(&self) -> bool {
        match self.port.source {
            Source::Voltage => self.port.resistance.value() > 0.0,
            Source::Current => true,
            Source::Charge => false,
        }
    }

    /// The branches that are present.
    pub fn present_branches(&self) -> impl Iterator<Item = &Branch<P>> {
        self.branches.iter().filter(|branch| branch.is_present())
    }
}

impl<P: Parameter> Branch<P> {
    /// Whether it takes part.
    #[inline(always)]
    pub(super) fn is_present(&self) -> bool {
        self.modulus.value() > 0.0
    }
}

impl<P: Parameter> Spring<P> {
    /// k̄l̄, its contribution to the prestress.
    #[must_use]
    pub fn preload(&self) -> P {
        self.stiffness * self.rest
    }
}

impl Source {
    /// The name of what it imposes.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Source::Voltage => "voltage",
            Source::Current => "current",
            Source::Charge => "charge",
        }
    }
}

impl Permittivity {
    /// The stretches at which e has an extreme; NaN for one that does not exist.
    #[must_use]
    pub fn extremes(&self) -> [f64; 2] {
        let [k1, k2, k3] = self.terms;
        if k3 == 0.0 {
            return [1.0 - 0.5 * k1 / k2, f64::NAN];
        }
        let root = (k2 * k2 - 3.0 * k1 * k3).sqrt();
        [(root - k2) / (3.0 * k3), (-root - k2) / (3.0 * k3)].map(|x| 1.0 + x)
    }
}

impl<P: Parameter> Permittivity<P> {
    /// Whether it does not depend on the stretch.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.terms.iter().all(|term| term.is_nothing())
    }
}

impl Damping {
    /// No losses.
    pub const NONE: Damping = Damping {
        linear: 0.0,
        viscosity: 0.0,
    };

    /// Whether there are no losses.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Damping::NONE
    }

    /// The damping force over the rate, at a stretch.
    #[must_use]
    pub fn coefficient(&self, stretch: f64) -> f64 {
        self.scaled([1.0, 1.0 / (stretch * stretch)])
    }
}

impl<P: Parameter> Damping<P> {
    /// The damping force over the rate, (b̄ + 6η̄λ⁻²), times a factor; given are the factor and that times λ⁻².
    #[must_use]
    #[inline(always)]
    pub fn scaled<N: Number>(&self, [factor, by_square]: [N; 2]) -> N
    where
        P: ParameterOf<N>,
    {
        let Damping { linear, viscosity } = *self;
        let viscous = factor.same(6.0) * viscosity.lift(factor);
        viscous.mul_add(by_square, linear.lift(factor) * factor)
    }
}

impl Branch {
    /// No branch.
    pub const NONE: Branch = Branch {
        modulus: 0.0,
        relaxation_time: 1.0,
        limit: f64::INFINITY,
    };
}
