//! The motion of x'' = f(t, x, x'), followed by the cheapest steps that what is asked of it allows.
//!
//! Where the motion repeats, its steps are kept until it has turned twice. Between two turning
//! points it then runs there and back for ever, so that no further step is integrated, whatever
//! the time asked for.

use serde::{Deserialize, Serialize};

use super::dense_output::History;
use super::double::Double;
use super::endpoint::EndpointSteps;
use super::integrator::{Integrator, Method};
use super::limits::{Limit, Limits};
pub use super::outcome::{Failure, Progress};
use super::short_step::Trend;
use super::{Equation, State};

mod extension;
mod substeps;

/// What each kind of steps leaves for the next of its kind.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Steps {
    /// Whether a motion that repeats is looked for.
    follows_orbits: bool,
    /// Whether steps of which only the end is asked for may have fewer than 16 nodes.
    takes_endpoint_steps: bool,
    /// What f was in the last short step.
    trend: Option<Trend>,
    /// Longer short steps are not tried: one was refused of late.
    longest_short_step: Option<f64>,
    /// Where communication points lie far apart.
    endpoint: EndpointSteps,
}

impl Method for Steps {
    type Event = Limit;
    type Origin = ();
    const MOST_STEPS: u32 = 2_000_000;

    fn is_valid(&self, _: &Trajectory) -> bool {
        self.longest_short_step.is_none_or(|length| length > 0.0) && self.endpoint.are_valid()
    }
}

/// A motion of x'' = f(t, x, x') that is followed forward in time.
pub type Trajectory = Integrator<Steps>;

impl Trajectory {
    /// A motion from `start`, followed with a relative `tolerance` of the position inside the
    /// `limits`.
    #[must_use]
    pub fn new(start: State, limits: Limits, tolerance: f64) -> Trajectory {
        let steps = Steps {
            follows_orbits: true,
            takes_endpoint_steps: true,
            trend: None,
            longest_short_step: None,
            endpoint: EndpointSteps::none(),
        };
        Trajectory::with_method(History::empty(), steps, start, limits, tolerance)
    }

    /// Integrates the motion all the way even where it repeats.
    #[must_use]
    pub fn without_orbits(mut self) -> Trajectory {
        self.method.follows_orbits = false;
        self
    }

    /// Integrates the motion with 16 nodes all the way.
    #[must_use]
    pub fn without_endpoint_steps(mut self) -> Trajectory {
        self.method.takes_endpoint_steps = false;
        self
    }

    /// The present state, where it is that at which a step has ended and none is kept.
    #[must_use]
    #[inline]
    pub fn stored_state(&self) -> Option<State> {
        self.history.is_empty().then_some(self.start)
    }

    /// Starts anew from the present state: the equation has changed.
    #[inline]
    pub fn restart(&mut self) {
        let after_short_step = self.restarts_at_every_step
            && self.advances == 1
            && self.method.trend.is_some()
            && self.history.is_empty();
        if after_short_step {
            // It leaves nothing else behind.
            self.advances = 0;
            return;
        }
        self.method.endpoint.restart();
        self.start_from_present();
    }

    /// Follows the motion for the time `step` > 0 from `clock`, the time to which it has come, and
    /// moves the clock to where it has come then. The `equation` must be the same as in the calls
    /// before, back to the last [`Trajectory::restart`].
    ///
    /// # Errors
    /// [`Failure`] where the integration cannot go on; the trajectory then stands at the end of the
    /// last step.
    pub fn advance<E: Equation>(
        &mut self,
        equation: &E,
        clock: &mut Double,
        step: f64,
    ) -> Result<Progress, Failure> {
        if self.advance_inside_step(clock, step) {
            return Ok(Progress::Whole);
        }
        let first = self.restarts_at_every_step && self.advances == 1;
        if first && self.method.takes_endpoint_steps {
            // First, since all that the next step does with the time waits for it.
            let end = clock.plus(step).renormalized();
            if self.takes_short_step(equation, clock, step) {
                *clock = end;
                return Ok(Progress::Whole);
            }
        }
        // Whether the next endpoint-only step would meet no limit and no extreme.
        let mut unobstructed = true;
        self.advance_by_steps(clock, step, |motion, target, budget| {
            let rest = target.since(motion.history.end());
            let (shift, free) = if unobstructed && motion.takes_endpoint_steps(equation, rest) {
                motion.go_to_end(equation, target, budget)
            } else {
                *budget -= 1;
                (motion.extend(equation, rest)?, true)
            };
            unobstructed = free;
            Ok(shift)
        })
    }
}
