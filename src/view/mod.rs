//! What a host can read of the actuator at the present communication point.
//! Each quantity is computed when it is read, and only then.

mod quantities;

pub use quantities::{Direction, HIGHEST_ORDER, Moment, Quantities, Series};

use serde::{Deserialize, Serialize};

use crate::actuator::motion::{self, Load};
use crate::actuator::{Coefficients, Drive};
use crate::pull_in::{self, Threshold};
use crate::scene::{OnPullIn, Scene};
use crate::solver::State;
use crate::solver::double::Double;
use crate::solver::extremes::Extremes;
use crate::solver::jet::Dual;
use crate::solver::limits::Limit;
use crate::solver::trajectory::Trajectory;

/// The moment at which the motion reached a limit of the stretch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Collapse {
    /// The limit.
    pub limit: Limit,
    /// Time of the model.
    pub time: Double,
}

/// Where the state of the motion is known from.
#[derive(Clone, Copy, Debug)]
pub enum Place<'a> {
    /// It is this one: at the start, or where the host integrates.
    At(State),
    /// The present of this trajectory.
    On(&'a Trajectory),
}

/// The actuator at the present time.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// What the host has set.
    pub scene: &'a Scene,
    /// The state of the motion.
    pub place: Place<'a>,
    /// Time of the model.
    pub time: &'a Double,
    /// Whether and when the motion came to a limit.
    pub collapse: Option<&'a Collapse>,
}

impl Quantities<f64> for View<'_> {
    fn stretch(&self) -> f64 {
        match (self.held(), self.place) {
            (Some(Limit::Lower), _) => self.scene.limits.lower,
            (Some(Limit::Upper), _) => self.scene.limits.upper,
            (None, Place::On(trajectory)) => trajectory.position(),
            (None, Place::At(state)) => state.position,
        }
    }

    fn stretch_rate(&self) -> f64 {
        match (self.held(), self.place) {
            (Some(_), _) => 0.0,
            (None, Place::On(trajectory)) => trajectory.rate(),
            (None, Place::At(state)) => state.rate,
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

impl View<'_> {
    /// The limit at which the actuator is held. Where the simulation ends
    /// instead, the state on arrival remains.
    fn held(&self) -> Option<Limit> {
        match self.scene.on_pull_in {
            OnPullIn::Hold => self.collapse.map(|collapse| collapse.limit),
            OnPullIn::Terminate => None,
        }
    }

    /// The extremes of the stretch since the start, where they are recorded.
    #[must_use]
    pub fn extremes(&self) -> Option<Extremes> {
        match self.place {
            Place::On(trajectory) => trajectory.extremes(),
            Place::At(_) => None,
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

    /// The present as it changes in a direction.
    #[must_use]
    pub fn along(&self, direction: &Direction) -> Moment<Dual> {
        Moment::along(self.scene, *self.time, self.state(), self.held(), direction)
    }

    /// The motion from now on, as power series in the time that are right up to
    /// the derivatives of `order`, at most [`HIGHEST_ORDER`].
    #[must_use]
    pub fn from_now_on(&self, order: usize) -> Moment<Series> {
        Moment::from_now_on(self.scene, *self.time, self.state(), self.held(), order)
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
