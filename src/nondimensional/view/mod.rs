//! What a host can read of the actuator at the present communication point.
//! Each quantity is computed when it is read, and only then.

mod quantities;

pub use quantities::{Quantities, Sample};

use crate::actuator::motion::{self, Load};
use crate::actuator::{Coefficients, Drive};
use crate::model::{AtLimit, Place, View};
use crate::nondimensional::Nondimensional;
use crate::pull_in::{self, Threshold};
use crate::solver::State;
use crate::solver::extremes::Extremes;
use crate::solver::limits::Limit;

impl Quantities<f64> for View<'_, Nondimensional> {
    fn stretch(&self) -> f64 {
        match (self.held(), self.place) {
            (Some(Limit::Lower), _) => self.scene.limits.lower,
            (Some(Limit::Upper), _) => self.scene.limits.upper,
            (None, Place::On(trajectory)) => trajectory.position(),
            (None, Place::At { state, .. }) => state.position,
        }
    }

    fn stretch_rate(&self) -> f64 {
        match (self.held(), self.place) {
            (Some(_), _) => 0.0,
            (None, Place::On(trajectory)) => trajectory.rate(),
            (None, Place::At { state, .. }) => state.rate,
        }
    }

    fn stretch_acceleration(&self) -> f64 {
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

    fn total_voltage(&self) -> f64 {
        self.scene.drive.at(self.time).voltage(0.0)
    }
}

impl View<'_, Nondimensional> {
    /// The limit at which the actuator is held. Where the simulation ends
    /// instead, the state on arrival remains.
    pub(crate) fn held(&self) -> Option<Limit> {
        let collapse = self.collapse?;
        match self.scene.at_limit() {
            AtLimit::Hold => Some(collapse.limit),
            AtLimit::Terminate => None,
        }
    }

    /// The extremes of the stretch since their recording began, where they are
    /// recorded.
    #[must_use]
    pub fn extremes(&self) -> Option<Extremes> {
        match self.place {
            Place::On(trajectory) => trajectory.extremes(),
            Place::At { record, .. } => record.extremes,
        }
    }

    /// Stretch and stretch rate.
    #[must_use]
    pub fn state(&self) -> State {
        State {
            position: self.stretch(),
            rate: self.stretch_rate(),
        }
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

    /// The Hamiltonian 𝓗 of Eqs. 18 and 19 under the present load.
    #[must_use]
    pub fn energy(&self) -> f64 {
        motion::energy(&self.coefficients(), self.load(), self.state())
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
