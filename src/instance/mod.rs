//! What FMI means for this actuator, in safe Rust: phases, checks, the run of a
//! co-simulation, model exchange, derivatives and saved states.
//!
//! Nothing here knows of pointers or of XML. Each call checks everything before
//! it changes anything.

mod derivatives;
mod exchange;
mod fault;
mod phase;
mod run;
mod state;
mod values;

pub use exchange::{Exchange, Update};
pub use fault::{Event, Fault, Severity};
pub use phase::{Call, Interface, Phase};
pub use run::{Run, STEP_RANGE};
pub use state::LAYOUT as STATE_LAYOUT;
pub use values::Type;

use serde::{Deserialize, Serialize};

use crate::model::variables::Access;
use crate::model::{Account, AtLimit, Model, Place, View};
use crate::shortest::Shortest;
use crate::solver::double::Double;

/// Relative tolerance of the stretch where the host defines none.
pub const DEFAULT_TOLERANCE: f64 = 1e-10;

/// Tolerances that the integrator can keep; others are moved here.
pub const TOLERANCE_RANGE: [f64; 2] = [1e-14, 1e-2];

/// When the simulation begins, when it ends, and how accurate it is to be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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

/// Where the motion is.
#[derive(Debug, Serialize, Deserialize)]
#[serde(bound = "")]
enum Course<M: Model> {
    /// Initialization has not ended.
    Ahead,
    /// We integrate it.
    Run(Box<Run<M>>),
    /// The host integrates it.
    Exchange(Exchange<M>),
}

/// One instance of a model.
#[derive(Debug, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct Instance<M: Model> {
    interface: Interface,
    phase: Phase,
    scene: M::Scene,
    experiment: Experiment,
    course: Course<M>,
    /// Which inputs have derivatives that no step has used yet, a bit each.
    fresh_derivatives: u64,
}

impl<M: Model> Default for Instance<M> {
    fn default() -> Instance<M> {
        Instance::new()
    }
}

impl<M: Model> Instance<M> {
    /// An actuator for co-simulation with all variables at their start values.
    #[must_use]
    pub fn new() -> Instance<M> {
        Instance::of(Interface::CoSimulation)
    }

    /// An actuator for this interface with all variables at their start values.
    #[must_use]
    pub fn of(interface: Interface) -> Instance<M> {
        Instance {
            interface,
            phase: Phase::Instantiated,
            scene: M::at_start(),
            experiment: Experiment::DEFAULT,
            course: Course::Ahead,
            fresh_derivatives: 0,
        }
    }

    /// The present phase.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// Whether the standard allows this call at present.
    #[must_use]
    #[inline]
    pub fn permits(&self, call: Call) -> bool {
        self.phase.permits(call) && call.is_part_of(self.interface)
    }

    /// Whether the standard allows this call at present, and why not.
    ///
    /// # Errors
    /// Error where it does not, Fatal after a fatal error.
    pub fn check(&self, call: Call) -> Result<(), Fault> {
        if self.permits(call) {
            Ok(())
        } else {
            Err(self.refusal(call))
        }
    }

    /// Why the call is not allowed at present.
    #[cold]
    fn refusal(&self, call: Call) -> Fault {
        let severity = if self.phase == Phase::Fatal {
            Severity::Fatal
        } else {
            Severity::Error
        };
        let kind = match self.interface {
            Interface::CoSimulation => "co-simulation",
            Interface::ModelExchange => "model exchange",
        };
        let text = match call {
            Call::CancelStep => "no step is in progress: fmi2DoStep returns when it is done".into(),
            _ => format!(
                "not allowed in the phase \"{}\" of {kind}",
                self.phase.name()
            ),
        };
        Fault { severity, text }
    }

