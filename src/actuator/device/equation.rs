//! The equation of motion of a real actuator, its first-order states and its powers.
//!
//! With the inertia M = c + 2λ⁻⁶, the elastic factor h (see [`super::elasticity`]) and the
//! folded coefficients of Eq. 16 of the paper,
//!
//! ```text
//! M λ'' = 6λ⁻⁷λ'² − (λ − λ⁻⁵)h − (a1 − 1)λ − a3 λ³ − a5 λ⁵ + S + k̄l̄ + F_e
//!         − (b̄ + 6η̄λ⁻²)λ' − Σ m_k h_k (λ/g_k − g_k²λ⁻⁵)
//! F_e   = φ_m² (λ³e + ¼λ⁴e'),   φ_m = q/(λ⁴e)
//! q'    = i − φ_m [ḡ_p + σ̄λ⁴ exp(|φ_m|λ²/Ē_c)],   i = (φ_s − φ_m)/r_s
//! g_k'  = (λ² − g_k³λ⁻⁴) h_k/(3τ̄_k)
//! ```
//!
//! These follow from the energies and dissipations of [`super::energy`]; the balance is tested.

use super::elasticity::{Elasticity, invariant};
use super::geometry::{Geometry, Powers};
use super::parameters::{Branch, Device, Source};
use crate::actuator::Drive;
use crate::actuator::drive::LocalDrive;
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::jet::Dual;
use crate::arithmetic::number::{Number, Parameter, ParameterOf};
use crate::solver::coupled::{MOST_STATES, Slope, Stage};

/// The drive at one time, or at lanes of times.
#[derive(Clone, Copy, Debug)]
pub struct Load<N = f64> {
    /// The voltage, current or charge of the source.
    pub source: N,
    /// S, the prestress, without the preload of the spring.
    pub prestress: N,
}

/// A [`Device`] with the origins of time and stretch moved.
#[derive(Clone, Copy, Debug)]
pub struct LocalDevice<'a, P = f64> {
    pub(super) device: &'a Device<P>,
    pub(super) drive: LocalDrive<'a>,
    /// The stretch at position 0.
    pub(super) origin: f64,
    /// Both locking stretches, counted from there.
    pub(super) walls: [P; 2],
    /// a1 − 1, with the spring; a3, a5 of the folded equation, and k̄l̄.
    pub(super) linear: P,
    pub(super) cubic: P,
    pub(super) quintic: P,
    pub(super) preload: P,
    has_charge: bool,
}

impl<'a, P: Parameter> LocalDevice<'a, P> {
    /// The device under a drive, seen from a time and an origin of the stretch.
    #[must_use]
    pub fn new(
        device: &'a Device<P>,
        drive: &'a Drive,
        time: &DoubleDouble,
        origin: &DoubleDouble,
    ) -> Self {
        let folded = device.folded();
        let walls = match &device.elasticity {
            Elasticity::Gent(locking) => locking.walls(*origin),
            _ => [f64::INFINITY, f64::NEG_INFINITY].map(|wall| folded.linear.same(wall)),
        };
        LocalDevice {
            device,
            drive: drive.at(time),
            origin: origin.value(),
            walls,
            linear: folded.linear - folded.linear.same(1.0),
            cubic: folded.cubic,
            quintic: folded.quintic,
            preload: device.spring.preload(),
            has_charge: device.has_charge_state(),
        }
    }

    /// Both locking stretches, counted from the origin.
    pub(super) fn walls(&self) -> [P; 2] {
        self.walls
    }

    /// The coefficients of λ, λ³ and λ⁵ without the elastic ones.
    pub(super) fn surface(&self) -> [P; 3] {
        [self.linear, self.cubic, self.quintic]
    }

    /// The state of the k-th branch that is present.
    #[inline(always)]
    pub(super) fn branch_state<T: Copy>(&self, internal: &[T; MOST_STATES], k: usize) -> T {
        internal[k + usize::from(self.has_charge)]
    }

    /// The voltage at the membrane φ_m.
    #[inline(always)]
    pub fn membrane_voltage<N: Number>(&self, load: &Load<N>, stage: &Stage<N>) -> N
    where
        P: ParameterOf<N>,
    {
        let powers = Powers::of(self.stretch(stage.position));
        self.voltage(load, stage, self.elastance(&powers))
    }

