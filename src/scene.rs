//! A scene: everything that a host sets before and between communication steps.

use serde::{Deserialize, Serialize};

use crate::actuator::drive::{Harmonic, Polynomial};
use crate::actuator::motion::LocalMotion;
use crate::actuator::{Coefficients, Drive, Motion, Parameters};
use crate::model::AtLimit;
use crate::solver::double::Double;
use crate::solver::limits::Limits;
use crate::solver::{Equation, State};

/// One scenario: actuator, start, limits and drive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// The actuator.
    pub parameters: Parameters,
    /// Stretch and stretch rate at the start time (Eq. 17).
    pub start: State,
    /// The stretches between which the motion is followed.
    pub limits: Limits,
    /// What happens at a limit.
    pub on_pull_in: AtLimit,
    /// Whether the extremes of the stretch are recorded.
    pub record_extremes: bool,
    /// Voltage and prestress.
    pub drive: Drive,
}

impl Scene {
    /// A scene with every number 0, to be filled in.
    pub(crate) const BLANK: Scene = Scene {
        parameters: Parameters {
            aspect: 0.0,
            surface_energy: 0.0,
            surface_tension: 0.0,
            surface_elasticity: 0.0,
        },
        start: State {
            position: 0.0,
            rate: 0.0,
        },
        limits: Limits {
            lower: 0.0,
            upper: 0.0,
        },
        on_pull_in: AtLimit::Hold,
        record_extremes: false,
        drive: Drive {
            since: Double::ZERO,
            voltage: Polynomial::constant(0.0),
            prestress: Polynomial::constant(0.0),
            harmonic: Harmonic::OFF,
        },
    };

    /// The motion that this scene describes.
    #[must_use]
    #[inline(always)]
    pub fn motion(&self) -> Motion {
        Motion {
            coefficients: Coefficients::fold(&self.parameters),
            drive: self.drive,
        }
    }
}

/// Its motion, made anew for each substep: a copy that is kept would have to be
/// kept up to date.
impl Equation for Scene {
    type Local<'a> = LocalMotion<'a>;

    #[inline(always)]
    fn at(&self, time: &Double) -> LocalMotion<'_> {
        LocalMotion::new(Coefficients::fold(&self.parameters), &self.drive, time)
    }

    fn is_autonomous(&self) -> bool {
        self.drive.is_constant()
    }

    /// Eq. 16 is that of a Hamiltonian (Eq. 18), with x' in it squared.
    fn is_time_reversible(&self) -> bool {
        true
    }
}
