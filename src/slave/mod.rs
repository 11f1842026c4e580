//! What FMI means for this actuator, in safe Rust: phases, checks, and the run.
//!
//! Nothing here knows of pointers or of XML. Each call checks everything before
//! it changes anything.

mod fault;
mod phase;
mod run;
mod values;

pub use fault::{Event, Fault, Severity};
pub use phase::{Call, Phase};
pub use run::Run;
pub use values::Type;

use crate::scene::Scene;
use crate::solver::double::Double;
use crate::variables::{Access, VARIABLES};
use crate::view::View;

/// Relative tolerance of the stretch where the host defines none.
pub const DEFAULT_TOLERANCE: f64 = 1e-10;

/// Tolerances that the integrator can keep; others are moved here.
pub const TOLERANCE_RANGE: [f64; 2] = [1e-14, 1e-2];

/// When the simulation begins, when it ends, and how accurate it is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Experiment {
    start_time: f64,
    stop_time: Option<f64>,
    tolerance: f64,
}

impl Experiment {
    const DEFAULT: Experiment = Experiment {
        start_time: 0.0,
        stop_time: None,
        tolerance: DEFAULT_TOLERANCE,
    };
}

/// One instance of the actuator.
#[derive(Debug)]
pub struct Instance {
    phase: Phase,
    scene: Scene,
    experiment: Experiment,
    /// The motion; there is none before initialization has ended.
    run: Option<Box<Run>>,
    /// Bit k: input k has derivatives that no step has used yet.
    fresh_derivatives: u32,
}

impl Default for Instance {
    fn default() -> Instance {
        Instance::new()
    }
}

impl Instance {
    /// An actuator with all variables at their start values.
    #[must_use]
    pub fn new() -> Instance {
        Instance {
            phase: Phase::Instantiated,
            scene: Scene::at_start(),
            experiment: Experiment::DEFAULT,
            run: None,
            fresh_derivatives: 0,
        }
    }

