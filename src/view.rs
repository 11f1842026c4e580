//! What a host can read of the actuator at the present communication point.
//! Each quantity is computed when it is read, and only then.

use crate::actuator::motion::{self, Load};
use crate::actuator::{Coefficients, Drive};
use crate::pull_in::{self, Threshold};
use crate::scene::{OnPullIn, Scene};
use crate::solver::State;
use crate::solver::double::Double;
use crate::solver::extremes::Extremes;
use crate::solver::limits::Limit;
use crate::solver::trajectory::Trajectory;

/// The moment at which the motion reached a limit of the stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collapse {
    /// The limit.
    pub limit: Limit,
    /// Time of the model.
    pub time: Double,
}

/// The actuator at the present time.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// What the host has set.
    pub scene: &'a Scene,
    /// The motion so far; none before it has begun.
    pub trajectory: Option<&'a Trajectory>,
    /// Time of the model.
    pub time: Double,
    /// Whether and when the motion came to a limit.
    pub collapse: Option<Collapse>,
}

impl View<'_> {
    /// Stretch λ.
    #[must_use]
    pub fn stretch(&self) -> f64 {
        match (self.held(), self.trajectory) {
            (Some(Limit::Lower), _) => self.scene.limits.lower,
            (Some(Limit::Upper), _) => self.scene.limits.upper,
            (None, Some(trajectory)) => trajectory.position(),
            (None, None) => self.scene.start.position,
        }
    }

    /// Stretch rate dλ/dt; 0 where the actuator is held at a limit.
    #[must_use]
    pub fn stretch_rate(&self) -> f64 {
        match (self.held(), self.trajectory) {
            (Some(_), _) => 0.0,
            (None, Some(trajectory)) => trajectory.rate(),
            (None, None) => self.scene.start.rate,
        }
    }

    /// d²λ/dt² by Eq. 16; 0 where the actuator is held at a limit.
    #[must_use]
    pub fn stretch_acceleration(&self) -> f64 {
        if self.held().is_some() {
            return 0.0;
        }
        motion::acceleration(
            &self.coefficients(),
            self.load(),
            self.stretch(),
            self.stretch_rate(),
        )
    }

    /// The extremes of the stretch since the start, where they are recorded.
    #[must_use]
    pub fn extremes(&self) -> Option<Extremes> {
        self.trajectory?.extremes()
    }

    /// The limit at which the actuator is held. Where the simulation ends
    /// instead, the state on arrival remains.
    fn held(&self) -> Option<Limit> {
        match self.scene.on_pull_in {
            OnPullIn::Hold => self.collapse.map(|collapse| collapse.limit),
            OnPullIn::Terminate => None,
        }
    }

    /// Thickness stretch λ3 = 1/λ².
    #[must_use]
    pub fn thickness_stretch(&self) -> f64 {
        let stretch = self.stretch();
        1.0 / (stretch * stretch)
    }

    /// dλ3/dt = −2 λ⁻³ dλ/dt.
    #[must_use]
    pub fn thickness_stretch_rate(&self) -> f64 {
        -2.0 * self.stretch_rate() / self.stretch().powi(3)
    }

    /// The voltage φ that the host drives, without the built-in drive.
    #[must_use]
    pub fn voltage(&self) -> f64 {
        let Drive { voltage, since, .. } = &self.scene.drive;
        voltage.at(self.time.since(*since))
    }

    /// Prestress S.
    #[must_use]
    pub fn prestress(&self) -> f64 {
        let Drive {
            prestress, since, ..
        } = &self.scene.drive;
        prestress.at(self.time.since(*since))
    }

    /// Voltage φ with the built-in alternating voltage added.
    #[must_use]
    pub fn total_voltage(&self) -> f64 {
        self.scene.drive.at(self.time).voltage(0.0)
    }

    /// The true electric field φλ², nondimensional like the voltage.
    #[must_use]
    pub fn electric_field(&self) -> f64 {
        let stretch = self.stretch();
        self.total_voltage() * stretch * stretch
    }

    /// The Hamiltonian 𝓗 of Eqs. 18 and 19 under the present load.
    #[must_use]
    pub fn energy(&self) -> f64 {
        let state = State {
            position: self.stretch(),
            rate: self.stretch_rate(),
        };
        motion::energy(&self.coefficients(), self.load(), state)
    }

    /// The dynamic pull-in threshold at the present prestress.
    #[must_use]
    pub fn dynamic_threshold(&self) -> Option<Threshold> {
        pull_in::dynamic(&self.coefficients(), self.prestress())
    }

    /// The static pull-in threshold at the present prestress.
    #[must_use]
    pub fn static_threshold(&self) -> Option<Threshold> {
        pull_in::quasi_static(&self.coefficients(), self.prestress())
    }

    /// How much the voltage may still grow before the actuator, from rest at
    /// λ = 1, is pulled in or nothing bounds its stretch; +∞ where neither happens.
    #[must_use]
    pub fn pull_in_margin(&self) -> f64 {
        let fold = self.dynamic_threshold().map(|threshold| threshold.voltage);
        fold.or_else(|| pull_in::escape_voltage(&self.coefficients(), self.prestress()))
            .map_or(f64::INFINITY, |limit| limit - self.total_voltage().abs())
    }

    fn coefficients(&self) -> Coefficients {
        Coefficients::fold(&self.scene.parameters)
    }

    fn load(&self) -> Load<f64> {
        let voltage = self.total_voltage();
        Load {
            voltage_squared: voltage * voltage,
            prestress: self.prestress(),
        }
    }
}
