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

use super::elasticity::{Elasticity, Locking, invariant};
use super::parameters::{Branch, Device, Permittivity, Source};
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
    origin: f64,
    /// Both locking stretches, counted from there.
    walls: [P; 2],
    /// a1 − 1, with the spring; a3, a5 of the folded equation, and k̄l̄.
    linear: P,
    cubic: P,
    quintic: P,
    preload: P,
    has_charge: bool,
}

/// The elastic state at a stretch.
#[derive(Clone, Copy)]
pub(super) struct Powers<N> {
    pub stretch: N,
    pub square: N,
    pub inverse: N,
    /// λ⁻², λ⁻⁴, λ⁻⁵.
    pub inverse_square: N,
    pub inverse_fourth: N,
    pub inverse_fifth: N,
}

impl<N: Number> Powers<N> {
    #[inline(always)]
    pub fn of(stretch: N) -> Powers<N> {
        let inverse = stretch.same(1.0) / stretch;
        let inverse_square = inverse * inverse;
        let inverse_fourth = inverse_square * inverse_square;
        Powers {
            stretch,
            square: stretch * stretch,
            inverse,
            inverse_square,
            inverse_fourth,
            inverse_fifth: inverse_fourth * inverse,
        }
    }
}

impl<P: Parameter> Permittivity<P> {
    /// e and e' at a stretch.
    #[inline(always)]
    pub fn at<N: Number>(&self, stretch: N) -> [N; 2]
    where
        P: ParameterOf<N>,
    {
        let number = |value: f64| stretch.same(value);
        let [k1, k2, k3] = self.terms;
        let [k1, k2, k3] = [k1.lift(stretch), k2.lift(stretch), k3.lift(stretch)];
        let x = stretch - number(1.0);
        let value = k3.mul_add(x, k2).mul_add(x, k1).mul_add(x, number(1.0));
        let slope = (number(3.0) * k3)
            .mul_add(x, number(2.0) * k2)
            .mul_add(x, k1);
        [value, slope]
    }

    /// λ³e + ¼λ⁴e', the factor of the squared voltage in the force.
    #[inline(always)]
    pub fn pull<N: Number>(&self, stretch: N) -> N
    where
        P: ParameterOf<N>,
    {
        let cube = stretch * stretch * stretch;
        if self.is_constant() {
            return cube;
        }
        let [value, slope] = self.at(stretch);
        cube * (stretch * slope).mul_add(stretch.same(0.25), value)
    }
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

    /// The stretch at a position.
    #[inline(always)]
    pub fn stretch<N: Number>(&self, position: N) -> N {
        position + position.same(self.origin)
    }

    /// 1 − I/J of a Gent material at a position.
    #[inline(always)]
    pub(super) fn gap<N: Number>(&self, locking: &Locking<P>, position: N) -> N
    where
        P: ParameterOf<N>,
    {
        let [largest, smallest] = self.walls.map(|wall| wall.lift(position));
        locking.gap(
            self.stretch(position),
            largest - position,
            position - smallest,
        )
    }

    /// The elastic factor h at a position.
    #[inline(always)]
    fn stiffening<N: Number>(&self, position: N, square: N) -> N
    where
        P: ParameterOf<N>,
    {
        let one = position.same(1.0);
        match &self.device.elasticity {
            Elasticity::NeoHookean => one,
            Elasticity::Gent(locking) => one / self.gap(locking, position),
            Elasticity::Yeoh { second, third } => {
                let number = |value: f64| position.same(value);
                let i = invariant(square);
                let [second, third] = [*second, *third].map(|factor| factor.lift(position));
                (number(3.0) * third)
                    .mul_add(i, number(2.0) * second)
                    .mul_add(i, one)
            }
        }
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
        let charge = match self.device.port.source {
            Source::Voltage if !self.has_charge => return load.source,
            Source::Charge => load.source,
            Source::Voltage | Source::Current => stage.internal[0],
        };
        charge / self.capacitance(self.stretch(stage.position))
    }

    /// λ⁴e, the capacitance.
    #[inline(always)]
    pub fn capacitance<N: Number>(&self, stretch: N) -> N
    where
        P: ParameterOf<N>,
    {
        let square = stretch * stretch;
        let fourth = square * square;
        if self.device.permittivity.is_constant() {
            return fourth;
        }
        fourth * self.device.permittivity.at(stretch)[0]
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
        self.forces_at(load.prestress, self.membrane_voltage(load, stage), stage)
    }

    /// [`LocalDevice::forces`] under this voltage at the membrane.
    #[inline(always)]
    fn forces_at<N: Number>(&self, prestress: N, voltage: N, stage: &Stage<N>) -> [N; 3]
    where
        P: ParameterOf<N>,
    {
        let device = self.device;
        let p = Powers::of(self.stretch(stage.position));
        let number = |value: f64| p.stretch.same(value);
        let lift = |parameter: P| parameter.lift(p.stretch);
        let inverse_sixth = p.inverse_fourth * p.inverse_square;
        let mut elastic = p.stretch - p.inverse_fifth;
        if !matches!(device.elasticity, Elasticity::NeoHookean) {
            elastic = elastic * self.stiffening(stage.position, p.square);
        }
        let surface = p.stretch
            * lift(self.quintic)
                .mul_add(p.square, lift(self.cubic))
                .mul_add(p.square, lift(self.linear));
        let electric = device.permittivity.pull(p.stretch);
        let inertial = number(6.0) * inverse_sixth * p.inverse * stage.rate * stage.rate;
        let mut force = inertial - elastic - surface
            + (prestress + lift(self.preload))
            + voltage * voltage * electric;
        for (k, branch) in device.present_branches().enumerate() {
            let g = self.branch_state(&stage.internal, k);
            let pull = p.stretch / g - g * g * p.inverse_fifth;
            force = force - lift(branch.modulus) * branch.stiffening(p.square / g) * pull;
        }
        let inertia = number(2.0).mul_add(inverse_sixth, lift(device.sheet.aspect));
        let damping = device.damping.scaled([number(1.0), p.inverse_square]);
        [force, inertia, damping]
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
        let p = Powers::of(self.stretch(stage.position));
        if self.has_charge {
            slopes[0] = self.charge_slope(load, stage, p.square);
        }
        for (k, branch) in self.device.present_branches().enumerate() {
            let g = self.branch_state(&stage.internal, k);
            slopes[k + usize::from(self.has_charge)] = branch.slope(g, &p);
        }
        slopes
    }

    #[inline(always)]
    fn charge_slope<N: Number>(&self, load: &Load<N>, stage: &Stage<N>, square: N) -> Slope<N>
    where
        P: ParameterOf<N>,
    {
        let number = |value: f64| square.same(value);
        let one = number(1.0);
        let capacitance = self.capacitance(self.stretch(stage.position));
        let voltage = stage.internal[0] / capacitance;
        let [conductance, steeper] = self.conductance(voltage, square);
        let leak = voltage * conductance;
        let port = &self.device.port;
        if port.source == Source::Current {
            return Slope {
                value: load.source - leak,
                relaxation: (conductance + steeper) / capacitance,
            };
        }
        let series = (port.resistance.same(1.0) / port.resistance).lift(square);
        Slope {
            value: (load.source - voltage) * series - leak,
            relaxation: (series + conductance + steeper) * (one / capacitance),
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
        let [force, inertia, _] = self.forces_at(fixed(load.prestress), held, &still);
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
