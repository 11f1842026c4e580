//! The motion of an initialized actuator from communication point to
//! communication point.

use serde::{Deserialize, Serialize};

use super::phase::Phase;
use super::values::input_bit;
use super::{Fault, Instance, Message, Severity, Simulation};
use crate::arithmetic::double_double::DoubleDouble;
use crate::model::variables::Access;
use crate::model::{AtLimit, Collapse, Integration, Model, Place, View};
use crate::shortest::Shortest;
use crate::solver::trajectory::{Failure, Progress};

/// Shortest and longest communication step: powers of others overflow or underflow. Start times lie
/// in the same range to both sides of 0.
pub const STEP_RANGE: [f64; 2] = [1e-100, 1e50];

/// A deviation of the host's clock by less than this part of the time is rounding. Our clock, which has more
/// digits, is then kept.
const SAME: f64 = 64.0 * f64::EPSILON;

/// The host's clock may always deviate by less than this part of a step.
const OF_STEP: f64 = 0.01;

/// It may also deviate by this part of the time, one unit in the last place of single precision.
const SINGLE: f64 = f32::EPSILON as f64;

/// But never by more than this part of a step: a step that was left out or made twice is then found.
const MOST_OF_STEP: f64 = 0.5;

/// By how much the host's time may deviate in one step of this length at this time.
fn allowance(step: f64, time: f64) -> f64 {
    (OF_STEP * step)
        .max(SINGLE * time.abs())
        .min(MOST_OF_STEP * step)
        .max(SAME * time.abs())
}

/// A running simulation.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct Run<M: Model> {
    /// The present time, to which the motion has come.
    clock: DoubleDouble,
    motion: M::Integration,
    collapse: Option<Collapse<M::Limit>>,
    /// The scene has changed since the last step.
    stale: bool,
    /// By how much the host's clock is ahead of the sum of its steps.
    drift: f64,
    /// Where the last step began, if it needed too much work and ended early.
    cut_from: Option<f64>,
}

impl<M: Model> Run<M> {
    pub(super) fn new(scene: &M::Scene, time: DoubleDouble, tolerance: f64) -> Run<M> {
        Run {
            clock: time,
            motion: M::Integration::begin(scene, &time, tolerance),
            collapse: None,
            stale: false,
            drift: 0.0,
            cut_from: None,
        }
    }

    /// Whether the numbers fit together as those of a motion of the scene.
    pub(super) fn is_valid(&self, scene: &M::Scene, tolerance: f64) -> bool {
        let collapsed = self
            .collapse
            .map_or(DoubleDouble::ZERO, |collapse| collapse.time);
        self.clock.is_finite()
            && self.motion.is_valid(scene, tolerance)
            && collapsed.is_finite()
            && self.drift.is_finite()
            && self.cut_from.is_none_or(f64::is_finite)
    }

    /// The present time.
    #[must_use]
    #[inline]
    pub fn time(&self) -> &DoubleDouble {
        &self.clock
    }

    /// The motion so far.
    #[must_use]
    pub fn motion(&self) -> &M::Integration {
        &self.motion
    }

    /// The present state, where it is stored as such and the motion has not ended.
    #[inline]
    pub(super) fn stored_state(&self) -> Option<M::State> {
        match self.collapse {
            None => self.motion.stored_state(),
            Some(_) => None,
        }
    }

    /// Whether and when the actuator has collapsed.
    #[must_use]
    pub fn collapse(&self) -> Option<&Collapse<M::Limit>> {
        self.collapse.as_ref()
    }

    /// Begins new recordings at the present.
    pub(super) fn record_anew(&mut self, scene: &M::Scene) {
        self.motion.record_anew(scene);
    }

    pub(super) fn scene_changed(&mut self) {
        self.stale = true;
        self.motion.scene_changed();
    }

