//! A scene: everything that a host sets before and between communication steps; and the motion
//! that follows from it.

use serde::{Deserialize, Serialize};

use crate::actuator::drive::{Harmonic, Polynomial};
use crate::actuator::motion::LocalMotion;
use crate::actuator::{Coefficients, Drive, Motion, Parameters};
use crate::arithmetic::double_double::DoubleDouble;
use crate::model::{AtLimit, Integration};
use crate::nondimensional::Nondimensional;
use crate::shortest::Shortest;
use crate::solver::limits::Limits;
use crate::solver::trajectory::{Failure, Progress, Trajectory};
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
    /// What happens at a limit, as the host that knows enumerations says.
    pub on_pull_in: AtLimit,
    /// Not 0: a host that sets numbers only asks to terminate there.
    pub terminate_on_pull_in: f64,
    /// Whether the extremes of the stretch are recorded, as the host that knows
    /// Booleans says.
    pub record_extremes: bool,
    /// The number of the window over which extremes are recorded; not 0, they are.
    pub extremes_window: f64,
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
        terminate_on_pull_in: 0.0,
        record_extremes: false,
        extremes_window: 0.0,
        drive: Drive {
            since: DoubleDouble::ZERO,
            voltage: Polynomial::constant(0.0),
            prestress: Polynomial::constant(0.0),
            harmonic: Harmonic::OFF,
            lead: 0.0,
        },
    };

    /// What happens at a limit, whichever way the host has said it.
    #[must_use]
    #[inline]
    pub fn at_limit(&self) -> AtLimit {
        if self.terminate_on_pull_in == 0.0 {
            self.on_pull_in
        } else {
            AtLimit::Terminate
        }
    }

    /// Whether extremes are recorded, whichever way the host has said it.
    #[must_use]
    #[inline]
    pub fn records_extremes(&self) -> bool {
        self.record_extremes || self.extremes_window != 0.0
    }

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
    fn at(&self, time: &DoubleDouble) -> LocalMotion<'_> {
        LocalMotion::new(Coefficients::fold(&self.parameters), &self.drive, time)
    }

    #[inline]
    fn is_autonomous(&self) -> bool {
        self.drive.is_constant()
    }

    /// Eq. 16 is that of a Hamiltonian (Eq. 18), with x' in it squared.
    #[inline]
    fn is_time_reversible(&self) -> bool {
        true
    }
}

impl Integration<Nondimensional> for Trajectory {
    fn begin(scene: &Scene, _time: &DoubleDouble, tolerance: f64) -> Trajectory {
        let trajectory = Trajectory::new(scene.start, scene.limits, tolerance);
        if scene.records_extremes() {
            trajectory.recording_extremes()
        } else {
            trajectory
        }
    }

    #[inline]
    fn advance(
        &mut self,
        scene: &Scene,
        clock: &mut DoubleDouble,
        step: f64,
    ) -> Result<Progress, Failure> {
        Trajectory::advance(self, scene, clock, step)
    }

    #[inline]
    fn restart(&mut self) {
        Trajectory::restart(self);
    }

    fn record_anew(&mut self, scene: &Scene) {
        self.record_extremes_anew(scene.records_extremes());
    }

    #[inline]
    fn stored_state(&self) -> Option<State> {
        Trajectory::stored_state(self)
    }

    fn is_valid(&self, scene: &Scene, tolerance: f64) -> bool {
        Trajectory::is_valid(self)
            && self.keeps_to(scene.limits, tolerance)
            && self.extremes().is_some() == scene.records_extremes()
    }

    fn whereabouts(&self) -> String {
        format!("stretch {}", Shortest(self.position()))
    }
}
