//! Stored energies of a real actuator, in units of E0, and the powers that change them.
//!
//! ```text
//! kinetic M λ'²    elastic ½I, −½J ln(1 − I/J), ½(I + κ2 I² + κ3 I³)
//! surface 2[γ(λ²−1) + τλ²(λ²−1) + ½Eλ²(λ²−1)²]    spring k̄(λ − l̄)²
//! branch ½m I(λ²/g) or its Gent form    electric q²/(2λ⁴e)
//! lost per time: 2(b̄ + 6η̄λ⁻²)λ'²,  3 m τ̄ (g'/g)²,  r_s i²,  φ_m·leak
//! supplied: φ_s i (by a current source (φ_m + r_s i) i),  2Sλ'
//! ```
//!
//! Stored energy, minus supplied energy, plus lost energy is constant.

use super::elasticity::{Elasticity, invariant};
use super::equation::{Load, LocalDevice};
use super::geometry::Powers;
use super::parameters::Source;
use crate::arithmetic::jet::Dual;
use crate::solver::coupled::{LocalCoupledEquation, MOST_INTEGRALS, MOST_STATES, Stage};

/// Smallest size of the energies, in units of E0: a smaller energy is resolved relative to this.
const SMALL_ENERGY: f64 = 1e-9;

/// Stored energies in units of E0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stored {
    /// Of the motion, a load mass included.
    pub kinetic: f64,
    /// Of the elastic network.
    pub elastic: f64,
    /// Of the surfaces.
    pub surface: f64,
    /// Of the spring between the edges.
    pub spring: f64,
    /// Of the springs of the Maxwell branches.
    pub branches: f64,
    /// Of the electric field.
    pub electric: f64,
}

impl Stored {
    /// Their sum.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic + self.surface + self.spring + self.branches + self.electric
    }
}

/// Losses and supply: powers, or energies since the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exchanged {
    /// Lost by viscous damping.
    pub damping: f64,
    /// Lost in the dashpots of the Maxwell branches.
    pub branches: f64,
    /// Lost in the series resistance.
    pub series: f64,
    /// Lost by leakage.
    pub leakage: f64,
    /// Supplied by the electrical source.
    pub electrical: f64,
    /// Supplied by the prestress.
    pub mechanical: f64,
}

impl Exchanged {
    /// As a row, in the order of the integrals of the motion.
    #[must_use]
    pub fn all(&self) -> [f64; MOST_INTEGRALS] {
        [
            self.damping,
            self.branches,
            self.series,
            self.leakage,
            self.electrical,
            self.mechanical,
        ]
    }

    /// From the integrals of a motion.
    #[must_use]
    pub fn from_integrals(all: &[f64; MOST_INTEGRALS]) -> Exchanged {
        let [damping, branches, series, leakage, electrical, mechanical] = *all;
        Exchanged {
            damping,
            branches,
            series,
            leakage,
            electrical,
            mechanical,
        }
    }

    /// Supply minus losses: the gain of the stored energy.
    #[must_use]
    pub fn gain(&self) -> f64 {
        let lost = self.damping + self.branches + self.series + self.leakage;
        self.electrical + self.mechanical - lost
    }
}