    /// What can be read at present.
    #[must_use]
    pub fn view(&self) -> View<'_, M> {
        let scene = &self.scene;
        let (place, time, collapse) = match &self.course {
            Course::Run(run) => (Place::On(run.motion()), run.time(), run.collapse()),
            Course::Exchange(now) => {
                let Exchange {
                    state,
                    record,
                    account,
                    ..
                } = *now;
                let arrival = now
                    .arrival
                    .as_ref()
                    .filter(|at| M::at_limit(scene, at.limit) == AtLimit::Terminate);
                (
                    Place::At {
                        state,
                        record,
                        account,
                    },
                    &now.time,
                    now.collapse.as_ref().or(arrival),
                )
            }
            Course::Ahead => {
                // The drive counts from the start time.
                let (state, time) = (M::start(scene), M::inputs_since(scene));
                let record = exchange::recording::<M>(scene, *time, &state);
                let account = M::Account::begin(scene, *time, &state);
                (
                    Place::At {
                        state,
                        record,
                        account,
                    },
                    time,
                    None,
                )
            }
        };
        View {
            scene,
            place,
            time,
            collapse,
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
        check_time("start time", start_time)?;
        // A run without an end.
        let stop_time = stop_time.filter(|&stop| stop != f64::INFINITY);
        if let Some(stop) = stop_time
            && !(stop.is_finite() && stop >= start_time)
        {
            return Err(Fault::error(format!(
                "the stop time {} is not a number from the start time {} on",
                Shortest(stop),
                Shortest(start_time)
            )));
        }
        let wanted = tolerance.unwrap_or(DEFAULT_TOLERANCE);
        if !(wanted.is_finite() && wanted > 0.0) {
            return Err(Fault::error(format!(
                "the tolerance {} is not a finite number above 0",
                Shortest(wanted)
            )));
        }
        let [smallest, largest] = TOLERANCE_RANGE;
        let kept = wanted.clamp(smallest, largest);
        self.experiment = Experiment {
            start_time,
            stop_time,
            tolerance: kept,
        };
        // Derivatives of inputs that are set before count from the start time.
        M::begin_inputs(&mut self.scene, Double::new(start_time));
        Ok((kept != wanted).then(|| Event {
            warning: true,
            text: format!(
                "the tolerance {wanted:e} is outside {smallest:e} to {largest:e}; {kept:e} is used"
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
        M::check_start(&self.scene).map_err(Fault::error)?;
        let time = Double::new(self.experiment.start_time);
        M::begin_inputs(&mut self.scene, time);
        match self.interface {
            Interface::CoSimulation => {
                let tolerance = self.experiment.tolerance;
                self.course = Course::Run(Box::new(Run::new(&self.scene, time, tolerance)));
                self.phase = Phase::StepComplete;
            }
            Interface::ModelExchange => {
                self.course = Course::Exchange(Exchange::new(&self.scene, time));
                self.phase = Phase::EventMode;
            }
        }
        Ok(())
    }

    /// Moves the actuator by one communication step. Returns an event where the
    /// actuator has collapsed in it.
    ///
    /// # Errors
    /// Error for a step that cannot be meant, with nothing changed; Discard
    /// where the step ends early, at [`Instance::last_successful_time`].
    pub fn do_step(&mut self, current: f64, step: f64) -> Result<Option<Event>, Fault> {
        let Course::Run(run) = &mut self.course else {
            return Err(Fault::error("the initialization has not been ended".into()));
        };
        let stop_time = self.experiment.stop_time;
        let outcome = run
            .check_step(current, step, stop_time)
            .and_then(|deviation| {
                if deviation != 0.0 {
                    set_clock(
                        run,
                        &mut self.scene,
                        self.fresh_derivatives,
                        current,
                        deviation,
                    );
                }
                self.fresh_derivatives = 0;
                run.step(&self.scene, current, step)
            });
        if matches!(&outcome, Err(fault) if fault.severity == Severity::Discard) && !run.was_cut() {
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
        *self = Instance::of(self.interface);
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

    /// Whether the last step ended early.
    #[must_use]
    pub fn last_step_was_discarded(&self) -> bool {
        let cut = matches!(&self.course, Course::Run(run) if run.was_cut());
        cut || self.phase == Phase::StepFailed
    }

    /// Whether the host is asked to end the simulation.
    #[must_use]
    pub fn wants_to_terminate(&self) -> bool {
        self.phase == Phase::StepFailed
    }

    /// Counts the time of the drive from the present communication point on.
    fn bring_drive_up_to_date(&mut self) {
        if let Some(time) = self.now() {
            M::rebase_inputs(&mut self.scene, time);
        }
    }

    /// The present communication point; none before the motion has begun.
    fn now(&self) -> Option<Double> {
        match &self.course {
            Course::Ahead => None,
            Course::Run(run) => Some(*run.time()),
            Course::Exchange(now) => Some(now.time),
        }
    }

    /// Starts what is recorded anew, at the present.
    fn record_anew(&mut self) {
        match &mut self.course {
            Course::Ahead => {}
            Course::Run(run) => run.record_anew(&self.scene),
            Course::Exchange(now) => now.record_anew(&self.scene),
        }
    }

    /// The scene is not what the run has integrated so far.
    fn changed(&mut self) {
        if let Course::Run(run) = &mut self.course {
            run.scene_changed();
        }
    }
}

/// Refuses a time that is no number, or so large that the clock cannot compute with it.
fn check_time(what: &str, time: f64) -> Result<(), Fault> {
    let [_, largest] = STEP_RANGE;
    if time.abs() <= largest {
        return Ok(());
    }
    let number = Shortest(time);
    Err(Fault::error(if time.is_finite() {
        format!("the {what} {number} is not between -{largest:e} and {largest:e}")
    } else {
        format!("the {what} {number} is not a finite number")
    }))
}

/// Takes the host's time over, which is ahead of ours by `deviation`. What was set since the last
/// step (derivatives: bit k for input k) was set for the host's communication point; the other
/// inputs go on as the functions of time that they are.
#[cold]
fn set_clock<M: Model>(
    run: &mut Run<M>,
    scene: &mut M::Scene,
    set: u64,
    current: f64,
    deviation: f64,
) {
    if M::inputs_since(scene) == run.time() {
        for (reference, variable) in M::VARIABLES.iter().enumerate() {
            if let Access::Input { of, .. } = variable.access
                && set & (1 << reference) == 0
            {
                of(scene).shift(deviation);
            }
        }
        M::begin_inputs(scene, Double::new(current));
    }
    run.set_clock(scene, current, deviation);
}