    /// Refuses a step that makes no sense. Returns by how much the host's clock is ahead of ours, nothing
    /// where both agree.
    #[inline]
    pub(super) fn check_step(
        &mut self,
        current: f64,
        step: f64,
        stop_time: &Option<f64>,
    ) -> Result<Option<f64>, Fault> {
        let [shortest, longest] = STEP_RANGE;
        if !(shortest..=longest).contains(&step) {
            return Err(not_a_step(step));
        }
        let ahead = -self.clock.since(DoubleDouble::new(current));
        if self.cut_from == Some(current) {
            return Err(self.asked_again(current));
        }
        // Of our clock, which is finite.
        let same = ahead.abs() <= SAME * self.clock.high.abs();
        let deviation = if same {
            None
        } else {
            Some(self.deviation(current, step, ahead)?)
        };
        if let Some(stop) = stop_time {
            self.check_end(current, step, deviation.unwrap_or(0.0), *stop)?;
        }
        Ok(deviation)
    }

    /// How far the host's clock may be `ahead` of ours in this step: refuses more.
    #[inline(never)]
    fn deviation(&self, current: f64, step: f64, ahead: f64) -> Result<f64, Fault> {
        if ahead.abs() < allowance(step, current) {
            Ok(ahead)
        } else {
            Err(self.not_the_time(current))
        }
    }

    /// Refuses a step beyond the stop time. The host's clock and the sum of its steps may differ, where it adds
    /// in single precision; the step is good if one of them stays within the stop time.
    #[inline(never)]
    fn check_end(&self, current: f64, step: f64, deviation: f64, stop: f64) -> Result<(), Fault> {
        let beyond = current + step - stop;
        let allowed = allowance(step, stop);
        let drift = self.drift + deviation;
        if beyond <= allowed || beyond < MOST_OF_STEP * step && beyond - drift <= allowed {
            return Ok(());
        }
        Err(Fault::error(format!(
            "the step of {} from {} goes beyond the stop time {} of the experiment",
            Shortest(step),
            Shortest(current),
            Shortest(stop)
        )))
    }

    /// Discards a step once more for a host that ignored the first time, and that should end the simulation. FMPy,
    /// for one, would repeat the step for ever.
    #[cold]
    fn asked_again(&mut self, current: f64) -> Fault {
        self.cut_from = None;
        Fault::discard(format!(
            "the step from {} was discarded and is asked for again; the simulation should end at \
             time {}, or go on from there",
            Shortest(current),
            Shortest(self.clock.value())
        ))
    }

    #[cold]
    fn not_the_time(&self, current: f64) -> Fault {
        Fault::error(format!(
            "the current communication point {} is not the time {} at which the last step ended",
            Shortest(current),
            Shortest(self.clock.value())
        ))
    }

    /// Sets our clock to the host's time. The state stays; the motion restarts where its inputs depend on
    /// time.
    pub(super) fn set_clock(&mut self, scene: &M::Scene, current: f64, deviation: f64) {
        self.drift += deviation;
        self.clock = DoubleDouble::new(current);
        self.stale |= M::depends_on_time(scene);
    }

    /// Whether the last step needed too much work and ended early. The motion can go on from there.
    pub(super) fn was_cut(&self) -> bool {
        self.cut_from.is_some()
    }

    /// Follows the motion for one step that has been checked.
    pub(super) fn step(
        &mut self,
        scene: &M::Scene,
        current: f64,
        step: f64,
    ) -> Result<Option<Message>, Fault> {
        self.cut_from = None;
        if self.collapse.is_some() {
            if std::mem::take(&mut self.stale) {
                self.motion.rest(scene, &self.clock);
            }
            self.clock = self.clock.add(DoubleDouble::new(step));
            return Ok(None);
        }
        if self.stale {
            self.motion.restart();
            self.stale = false;
        }
        match self.motion.advance(scene, &mut self.clock, step) {
            Ok(Progress::Whole) => Ok(None),
            Ok(Progress::Stopped { limit, after }) => {
                let time = self.clock;
                self.collapse = Some(Collapse { limit, time });
                let text = M::describe(scene, limit, time.value());
                let choice = M::choice(limit);
                match M::at_limit(scene, limit) {
                    AtLimit::Hold => {
                        self.clock = time.add(DoubleDouble::new(step).plus(-after));
                        Ok(Some(Message {
                            warning: false,
                            text: format!("{text}; it stays there ({choice} = hold)"),
                        }))
                    }
                    AtLimit::Terminate => Err(Fault::discard(format!(
                        "{text}; the simulation should end here ({choice} = terminate)"
                    ))),
                }
            }
            Err(failure) => Err(self.fail(scene, failure, current)),
        }
    }