    /// The present phase.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// What can be read at present.
    #[must_use]
    pub fn view(&self) -> View<'_> {
        let run = self.run.as_deref();
        View {
            scene: &self.scene,
            trajectory: run.map(Run::trajectory),
            time: run.map_or(Double::new(self.experiment.start_time), Run::time),
            collapse: run.and_then(Run::collapse),
        }
    }

    /// Sets start time, stop time and tolerance of the simulation. Returns an
    /// event where the tolerance had to be moved into [`TOLERANCE_RANGE`].
    ///
    /// # Errors
    /// Error for a number that is not finite, a tolerance that is not positive
    /// or a stop time before the start time.
    pub fn setup_experiment(
        &mut self,
        tolerance: Option<f64>,
        start_time: f64,
        stop_time: Option<f64>,
    ) -> Result<Option<Event>, Fault> {
        if !start_time.is_finite() {
            return Err(Fault::error(format!(
                "the start time {start_time} is not a finite number"
            )));
        }
        if let Some(stop) = stop_time
            && !(stop.is_finite() && stop >= start_time)
        {
            return Err(Fault::error(format!(
                "the stop time {stop} is not a finite number from the start time {start_time} on"
            )));
        }
        let wanted = tolerance.unwrap_or(DEFAULT_TOLERANCE);
        if !(wanted.is_finite() && wanted > 0.0) {
            return Err(Fault::error(format!(
                "the tolerance {wanted} is not a finite number above 0"
            )));
        }
        let [smallest, largest] = TOLERANCE_RANGE;
        let kept = wanted.clamp(smallest, largest);
        self.experiment = Experiment {
            start_time,
            stop_time,
            tolerance: kept,
        };
        Ok((kept != wanted).then(|| Event {
            warning: true,
            text: format!(
                "the tolerance {wanted} is outside {smallest} to {largest}; {kept} is used"
            ),
        }))
    }

    /// Begins initialization.
    pub fn enter_initialization(&mut self) {
        self.phase = Phase::Initialization;
    }

    /// Ends initialization: the motion begins.
    ///
    /// # Errors
    /// Error where the start stretch does not lie between the limits.
    pub fn exit_initialization(&mut self) -> Result<(), Fault> {
        let start = self.scene.start.position;
        let limits = self.scene.limits;
        if !(limits.lower < start && start < limits.upper) {
            return Err(Fault::error(format!(
                "lambda_start = {start} does not lie between lambda_min = {} and lambda_max = {}; \
                 set it, or the limits, so that it does",
                limits.lower, limits.upper
            )));
        }
        let time = Double::new(self.experiment.start_time);
        self.scene.drive.since = time;
        let tolerance = self.experiment.tolerance;
        self.run = Some(Box::new(Run::new(&self.scene, time, tolerance)));
        self.phase = Phase::StepComplete;
        Ok(())
    }

    /// Moves the actuator by one communication step. Returns an event where the
    /// actuator has collapsed in it.
    ///
    /// # Errors
    /// Error for a step that cannot be meant, with nothing changed; Discard
    /// where the step ends early, at [`Instance::last_successful_time`].
    pub fn do_step(&mut self, current: f64, step: f64) -> Result<Option<Event>, Fault> {
        let Some(run) = self.run.as_deref_mut() else {
            return Err(Fault::error("the initialization has not been ended".into()));
        };
        run.check_step(current, step, self.experiment.stop_time)?;
        self.fresh_derivatives = 0;
        let outcome = run.step(&self.scene, step);
        if matches!(&outcome, Err(fault) if fault.severity == Severity::Discard) {
            self.phase = Phase::StepFailed;
        }
        outcome
    }

    /// Ends the simulation.
    pub fn terminate(&mut self) {
        self.phase = Phase::Terminated;
    }

    /// Puts everything back to how it was after instantiation.
    pub fn reset(&mut self) {
        *self = Instance::new();
    }

    /// Makes every later call fail: something happened that must not happen.
    pub fn give_up(&mut self) {
        self.phase = Phase::Fatal;
    }

    /// The time up to which the motion is known.
    #[must_use]
    pub fn last_successful_time(&self) -> f64 {
        self.view().time.value()
    }

    /// Whether the host is asked to end the simulation.
    #[must_use]
    pub fn wants_to_terminate(&self) -> bool {
        self.phase == Phase::StepFailed
    }

    /// Sets derivatives of inputs, each given by value reference, order and value.
    ///
    /// An input with derivatives is a polynomial in the time since they were
    /// set. It stays so until its value or a derivative is set again.
    ///
    /// # Errors
    /// Error for a variable that is no input, an order outside 1 to 4 or a
    /// value that is not finite; then nothing is set.
    pub fn set_input_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        derivatives: &[f64],
    ) -> Result<(), Fault> {
        use crate::actuator::drive::HIGHEST_DERIVATIVE;
        for ((&reference, &order), &value) in references.iter().zip(orders).zip(derivatives) {
            let variable = values::row(reference)?;
            let name = variable.name;
            if !matches!(variable.access, Access::Input { .. }) {
                return Err(Fault::error(format!(
                    "{name} is not an input; derivatives can be set for inputs only"
                )));
            }
            if !(1..=HIGHEST_DERIVATIVE as i32).contains(&order) {
                return Err(Fault::error(format!(
                    "the derivative of {name} of order {order} cannot be set; \
                     orders 1 to {HIGHEST_DERIVATIVE} can"
                )));
            }
            if !value.is_finite() {
                return Err(Fault::error(format!(
                    "the derivative {value} of {name} is not a finite number"
                )));
            }
        }
        self.bring_drive_up_to_date();
        for ((&reference, &order), &value) in references.iter().zip(orders).zip(derivatives) {
            let Access::Input { of, .. } = VARIABLES[reference as usize].access else {
                continue;
            };
            let input = of(&mut self.scene);
            let bit = 1 << reference;
            if self.fresh_derivatives & bit == 0 {
                input.clear_derivatives();
                self.fresh_derivatives |= bit;
            }
            input.set_derivative(order as usize, value);
        }
        self.changed();
        Ok(())
    }

    /// Counts the time of the drive from the present communication point on.
    fn bring_drive_up_to_date(&mut self) {
        if let Some(run) = &self.run {
            self.scene.drive = self.scene.drive.rebased(run.time());
        }
    }

    /// The scene is not what the run has integrated so far.
    fn changed(&mut self) {
        if let Some(run) = &mut self.run {
            run.scene_changed();
        }
    }
}
