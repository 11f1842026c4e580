//! A real actuator under a drive, as a system for the integrator.

use serde::{Deserialize, Serialize};

use super::damped::DampedMotion;
use super::elasticity::Elasticity;
use super::equation::{Load, LocalDevice};
use super::geometry::{Geometry, Powers};
use super::parameters::{Device, Source};
use crate::actuator::{Drive, Motion};
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::number::Number;
use crate::solver::coupled::{
    CoupledEquation, LocalCoupledEquation, MOST_INTEGRALS, MOST_STATES, Sizes, Slope, Stage,
};

/// Closer to a locking stretch than this part of it, that stretch becomes the origin.
const NEAR_WALL: f64 = 0.2;

/// The origin moves back to 0 beyond this part of it.
const FAR_FROM_WALL: f64 = 0.3;

/// Smallest size of a charge, in units of Q0: a smaller charge is resolved relative to this.
const SMALL_CHARGE: f64 = 1e-4;

/// A real actuator under a drive. The voltage of the drive is what the source imposes: voltage, current or
/// charge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeviceMotion {
    /// The actuator.
    pub device: Device,
    /// The source and the prestress.
    pub drive: Drive,
    /// Whether supplied and lost energies are integrated (see [`super::energy`]).
    pub records_energy: bool,
}

impl DeviceMotion {
    /// Whether the paper's equation describes the motion, with damping or without, and no energies are integrated.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        self.device.is_plain() && !self.records_energy
    }

    /// The motion by the paper's equation without damping; of use where [`DeviceMotion::is_plain`].
    #[must_use]
    pub fn plain(&self) -> Motion {
        let mut drive = self.drive;
        let prestress = drive.prestress.value() + self.device.spring.preload();
        drive.prestress.set_value(prestress);
        Motion {
            coefficients: self.device.folded(),
            drive,
        }
    }

    /// The motion by the paper's equation with damping; of use where [`DeviceMotion::is_plain`].
    #[must_use]
    pub fn damped(&self) -> DampedMotion {
        DampedMotion {
            motion: self.plain(),
            damping: self.device.damping,
        }
    }
}

impl CoupledEquation for DeviceMotion {
    type Local<'a> = LocalDevice<'a>;

    fn at(&self, time: &DoubleDouble, origin: &DoubleDouble) -> LocalDevice<'_> {
        LocalDevice::new(&self.device, &self.drive, time, origin)
    }

    fn states(&self) -> usize {
        usize::from(self.device.has_charge_state()) + self.device.present_branches().count()
    }

    fn integrals(&self) -> usize {
        if self.records_energy {
            MOST_INTEGRALS
        } else {
            0
        }
    }

    fn is_autonomous(&self) -> bool {
        self.drive.is_constant()
    }

    fn is_time_reversible(&self) -> bool {
        self.device.damping.is_none() && self.states() == 0
    }

    /// Without a locking stretch, and without a leak that bends where the voltage changes its sign.
    fn is_regular(&self) -> bool {
        let device = &self.device;
        let mut branches = device.present_branches();
        !matches!(device.elasticity, Elasticity::Gent(_))
            && branches.all(|branch| branch.limit.is_infinite())
            && !(device.has_charge_state() && device.port.leak_bends())
    }

    fn awaits_event(&self) -> bool {
        self.device.breakdown.is_some()
    }

    fn origin_near(&self, position: f64, present: DoubleDouble) -> DoubleDouble {
        let Elasticity::Gent(locking) = &self.device.elasticity else {
            return DoubleDouble::ZERO;
        };
        let distance = |wall: DoubleDouble| present.sub(wall).plus(position).value().abs();
        let [above, below] = [locking.largest(), locking.smallest()];
        let wall = if distance(above) < distance(below) {
            above
        } else {
            below
        };
        let part = if wall == present {
            FAR_FROM_WALL
        } else {
            NEAR_WALL
        };
        if distance(wall) < part * wall.high {
            wall
        } else {
            DoubleDouble::ZERO
        }
    }
}