    /// Why the step ended early. After a step that needed too much work, the motion can go on.
    #[cold]
    fn fail(&mut self, scene: &M::Scene, failure: Failure, current: f64) -> Fault {
        let time = Shortest(self.clock.value());
        let place = self.motion.whereabouts();
        let view = View::<M>::new(scene, Place::On(&self.motion), &self.clock, None);
        let excess = M::excess(&view).map_or_else(String::new, |excess| format!("; {excess}"));
        let at = format!("the integration stopped at time {time} and {place}");
        match failure {
            Failure::SubstepTooShort { length, .. } => Fault::discard(format!(
                "{at}: a substep of {} is too short to go on; the simulation should end here{excess}",
                Shortest(length)
            )),
            Failure::TooManySubsteps { most, .. } => {
                self.cut_from = Some(current);
                Fault::discard(format!(
                    "{at}: the step needs more than {most} substeps or iterations; use shorter \
                     steps from there on{excess}"
                ))
            }
        }
    }
}

impl<M: Model> Instance<M> {
    /// Moves the actuator by one communication step. Returns a message where the
    /// actuator has collapsed in it.
    ///
    /// # Errors
    /// Error for a step that makes no sense, with nothing changed; Discard
    /// where the step ends early, at [`Instance::last_successful_time`].
    pub fn do_step(&mut self, current: f64, step: f64) -> Result<Option<Message>, Fault> {
        self.followed(current, step)
            .map_err(|fault| self.failed(fault))
    }

    #[inline(always)]
    fn followed(&mut self, current: f64, step: f64) -> Result<Option<Message>, Fault> {
        let Simulation::Run(run) = &mut self.simulation else {
            return Err(Fault::error("initialization has not ended".into()));
        };
        let deviation = run.check_step(current, step, &self.experiment.stop_time)?;
        if let Some(deviation) = deviation {
            follow_clock(
                run,
                &mut self.scene,
                self.fresh_derivatives,
                current,
                deviation,
            );
        }
        self.fresh_derivatives = 0;
        run.step(&self.scene, current, step)
    }

    /// Ends the run if the step has ended early and the motion cannot go on.
    #[cold]
    fn failed(&mut self, fault: Fault) -> Fault {
        let was_cut = matches!(&self.simulation, Simulation::Run(run) if run.was_cut());
        if fault.severity == Severity::Discard && !was_cut {
            self.phase = Phase::StepFailed;
        }
        fault
    }
}

/// Sets our clock to the host's time, which is ahead by `deviation`. Inputs whose derivatives were set since
/// the last step (bit k for input k) count from the host's communication point; the others stay the same
/// functions of time.
#[cold]
fn follow_clock<M: Model>(
    run: &mut Run<M>,
    scene: &mut M::Scene,
    set: u64,
    current: f64,
    deviation: f64,
) {
    if M::inputs_since(scene) == run.time() {
        for (variable, reference) in M::VARIABLES.iter().zip(0..) {
            if let Access::Input { of, .. } = variable.access
                && set & input_bit::<M>(reference) == 0
            {
                of(scene).shift(deviation);
            }
        }
        M::begin_inputs(scene, DoubleDouble::new(current));
    }
    run.set_clock(scene, current, deviation);
}

#[cold]
fn not_a_step(step: f64) -> Fault {
    let [shortest, longest] = STEP_RANGE.map(Shortest);
    let number = Shortest(step);
    Fault::error(if step > 0.0 && step.is_finite() {
        format!("the communication step {number} is not between {shortest} and {longest}")
    } else {
        format!("the communication step {number} is not a finite number above 0")
    })
}