    #[inline(always)]
    fn voltage<N: Number>(&self, load: &Load<N>, stage: &Stage<N>, elastance: N) -> N {
        let charge = match self.device.port.source {
            Source::Voltage if !self.has_charge => return load.source,
            Source::Charge => load.source,
            Source::Voltage | Source::Current => stage.internal[0],
        };
        charge * elastance
    }

    /// The leakage conductance G, and V dG/dV.
    #[inline(always)]
    pub fn conductance<N: Number>(&self, voltage: N, square: N) -> [N; 2]
    where
        P: ParameterOf<N>,
    {
        let port = &self.device.port;
        let number = |value: f64| square.same(value);
        let fixed = port.conductance.lift(square);
        if port.conductivity.is_nothing() {
            return [fixed, number(0.0)];
        }
        let weak = port.conductivity.lift(square) * square * square;
        let field = port.conduction_field;
        if field.value().is_infinite() {
            return [fixed + weak, number(0.0)];
        }
        let ratio = voltage.magnitude() * square * (field.same(1.0) / field).lift(square);
        let strong = weak * ratio.exp();
        [fixed + strong, strong * ratio]
    }

    /// The force without the damping, the inertia, and the damping: x'' is (force − damping ·
    /// x')/inertia.
    #[inline(always)]
    pub fn forces<N: Number>(&self, load: &Load<N>, stage: &Stage<N>) -> [N; 3]
    where
        P: ParameterOf<N>,
    {
        self.forces_in(load, &self.geometry_at(stage.position), stage)
    }

    /// [`LocalDevice::forces`] in this geometry.
    #[inline(always)]
    pub(super) fn forces_in<N: Number>(
        &self,
        load: &Load<N>,
        geometry: &Geometry<N>,
        stage: &Stage<N>,
    ) -> [N; 3]
    where
        P: ParameterOf<N>,
    {
        let voltage = self.voltage(load, stage, geometry.elastance);
        self.forces_under(load.prestress, voltage, geometry, stage)
    }

    /// [`LocalDevice::forces`] under this voltage at the membrane.
    #[inline(always)]
    fn forces_under<N: Number>(
        &self,
        prestress: N,
        voltage: N,
        geometry: &Geometry<N>,
        stage: &Stage<N>,
    ) -> [N; 3]
    where
        P: ParameterOf<N>,
    {
        let (device, p) = (self.device, &geometry.powers);
        let number = |value: f64| p.stretch.same(value);
        let inverse_sixth = p.inverse_fourth * p.inverse_square;
        let inertial = number(6.0) * inverse_sixth * p.inverse * stage.rate * stage.rate;
        let mut force =
            inertial - geometry.restoring + prestress + voltage * voltage * geometry.pull;
        for (k, branch) in device.present_branches().enumerate() {
            let g = self.branch_state(&stage.internal, k);
            let pull = p.stretch / g - g * g * p.inverse_fifth;
            let modulus = branch.modulus.lift(p.stretch);
            force = force - modulus * branch.stiffening(p.square / g) * pull;
        }
        let damping = device.damping.scaled([number(1.0), p.inverse_square]);
        [force, geometry.inertia, damping]
    }

    /// z' of the charge, where it is a state, and of the branches.
    #[inline(always)]
    pub fn first_order<N: Number>(
        &self,
        load: &Load<N>,
        stage: &Stage<N>,
    ) -> [Slope<N>; MOST_STATES]
    where
        P: ParameterOf<N>,
    {
        let zero = stage.position.same(0.0);
        let mut slopes = [Slope {
            value: zero,
            relaxation: zero,
        }; MOST_STATES];
        let geometry = self.geometry_at(stage.position);
        let states = usize::from(self.has_charge) + self.device.present_branches().count();
        for (k, slope) in slopes.iter_mut().enumerate().take(states) {
            *slope = self.first_order_of(k, load, &geometry, stage);
        }
        slopes
    }