impl LocalCoupledEquation for LocalDevice<'_> {
    type Load<N: Number> = Load<N>;
    type Geometry<N: Number> = Geometry<N>;

    #[inline(always)]
    fn load<N: Number>(&self, offset: N) -> Load<N> {
        Load {
            source: self.drive.voltage(offset),
            prestress: self.drive.prestress(offset),
        }
    }

    #[inline(always)]
    fn harmonic(&self) -> Option<[f64; 2]> {
        self.drive.harmonic()
    }

    #[inline(always)]
    fn load_with_sine<N: Number>(&self, offset: N, sine: N) -> Load<N> {
        Load {
            source: self.drive.voltage_with_sine(offset, sine),
            prestress: self.drive.prestress(offset),
        }
    }

    #[inline(always)]
    fn geometry<N: Number>(&self, position: N) -> Geometry<N> {
        self.geometry_at(position)
    }

    #[inline(always)]
    fn slope<N: Number>(
        &self,
        k: usize,
        load: Load<N>,
        geometry: &Geometry<N>,
        stage: &Stage<N>,
    ) -> Slope<N> {
        self.first_order_of(k, &load, geometry, stage)
    }

    #[inline(always)]
    fn acceleration<N: Number>(
        &self,
        load: Load<N>,
        geometry: &Geometry<N>,
        stage: &Stage<N>,
    ) -> Slope<N> {
        let [force, inertia, damping] = self.forces_in(&load, geometry, stage);
        let inverse = inertia.same(1.0) / inertia;
        Slope {
            value: (force - damping * stage.rate) * inverse,
            relaxation: damping * inverse,
        }
    }

    fn powers(
        &self,
        offset: f64,
        stage: &Stage,
        slopes: &[f64; MOST_STATES],
    ) -> [f64; MOST_INTEGRALS] {
        self.powers_at(offset, stage, slopes).all()
    }

    fn admits(&self, stage: &Stage) -> bool {
        let stretch = self.stretch(stage.position);
        let device = self.device;
        let elastic = match &device.elasticity {
            Elasticity::Gent(locking) => {
                let [largest, smallest] = self.walls();
                stage.position < largest
                    && stage.position > smallest
                    && self.gap(locking, stage.position) > 0.0
            }
            _ => true,
        };
        let square = stretch * stretch;
        let branches = device.present_branches().enumerate().all(|(k, branch)| {
            let g = self.branch_state(&stage.internal, k);
            g > 0.0 && super::elasticity::invariant(square / g) < branch.limit
        });
        let permittivity =
            device.permittivity.is_constant() || device.permittivity.at(stretch)[0] > 0.0;
        stretch > 0.0 && elastic && branches && permittivity
    }

    /// Where the exponential leak goes through a voltage of 0, the third derivative of the charge jumps.
    fn bends_between(&self, begin: &Stage, end: &Stage) -> bool {
        let device = self.device;
        device.has_charge_state()
            && device.port.leak_bends()
            && begin.internal[0] * end.internal[0] <= 0.0
    }

    /// How far the true field is below that of breakdown.
    fn margin(&self, offset: f64, stage: &Stage) -> f64 {
        let load = self.load(offset);
        self.breakdown_margin(&load, stage)
    }

    fn load_frequency(&self) -> f64 {
        2.0 * self.drive.frequency()
    }

    /// √(stiffness/inertia), plus the relative rate at which the motion approaches a singularity. The terms of
    /// the stiffness are added by absolute value.
    fn natural_frequency(&self, stage: &Stage) -> f64 {
        let device = self.device;
        let p = Powers::of(self.stretch(stage.position));
        let sixth = p.inverse_fourth * p.inverse_square;
        let mut stiffness = 1.0 + 5.0 * sixth;
        match &device.elasticity {
            Elasticity::NeoHookean => {}
            Elasticity::Gent(locking) => {
                let h = 1.0 / self.gap(locking, stage.position).abs();
                let pull = p.stretch - p.inverse_fifth;
                stiffness = stiffness * h + 4.0 * pull * pull * h * h / locking.limit();
            }
            Elasticity::Yeoh { second, third } => {
                let i = super::elasticity::invariant(p.square);
                stiffness *= 1.0 + 6.0 * second.abs() * i + 15.0 * third.abs() * i * i;
            }
        }
        let [linear, cubic, quintic] = self.surface();
        stiffness += linear.abs() + p.square * (3.0 * cubic.abs() + p.square * 5.0 * quintic.abs());
        for (k, branch) in device.present_branches().enumerate() {
            let g = self.branch_state(&stage.internal, k);
            let h = branch.stiffening(p.square / g).abs();
            stiffness += branch.modulus * h * (1.0 / g + 5.0 * g * g * sixth);
        }
        let voltage = self.largest_membrane_voltage(stage);
        stiffness += 8.0 * voltage * voltage * p.square;
        let inertia = device.sheet.aspect + 2.0 * sixth;
        (stiffness / inertia).sqrt() + stage.rate.abs() / self.size_of(stage.position)
    }

    fn sizes(&self, stage: &Stage) -> Sizes {
        let position = self.size_of(stage.position);
        let frequency = self.natural_frequency(stage);
        let internal = self.state_sizes(stage, frequency);
        let charge = if self.device.has_charge_state() {
            internal[0]
        } else {
            0.0
        };
        let energy = self.energy_size(stage, charge, frequency);
        let stretch = self.stretch(stage.position);
        let inertia = self.device.sheet.aspect + 2.0 * stretch.powi(-6);
        Sizes {
            position,
            rate: position * frequency,
            internal,
            integrals: energy,
            swing: (energy / inertia).sqrt() / frequency,
        }
    }

    fn state_sizes(&self, stage: &Stage, frequency: f64) -> [f64; MOST_STATES] {
        let mut sizes = [1.0; MOST_STATES];
        if self.device.has_charge_state() {
            let source = self.drive.voltage_size();
            let driven = match self.device.port.source {
                Source::Voltage => source * self.capacitance(self.stretch(stage.position)),
                _ => source / frequency,
            };
            sizes[0] = stage.internal[0].abs().max(driven).max(SMALL_CHARGE);
        }
        let first = usize::from(self.device.has_charge_state());
        for place in 0..self.device.present_branches().count() {
            sizes[first + place] = stage.internal[first + place].abs();
        }
        sizes
    }

    /// The stretch, or the distance to a locking stretch where that is less.
    fn size_of(&self, position: f64) -> f64 {
        let [largest, smallest] = self.walls();
        self.stretch(position)
            .min(largest - position)
            .min(position - smallest)
    }
}