impl LocalDevice<'_> {
    /// The stored energies at `offset` after the origin of time.
    #[must_use]
    pub fn stored(&self, offset: f64, stage: &Stage) -> Stored {
        let device = self.device;
        let load = self.load(offset);
        let p = Powers::of(self.stretch(stage.position));
        let i = invariant(p.square);
        let elastic = match &device.elasticity {
            Elasticity::NeoHookean => 0.5 * i,
            Elasticity::Gent(locking) => {
                let gap = self.gap(locking, stage.position);
                // ln(1 + x) is accurate for small x.
                let logarithm = if gap > 0.5 {
                    (-i / locking.limit()).ln_1p()
                } else {
                    gap.ln()
                };
                -0.5 * locking.limit() * logarithm
            }
            Elasticity::Yeoh { second, third } => 0.5 * i * (1.0 + i * (second + i * third)),
        };
        let growth = (p.stretch - 1.0) * (p.stretch + 1.0);
        let sheet = &device.sheet;
        let surface = 2.0
            * growth
            * (sheet.surface_energy
                + p.square * (sheet.surface_tension + 0.5 * sheet.surface_elasticity * growth));
        let extension = p.stretch - device.spring.rest;
        let mut branches = 0.0;
        for (k, branch) in device.present_branches().enumerate() {
            let i = invariant(p.square / self.branch_state(&stage.internal, k));
            branches += 0.5
                * branch.modulus
                * if branch.limit.is_infinite() {
                    i
                } else {
                    -branch.limit * (-i / branch.limit).ln_1p()
                };
        }
        let voltage = self.membrane_voltage(&load, stage);
        let inverse_sixth = p.inverse_fourth * p.inverse_square;
        Stored {
            kinetic: (sheet.aspect + 2.0 * inverse_sixth) * stage.rate * stage.rate,
            elastic,
            surface,
            spring: device.spring.stiffness * extension * extension,
            branches,
            electric: 0.5 * self.capacitance(p.stretch) * voltage * voltage,
        }
    }

    /// The current into the actuator at `offset`, where z' has these `slopes`.
    #[must_use]
    pub fn current(&self, offset: f64, stage: &Stage, slopes: &[f64; MOST_STATES]) -> f64 {
        let load = self.load(offset);
        let port = &self.device.port;
        let charging = match port.source {
            Source::Current => return load.source,
            Source::Charge => self.drive.voltage(Dual::new(offset, 1.0)).slope(),
            Source::Voltage if self.device.has_charge_state() => slopes[0],
            Source::Voltage => {
                let stretch = Dual::new(self.stretch(stage.position), stage.rate);
                let voltage = self.drive.voltage(Dual::new(offset, 1.0));
                (self.capacitance(stretch) * voltage).slope()
            }
        };
        charging + self.leak(&load, stage)
    }

    /// The current that leaks through the material and beside it.
    #[must_use]
    pub fn leak(&self, load: &Load, stage: &Stage) -> f64 {
        let stretch = self.stretch(stage.position);
        let voltage = self.membrane_voltage(load, stage);
        voltage * self.conductance(voltage, stretch * stretch)[0]
    }

    /// The powers of losses and supply at `offset`, where z' has these `slopes`.
    #[must_use]
    pub fn powers_at(&self, offset: f64, stage: &Stage, slopes: &[f64; MOST_STATES]) -> Exchanged {
        let device = self.device;
        let load = self.load(offset);
        let stretch = self.stretch(stage.position);
        let damping = device.damping.coefficient(stretch);
        let mut branches = 0.0;
        for (k, branch) in device.present_branches().enumerate() {
            let strain_rate = self.branch_state(slopes, k) / self.branch_state(&stage.internal, k);
            branches += 3.0 * branch.modulus * branch.relaxation_time * strain_rate * strain_rate;
        }
        let current = self.current(offset, stage, slopes);
        let voltage = self.membrane_voltage(&load, stage);
        let series = device.port.resistance * current;
        let supply = match device.port.source {
            Source::Voltage => load.source,
            Source::Current | Source::Charge => voltage + series,
        };
        Exchanged {
            damping: 2.0 * damping * stage.rate * stage.rate,
            branches,
            series: series * current,
            leakage: voltage * self.leak(&load, stage),
            electrical: supply * current,
            mechanical: 2.0 * load.prestress * stage.rate,
        }
    }

    /// The energies, in units of E0, that an ideal source exchanges at once when it jumps from `previous` to its
    /// present value. A jump ∆V at a capacitance C loses C∆V²/2 in the resistance, however small that is.
    #[must_use]
    pub fn exchanged_by_step(&self, previous: f64, stage: &Stage) -> Exchanged {
        let mut exchanged = Exchanged::from_integrals(&[0.0; MOST_INTEGRALS]);
        let (source, capacitance) = (
            self.load(0.0).source,
            self.capacitance(self.stretch(stage.position)),
        );
        let step = source - previous;
        match self.device.port.source {
            Source::Voltage if !self.device.has_charge_state() => {
                exchanged.electrical = source * capacitance * step;
                exchanged.series = 0.5 * capacitance * step * step;
            }
            Source::Charge => {
                exchanged.electrical = 0.5 * (source + previous) * step / capacitance;
            }
            Source::Voltage | Source::Current => {}
        }
        exchanged
    }

    /// The breakdown field minus the true field; infinite where no breakdown field is given.
    #[must_use]
    pub fn breakdown_margin(&self, load: &Load, stage: &Stage) -> f64 {
        let Some(breakdown) = &self.device.breakdown else {
            return f64::INFINITY;
        };
        let stretch = self.stretch(stage.position);
        let field = self.membrane_voltage(load, stage) * stretch * stretch;
        breakdown.field * stretch.powf(breakdown.exponent) - field.abs()
    }

    /// The typical size of the energies around a stage.
    pub(super) fn energy_size(&self, stage: &Stage, charge: f64, frequency: f64) -> f64 {
        let stored = self.stored(0.0, stage);
        let capacitance = self.capacitance(self.stretch(stage.position));
        let electric = match self.device.port.source {
            Source::Voltage => {
                let voltage = self.drive.voltage_size();
                0.5 * capacitance * voltage * voltage
            }
            _ => 0.5 * charge * charge / capacitance,
        };
        // The kinetic energy that the forces at this stage may give.
        let [force, inertia, _] = self.forces(&self.load(0.0), stage);
        let swing = force / frequency;
        stored.total() + electric + swing * swing / inertia + SMALL_ENERGY
    }

    /// The largest voltage at the membrane now or in the near future.
    pub(super) fn largest_membrane_voltage(&self, stage: &Stage) -> f64 {
        let load = self.load(0.0);
        let present = self.membrane_voltage(&load, stage).abs();
        match self.device.port.source {
            Source::Voltage => present.max(self.drive.largest_voltage()),
            Source::Current => present,
            Source::Charge => {
                self.drive.largest_voltage() / self.capacitance(self.stretch(stage.position))
            }
        }
    }
}
