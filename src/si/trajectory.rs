//! A nondimensional trajectory of either kind: of the paper's equation, where that describes the actuator but for
//! damping, or of a coupled system.

use serde::{Deserialize, Serialize};

use super::scene::{SiScene, SiState, internal};
use crate::actuator::device::DeviceMotion;
use crate::actuator::scales::Scales;
use crate::arithmetic::double_double::DoubleDouble;
use crate::solver::State;
use crate::solver::coupled::{self, FullState, MOST_INTEGRALS, MOST_STATES};
use crate::solver::extremes::Extremes;
use crate::solver::trajectory::{Failure, Progress, Trajectory};

/// How the motion is followed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) enum SiTrajectory {
    /// As the paper's equation, with damping or without.
    Plain(Box<Trajectory>),
    /// As that of a real actuator.
    Coupled(Box<coupled::Trajectory>),
}

/// Calls the same method of either trajectory.
macro_rules! either {
    ($either:expr, $trajectory:ident => $call:expr) => {
        match $either {
            SiTrajectory::Plain($trajectory) => $call,
            SiTrajectory::Coupled($trajectory) => $call,
        }
    };
}

impl SiTrajectory {
    /// A trajectory from this state on.
    pub fn of(
        scene: &SiScene,
        motion: &DeviceMotion,
        scales: &Scales,
        state: &SiState,
        tolerance: f64,
    ) -> SiTrajectory {
        let start = full_state(motion, scales, state);
        if motion.is_plain() {
            let plain = Trajectory::new(start.motion, scene.limits, tolerance);
            SiTrajectory::Plain(Box::new(plain))
        } else {
            let coupled = coupled::Trajectory::new(start, scene.limits, tolerance);
            SiTrajectory::Coupled(Box::new(coupled))
        }
    }

    /// Begins a new motion in place of this one. A coupled system keeps its memory.
    pub fn begin_anew(
        &mut self,
        scene: &SiScene,
        motion: &DeviceMotion,
        scales: &Scales,
        state: &SiState,
        tolerance: f64,
    ) {
        let start = full_state(motion, scales, state);
        match self {
            SiTrajectory::Plain(plain) if motion.is_plain() => {
                **plain = Trajectory::new(start.motion, scene.limits, tolerance);
            }
            SiTrajectory::Coupled(coupled) if !motion.is_plain() => {
                coupled.begin_anew(start, scene.limits, tolerance);
            }
            other => *other = SiTrajectory::of(scene, motion, scales, state, tolerance),
        }
    }

    pub fn is_plain(&self) -> bool {
        matches!(self, SiTrajectory::Plain(_))
    }

    /// The origin of the stretch, and the stretch counted from it.
    pub fn position_from_origin(&self) -> (DoubleDouble, f64) {
        match self {
            SiTrajectory::Plain(trajectory) => (DoubleDouble::ZERO, trajectory.position()),
            SiTrajectory::Coupled(trajectory) => trajectory.position_from_origin(),
        }
    }

    pub fn position(&self) -> f64 {
        either!(self, trajectory => trajectory.position())
    }

    pub fn state(&self) -> State {
        either!(self, trajectory => trajectory.state())
    }

    /// The first-order states.
    pub fn internal(&self) -> [f64; MOST_STATES] {
        match self {
            SiTrajectory::Plain(_) => [0.0; MOST_STATES],
            SiTrajectory::Coupled(trajectory) => trajectory.internal(),
        }
    }

    /// Energies exchanged since the start, where they are recorded.
    pub fn integrals(&self) -> [f64; MOST_INTEGRALS] {
        match self {
            SiTrajectory::Plain(_) => [0.0; MOST_INTEGRALS],
            SiTrajectory::Coupled(trajectory) => trajectory.integrals(),
        }
    }

    /// Adds energies that were exchanged at once.
    pub fn book(&mut self, exchanged: &[f64; MOST_INTEGRALS]) {
        if let SiTrajectory::Coupled(trajectory) = self {
            trajectory.jump(&[0.0; MOST_STATES], exchanged);
        }
    }

    pub fn extremes(&self) -> Option<Extremes> {
        either!(self, trajectory => trajectory.extremes())
    }

    pub fn record_extremes_anew(&mut self, records: bool) {
        either!(self, trajectory => trajectory.record_extremes_anew(records));
    }

    pub fn restart(&mut self) {
        either!(self, trajectory => trajectory.restart());
    }

    /// Follows the motion for a nondimensional time if it stays in its step and meets no event. Returns
    /// whether it does.
    #[inline]
    pub fn advance_inside_step(&mut self, step: f64) -> bool {
        either!(self, trajectory => trajectory.advance_inside_step(step))
    }

    /// Follows the motion beyond its step, and moves the clock, after [`SiTrajectory::advance_inside_step`] has
    /// returned false.
    pub fn advance_beyond_step(
        &mut self,
        motion: &DeviceMotion,
        clock: &mut DoubleDouble,
        step: f64,
    ) -> Result<Progress<coupled::Event>, Failure> {
        match self {
            SiTrajectory::Plain(trajectory) => {
                let progress = if motion.device.damping.is_none() {
                    trajectory.advance_beyond_step(&motion.plain(), clock, step)
                } else {
                    trajectory.advance_beyond_step(&motion.damped(), clock, step)
                };
                Ok(match progress? {
                    Progress::Whole => Progress::Whole,
                    Progress::Stopped { limit, after } => Progress::Stopped {
                        limit: coupled::Event::Limit(limit),
                        after,
                    },
                })
            }
            SiTrajectory::Coupled(trajectory) => {
                let mut work = coupled::MOST_WORK;
                trajectory.advance_beyond_step(motion, clock, step, &mut work)
            }
        }
    }

    /// Whether its numbers fit together and keep to the scene.
    pub fn is_valid(&self, scene: &SiScene, tolerance: f64) -> bool {
        either!(self, trajectory => trajectory.is_valid() && trajectory.keeps_to(scene.limits, tolerance))
    }
}

/// A state in nondimensional numbers.
fn full_state(motion: &DeviceMotion, scales: &Scales, state: &SiState) -> FullState {
    FullState {
        internal: internal(
            &motion.device,
            state.charge / scales.charge,
            &state.dashpots,
        ),
        ..FullState::of(State {
            position: state.motion.position,
            rate: state.motion.rate * scales.time,
        })
    }
}
