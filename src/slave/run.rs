//! The motion of an initialized actuator from communication point to
//! communication point.

use serde::{Deserialize, Serialize};

use super::{Event, Fault};
use crate::model::{AtLimit, Collapse, Model, Motion};
use crate::solver::double::Double;
use crate::solver::trajectory::{Failure, Progress};

/// A communication point may be off by this part of the time: hosts sum up
/// their steps in different ways, up to 1e7 of them.
const TIME_ROUNDING: f64 = 1e-9;

/// A communication point may also be off by this part of the step.
const STEP_ROUNDING: f64 = 1e-6;

/// A running simulation.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct Run<M: Model> {
    motion: M::Motion,
    collapse: Option<Collapse<M::Limit>>,
    /// The scene has changed since the trajectory has followed it.
    stale: bool,
}

impl<M: Model> Run<M> {
    pub(super) fn new(scene: &M::Scene, time: Double, tolerance: f64) -> Run<M> {
        Run {
            motion: M::Motion::begin(scene, time, tolerance),
            collapse: None,
            stale: false,
        }
    }

    /// Whether the numbers fit together as those of a motion of the scene.
    pub(super) fn is_sound(&self, scene: &M::Scene, tolerance: f64) -> bool {
        let collapsed = self.collapse.map_or(Double::ZERO, |collapse| collapse.time);
        self.motion.is_valid(scene, tolerance) && collapsed.is_finite()
    }

    /// The motion so far.
    #[must_use]
    pub fn motion(&self) -> &M::Motion {
        &self.motion
    }

    /// Whether and when the actuator has collapsed.
    #[must_use]
    pub fn collapse(&self) -> Option<&Collapse<M::Limit>> {
        self.collapse.as_ref()
    }

    /// Starts what is recorded anew, at the present.
    pub(super) fn record_anew(&mut self, scene: &M::Scene) {
        self.motion.record_anew(scene);
    }

    pub(super) fn scene_changed(&mut self) {
        self.stale = true;
    }

    /// Refuses a step that cannot be meant.
    pub(super) fn check_step(
        &self,
        current: f64,
        step: f64,
        stop_time: Option<f64>,
    ) -> Result<(), Fault> {
        if !(step > 0.0 && step <= f64::MAX) {
            return Err(Fault::error(format!(
                "the communication step {step} is not a finite number above 0"
            )));
        }
        let time = self.motion.time().value();
        let rounding = TIME_ROUNDING * time.abs() + STEP_ROUNDING * step;
        let off = (current - time).abs();
        if off.is_nan() || off > rounding {
            return Err(Fault::error(format!(
                "the current communication point {current} is not the time {time} \
                 at which the last step ended"
            )));
        }
        if let Some(stop) = stop_time
            && time + step > stop + rounding + STEP_ROUNDING * step
        {
            return Err(Fault::error(format!(
                "the step of {step} from {time} goes beyond the stop time {stop} \
                 given to fmi2SetupExperiment"
            )));
        }
        Ok(())
    }

    /// Follows the motion for one step that has been checked.
    pub(super) fn step(&mut self, scene: &M::Scene, step: f64) -> Result<Option<Event>, Fault> {
        if self.collapse.is_some() {
            self.motion.wait(Double::new(step));
            return Ok(None);
        }
        if self.stale {
            self.motion.restart();
            self.stale = false;
        }
        match self.motion.advance(scene, step) {
            Ok(Progress::Whole) => Ok(None),
            Ok(Progress::Stopped { limit, after }) => {
                let time = *self.motion.time();
                self.collapse = Some(Collapse { limit, time });
                let text = M::describe(scene, limit, time.value());
                match M::at_limit(scene, limit) {
                    AtLimit::Hold => {
                        self.motion.wait(Double::new(step).plus(-after));
                        Ok(Some(Event {
                            warning: false,
                            text: format!("{text}; it stays there (on_pull_in = hold)"),
                        }))
                    }
                    AtLimit::Terminate => Err(Fault::discard(format!(
                        "{text}; the simulation should end here (on_pull_in = terminate)"
                    ))),
                }
            }
            Err(failure) => Err(self.fail(failure)),
        }
    }

    fn fail(&self, failure: Failure) -> Fault {
        let why = match failure {
            Failure::SubstepTooShort { length, .. } => {
                format!("a substep of {length} is too short to go on")
            }
            Failure::TooManySubsteps { most, .. } => {
                format!("the step needs more than {most} substeps; use shorter steps")
            }
        };
        let time = self.motion.time().value();
        let place = self.motion.whereabouts();
        Fault::discard(format!(
            "the integration stopped at time {time} and {place}: {why}"
        ))
    }
}