    /// z' of the k-th state.
    #[inline(always)]
    pub(super) fn first_order_of<N: Number>(
        &self,
        k: usize,
        load: &Load<N>,
        geometry: &Geometry<N>,
        stage: &Stage<N>,
    ) -> Slope<N>
    where
        P: ParameterOf<N>,
    {
        if self.has_charge && k == 0 {
            return self.charge_slope(load, geometry, stage);
        }
        // No closure, which would not be compiled for the SIMD level.
        let mut place = k - usize::from(self.has_charge);
        for branch in &self.device.branches {
            if branch.is_present() {
                if place == 0 {
                    return branch.slope(stage.internal[k], &geometry.powers);
                }
                place -= 1;
            }
        }
        let zero = stage.position.same(0.0);
        Slope {
            value: zero,
            relaxation: zero,
        }
    }

    #[inline(always)]
    fn charge_slope<N: Number>(
        &self,
        load: &Load<N>,
        geometry: &Geometry<N>,
        stage: &Stage<N>,
    ) -> Slope<N>
    where
        P: ParameterOf<N>,
    {
        let Geometry {
            powers, elastance, ..
        } = geometry;
        let voltage = stage.internal[0] * *elastance;
        let [conductance, steeper] = self.conductance(voltage, powers.square);
        let leak = voltage * conductance;
        let port = &self.device.port;
        if port.source == Source::Current {
            return Slope {
                value: load.source - leak,
                relaxation: (conductance + steeper) * *elastance,
            };
        }
        let series = (port.resistance.same(1.0) / port.resistance).lift(powers.square);
        Slope {
            value: (load.source - voltage) * series - leak,
            relaxation: (series + conductance + steeper) * *elastance,
        }
    }
}

impl LocalDevice<'_> {
    /// The angular frequency of small oscillations around a stage; 0 where the stage is unstable. A source of
    /// voltage holds the voltage at the membrane, a source of current or charge holds the charge, and the
    /// dashpots do not move.
    #[must_use]
    pub fn small_signal_frequency(&self, load: &Load, stage: &Stage) -> f64 {
        let fixed = |value: f64| Dual::constant(value);
        let position = Dual::new(stage.position, 1.0);
        let stretch = self.stretch(position);
        let voltage = self.membrane_voltage(load, stage);
        let held = match self.device.port.source {
            Source::Voltage => fixed(voltage),
            Source::Current | Source::Charge => {
                let charge = voltage * self.capacitance(self.stretch(stage.position));
                fixed(charge) / self.capacitance(stretch)
            }
        };
        let still = Stage {
            position,
            rate: fixed(0.0),
            internal: stage.internal.map(fixed),
        };
        let geometry = self.geometry_at(position);
        let [force, inertia, _] = self.forces_under(fixed(load.prestress), held, &geometry, &still);
        (-force.slope() / inertia.term[0]).max(0.0).sqrt()
    }
}

impl<P: Parameter> Branch<P> {
    /// h of its spring at s = λ²/g.
    #[inline(always)]
    pub(super) fn stiffening<N: Number>(&self, s: N) -> N
    where
        P: ParameterOf<N>,
    {
        let one = s.same(1.0);
        if self.limit.value().is_infinite() {
            return one;
        }
        one / (one - invariant(s) * (self.limit.same(1.0) / self.limit).lift(s))
    }

    /// g' of its state g.
    #[inline(always)]
    fn slope<N: Number>(&self, g: N, p: &Powers<N>) -> Slope<N>
    where
        P: ParameterOf<N>,
    {
        let number = |value: f64| g.same(value);
        let time = self.relaxation_time;
        let third = (time.same(1.0) / (time.same(3.0) * time)).lift(g);
        let s = p.square / g;
        let h = self.stiffening(s);
        let pull = p.square - g * g * g * p.inverse_fourth;
        let mut relaxation = number(3.0) * g * g * p.inverse_fourth * h;
        if self.limit.value().is_finite() {
            // ∂h/∂g = −(2h²/J)(s − s⁻²)/g.
            let steep = (s - number(1.0) / (s * s)) / g;
            let factor = (self.limit.same(2.0) / self.limit).lift(g);
            relaxation = relaxation + pull * h * h * factor * steep;
        }
        Slope {
            value: third * pull * h,
            relaxation: third * relaxation,
        }
    }
}
