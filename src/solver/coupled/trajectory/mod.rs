//! The motion of a coupled system, followed by steps with dense output.

use serde::{Deserialize, Serialize};

use super::polynomials::Polynomials;
use super::{CoupledEquation, FullState, MOST_INTEGRALS, MOST_STATES};
use crate::arithmetic::double_double::DoubleDouble;
use crate::solver::dense_output::History;
use crate::solver::endpoint::EndpointSteps;
use crate::solver::integrator::{Integrator, Mode, SKIPS_DENSE_OUTPUT};
use crate::solver::limits::{Limit, Limits};
pub use crate::solver::outcome::Failure;
use crate::solver::outcome::Progress as PlainProgress;

mod endpoint_only;
mod evaluation;
mod events;
mod extension;

/// The work of a step beside its iterations, in iterations.
const STEP_WORK: u32 = 4;

/// Iterations that an advance may take: about a second of work.
pub const MOST_WORK: u32 = 600_000;

/// Why a motion stops before the time asked for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Event {
    /// It has come to a limit of the position.
    Limit(Limit),
    /// The margin of the equation has vanished.
    Margin,
}

/// How far an advance came.
pub type Progress = PlainProgress<Event>;

/// What a coupled system carries along beside position and rate.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Carried {
    /// First-order states and integrals at the start.
    internal: [f64; MOST_STATES],
    integrals: [f64; MOST_INTEGRALS],
    /// Both over the only step that is kept, where there are any.
    polynomials: Option<Polynomials>,
    /// x'' and z' just before the last restart: where they jump, fast transients begin.
    slopes_before: Option<(f64, [f64; MOST_STATES])>,
    /// Whether the margin of the equation is still awaited.
    awaits_margin: bool,
    /// Where communication points lie far apart.
    endpoint: EndpointSteps<MOST_STATES>,
}

/// A motion of a coupled system that is followed forward in time.
pub type Trajectory = Integrator<Carried>;

impl Trajectory {
    /// A motion from `start`, followed with a relative `tolerance` of every state
    /// between the `limits` of the position. The position is counted from 0.
    pub fn new(start: FullState, limits: Limits, tolerance: f64) -> Trajectory {
        let endpoint = EndpointSteps::none();
        Trajectory::within(History::empty(), endpoint, start, limits, tolerance)
    }

    /// Makes it a new motion, see [`Trajectory::new`], in the memory of the one that it was.
    pub fn begin_anew(&mut self, start: FullState, limits: Limits, tolerance: f64) {
        let (history, endpoint) = (self.history.take(), self.method.endpoint.anew());
        *self = Trajectory::within(history, endpoint, start, limits, tolerance);
    }

    fn within(
        history: History<DoubleDouble>,
        endpoint: EndpointSteps<MOST_STATES>,
        start: FullState,
        limits: Limits,
        tolerance: f64,
    ) -> Trajectory {
        let carried = Carried {
            internal: start.internal,
            integrals: start.integrals,
            polynomials: None,
            slopes_before: None,
            awaits_margin: true,
            endpoint,
        };
        Trajectory::with_method(history, carried, start.motion, limits, tolerance)
    }

    /// Goes on without awaiting the margin of the equation any more.
    pub fn pass_margin(&mut self) {
        self.method.awaits_margin = false;
        if let Mode::Dense {
            stop: Some((Event::Margin, _)),
            ..
        } = self.mode
        {
            // The step is cut at the present; what follows is looked at anew, in the same advance.
            self.restart();
            self.restarts.advances = 1;
        }
    }

    /// Starts anew from the present state: the equation has changed.
    pub fn restart(&mut self) {
        if !self.history.is_empty() {
            let (internal, integrals) = (self.internal(), self.integrals());
            let slopes = self.slopes_at_present();
            let carried = &mut self.method;
            (carried.internal, carried.integrals) = (internal, integrals);
            carried.polynomials = None;
            carried.slopes_before = Some(slopes);
        }
        self.method.endpoint.restart();
        self.start_from_present();
    }

    /// Adds to the integrals at once, and to the first-order states: a jump of an input.
    /// To be called right after a restart.
    pub fn jump(&mut self, states: &[f64; MOST_STATES], integrals: &[f64; MOST_INTEGRALS]) {
        for (state, jump) in self.method.internal.iter_mut().zip(states) {
            *state += jump;
        }
        for (integral, jump) in self.method.integrals.iter_mut().zip(integrals) {
            *integral += jump;
        }
    }

    /// Follows the motion for the time `step` > 0 from `clock`, the time to which it has come, and
    /// moves the clock to where it has come then. The `equation` must be the same as in the calls
    /// before, back to the last [`Trajectory::restart`]. No more `work` is done, in iterations: what is done is
    /// taken from it.
    ///
    /// # Errors
    /// [`Failure`] where the integration cannot go on; the trajectory then stands at the end of
    /// the last step.
    pub fn advance<E: CoupledEquation>(
        &mut self,
        equation: &E,
        clock: &mut DoubleDouble,
        step: f64,
        work: &mut u32,
    ) -> Result<Progress, Failure> {
        if self.advance_inside_step(step) {
            *clock = clock.plus(step);
            return Ok(Progress::Whole);
        }
        self.advance_beyond_step(equation, clock, step, work)
    }

    /// The rest of [`Trajectory::advance`], where [`Integrator::advance_inside_step`] has told that
    /// the motion leaves its step.
    ///
    /// # Errors
    /// As there.
    pub(crate) fn advance_beyond_step<E: CoupledEquation>(
        &mut self,
        equation: &E,
        clock: &mut DoubleDouble,
        step: f64,
        work: &mut u32,
    ) -> Result<Progress, Failure> {
        let beside = STEP_WORK
            + if equation.integrals() > 0 || equation.awaits_event() {
                STEP_WORK
            } else {
                0
            };
        // Whether the next endpoint-only step would meet no limit and no extreme.
        let mut unobstructed = true;
        self.advance_by_steps(clock, step, |motion, target, budget| {
            let rest = target.since(motion.history.end());
            let mut done = beside;
            let shift = if SKIPS_DENSE_OUTPUT
                && unobstructed
                && motion.takes_endpoint_steps(equation, rest)
            {
                let (shift, free) = motion.go_to_end_by_steps(equation, target, *budget, &mut done);
                unobstructed = free;
                Ok(shift)
            } else {
                motion.extend(equation, rest, &mut done)
            };
            *work = work.saturating_sub(done);
            *budget = budget.saturating_sub(done).min(*work);
            shift
        })
    }
}
