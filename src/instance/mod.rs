//! What FMI means for this actuator, in safe Rust: phases, checks, the run of a
//! co-simulation, model exchange, derivatives and saved states.
//!
//! Nothing here knows of pointers or of XML. Each call checks everything before
//! it changes anything.

mod beyond;
mod derivatives;
mod exchange;
mod fault;
mod phase;
mod run;
mod state;
mod tuning;
mod values;

pub use exchange::{Exchange, Update};
pub use fault::{Fault, Message, Severity};
pub use phase::{Interface, Phase};
pub use run::{Run, STEP_RANGE};
pub use state::{LAYOUT as STATE_LAYOUT, Saved};
pub use values::Type;

use serde::{Deserialize, Serialize};

use crate::arithmetic::double_double::DoubleDouble;
use crate::model::{Model, Place, View};
use crate::shortest::Shortest;

/// Relative tolerance of the stretch where the host defines none.
pub const DEFAULT_TOLERANCE: f64 = 1e-10;

/// Smallest and largest tolerance that the integrator can keep; others are moved into this range.
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

/// How far the simulation is.
#[derive(Debug, Serialize, Deserialize)]
#[serde(bound = "")]
enum Simulation<M: Model> {
    /// Initialization has not ended.
    NotBegun,
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
    simulation: Simulation<M>,
    /// A bit for each input, set while the input has derivatives that no step has used yet.
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
            simulation: Simulation::NotBegun,
            fresh_derivatives: 0,
        }
    }

    /// The present phase.
    #[must_use]
    #[inline]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// What kind of unit it is.
    #[must_use]
    #[inline]
    pub fn interface(&self) -> Interface {
        self.interface
    }

    /// What can be read at present.
    #[must_use]
    #[inline]
    pub fn view(&self) -> View<'_, M> {
        match &self.simulation {
            Simulation::Run(run) => {
                let place = Place::On(run.motion());
                View::new(&self.scene, place, run.time(), run.collapse())
            }
            _ => self.view_without_run(),
        }
    }

    /// [`Instance::view`] where the state must be copied; not inlined, so that the other cases stay fast.
    #[inline(never)]
    fn view_without_run(&self) -> View<'_, M> {
        let scene = &self.scene;
        let (place, time, collapse) = match &self.simulation {
            Simulation::Exchange(now) => (now.place(), &now.time, now.visible_collapse(scene)),
            _ => {
                // The drive counts from the start time.
                let time = M::inputs_since(scene);
                (Exchange::new(scene, *time).place(), time, None)
            }
        };
        View::new(scene, place, time, collapse)
    }

    /// Sets start time, stop time and tolerance of the simulation. Returns a
    /// message where the tolerance had to be moved into [`TOLERANCE_RANGE`].
    ///
    /// # Errors
    /// Error for a number that is not finite, a tolerance that is not positive
    /// or a stop time before the start time.
    pub fn setup_experiment(
        &mut self,
        tolerance: Option<f64>,
        start_time: f64,
        stop_time: Option<f64>,
    ) -> Result<Option<Message>, Fault> {
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
        M::begin_inputs(&mut self.scene, DoubleDouble::new(start_time));
        Ok((kept != wanted).then(|| {
            let [wanted, smallest, largest, kept] = [wanted, smallest, largest, kept].map(Shortest);
            Message {
                warning: true,
                text: format!(
                    "the tolerance {wanted} is outside {smallest} to {largest}; {kept} is used"
                ),
            }
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
        let time = DoubleDouble::new(self.experiment.start_time);
        M::begin_inputs(&mut self.scene, time);
        match self.interface {
            Interface::CoSimulation => {
                let tolerance = self.experiment.tolerance;
                self.simulation = Simulation::Run(Box::new(Run::new(&self.scene, time, tolerance)));
                self.phase = Phase::StepComplete;
            }
            Interface::ModelExchange => {
                self.simulation = Simulation::Exchange(Exchange::new(&self.scene, time));
                self.phase = Phase::EventMode;
            }
        }
        Ok(())
    }

    /// Ends the simulation.
    pub fn terminate(&mut self) {
        self.phase = Phase::Terminated;
    }

    /// Resets everything to its value after instantiation.
    pub fn reset(&mut self) {
        *self = Instance::of(self.interface);
    }

    /// Makes every later call fail, after a fatal error.
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
        let cut = matches!(&self.simulation, Simulation::Run(run) if run.was_cut());
        cut || self.phase == Phase::StepFailed
    }

    /// Whether the host is asked to end the simulation.
    #[must_use]
    pub fn wants_to_terminate(&self) -> bool {
        self.phase == Phase::StepFailed
    }
}

/// Refuses a time that is NaN, or too large for the clock.
fn check_time(what: &str, time: f64) -> Result<(), Fault> {
    let [_, largest] = STEP_RANGE;
    if time.abs() <= largest {
        return Ok(());
    }
    let [number, largest] = [time, largest].map(Shortest);
    Err(Fault::error(if time.is_finite() {
        format!("the {what} {number} is not between -{largest} and {largest}")
    } else {
        format!("the {what} {number} is not a finite number")
    }))
}
