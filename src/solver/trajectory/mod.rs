//! The motion of x'' = f(t, x, x'), followed by the cheapest kind of steps that gives what the
//! caller asks for.
//!
//! Where the motion repeats, its steps are kept until it has turned twice. Between two turning
//! points it then runs there and back for ever, so that no further step is integrated, whatever
//! the time asked for.

use serde::{Deserialize, Serialize};

use super::collocation::{Guess, Substep, solve_by_16};
use super::dense_output::{History, Segment};
use super::endpoint::{End, EndpointSteps};
use super::integrator::{Integrator, Method, Mode, SKIPS_DENSE_OUTPUT};
use super::iteration::Diverged;
use super::limits::{Limit, Limits};
pub use super::outcome::{Failure, Progress};
use super::short_step::{ShortStep, Trend};
use super::step_control::{HALVED, SHORTEST, first_accepted, goes_on_from, most_growth};
use super::{Equation, LocalEquation, State};
use crate::arithmetic::double_double::DoubleDouble;

mod endpoint_only;
mod substeps;

/// First step in units of the motion's time scale.
const FIRST_STEP: f64 = 2.0;

/// Steps that take no longer than to look for an orbit.
const FEW: f64 = 4.0;

/// The growth of a step lets the next one grow as much again: how long steps may be varies with the motion's phase,
/// by powers of ten where the motion turns far out.
const ACCELERATION: i32 = 1;

/// After a short step that was refused, the next 14 of its length are not tried.
const FORGOTTEN: f64 = 1.05;

/// Between the nodes the position misses less than this part of the last two Legendre
/// coefficients: f is integrated twice, which divides degree 16 by some 16², and its series goes
/// on falling. Measured on DC and AC motions with steps of 6 to 14: 5 to 18 times less, which
/// leaves room for the rate, whose error is larger by the inverse of the motion's time scale.
const NEGLECTED_BETWEEN_NODES: f64 = 1000.0;

/// Coefficients larger than this part of the position are not the last ones of a series that falls: f is
/// not resolved, however loose the tolerance.
const RESOLVED: f64 = 0.1;

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
    endpoint: EndpointSteps<0>,
}

impl Method for Steps {
    type Event = Limit;
    type Origin = ();
    const MOST_STEPS: u32 = 2_000_000;

    fn is_valid(&self, _: &Trajectory) -> bool {
        self.longest_short_step.is_none_or(|length| length > 0.0)
            && self.trend.is_none_or(|trend| trend.is_valid())
            && self.endpoint.are_valid()
    }
}

/// A motion of x'' = f(t, x, x') that is followed forward in time.
pub type Trajectory = Integrator<Steps>;

impl Trajectory {
    /// A motion from `start`, followed with a relative `tolerance` of the position inside the
    /// `limits`.
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
    #[inline]
    pub fn stored_state(&self) -> Option<State> {
        self.history.is_empty().then_some(self.start.state)
    }

    /// Starts anew from the present state: the equation has changed.
    #[inline]
    pub fn restart(&mut self) {
        let after_short_step = self.restarts.at_every_step()
            && self.restarts.advances == 1
            && self.method.trend.is_some()
            && self.history.is_empty();
        if after_short_step {
            // It leaves nothing else behind.
            self.restarts.advances = 0;
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
        clock: &mut DoubleDouble,
        step: f64,
    ) -> Result<Progress, Failure> {
        if self.advance_inside_step(step) {
            *clock = clock.plus(step);
            return Ok(Progress::Whole);
        }
        self.advance_beyond_step(equation, clock, step)
    }

    /// The rest of [`Trajectory::advance`], where [`Integrator::advance_inside_step`] has told that the
    /// motion leaves its step.
    #[inline]
    pub(crate) fn advance_beyond_step<E: Equation>(
        &mut self,
        equation: &E,
        clock: &mut DoubleDouble,
        step: f64,
    ) -> Result<Progress, Failure> {
        // Whether the next endpoint-only step would meet no limit and no extreme.
        let mut unobstructed = true;
        let first = self.restarts.at_every_step();
        let mut there = SKIPS_DENSE_OUTPUT
            && first
            && self.method.takes_endpoint_steps
            && self.takes_short_step(equation, clock, step);
        if SKIPS_DENSE_OUTPUT
            && !there
            && self.may_go_straight(step)
            && self.takes_endpoint_steps(equation, step)
        {
            let end = self.go_straight_to_end(equation, clock, step);
            there = end == End::Reached;
            unobstructed = end != End::Blocked;
        }
        if there {
            *clock = clock.plus(step).renormalized();
            return Ok(Progress::Whole);
        }
        self.advance_by_steps(clock, step, |motion, target, budget| {
            let rest = target.since(motion.history.end());
            let (shift, free) = if SKIPS_DENSE_OUTPUT
                && unobstructed
                && motion.takes_endpoint_steps(equation, rest)
            {
                motion.go_to_end_by_steps(equation, target, budget)
            } else {
                *budget -= 1;
                (motion.extend(equation, rest)?, true)
            };
            unobstructed = free;
            Ok(shift)
        })
    }

    /// Whether a motion that repeats is looked for.
    fn may_repeat<E: Equation>(&self, equation: &E) -> bool {
        self.method.follows_orbits && equation.repeats()
    }

    /// Makes the first step from the origin on in 4 nodes, if that is possible.
    fn takes_short_step<E: Equation>(
        &mut self,
        equation: &E,
        time: &DoubleDouble,
        step: f64,
    ) -> bool {
        if let Some(longest) = &mut self.method.longest_short_step
            && step > *longest
        {
            *longest *= FORGOTTEN;
            return false;
        }
        if self.method.trend.is_none() {
            self.method.trend = Trend::first(equation, time, self.start.state, step);
        }
        let bounds = self.bounds();
        let taken = self.method.trend.as_mut().is_some_and(|trend| {
            let mut short = ShortStep {
                time,
                length: step,
                bounds,
                control: self.settings.control.repeated(),
                state: &mut self.start.state,
                trend,
            };
            short.take(self.settings.level, equation)
        });
        if !taken {
            // So that a guess that leads nowhere is not made again.
            self.method.trend = None;
            self.method.longest_short_step = Some(0.5 * step);
        }
        taken
    }

    /// Adds one more step with dense output; `rest` is the time still asked for. Returns by how
    /// much the origin of time was moved.
    ///
    /// # Errors
    /// The length of a step that was too short to go on.
    fn extend<E: Equation>(&mut self, equation: &E, rest: f64) -> Result<DoubleDouble, f64> {
        let follows_orbits = self.method.follows_orbits;
        let alone = self.restarts.at_every_step();
        let few = alone && self.next_length.is_none_or(|length| rest < FEW * length);
        let repeats = !few && self.may_repeat(equation);
        // Nothing of a step that ends where the equation changes is asked for but its end.
        let only_end = alone && !repeats && !self.records_extremes();
        let begin = self.history.end();
        let last = self.history.steps().last();
        let state = last.map_or(self.start.state, |step| step.segment.end());
        let local = equation.seen_from(&self.start.time.add(begin));
        if self.history.is_empty() && state.rate == 0.0 {
            let rests = follows_orbits && equation.is_autonomous();
            if rests && local.acceleration_from(state) == 0.0 {
                self.mode = Mode::AtRest;
                return Ok(DoubleDouble::ZERO);
            }
            if repeats {
                self.mode = Mode::Dense {
                    first_turn: Some(DoubleDouble::ZERO),
                    stop: None,
                };
            }
        }
        let most = if alone { rest } else { f64::INFINITY };
        let step = self.step(&local, state, [repeats, only_end], most)?;
        // Steps are kept only while an orbit may still come out of them.
        let shift = self.push((), Segment::new(state, step.end, &step.series), repeats);
        let (lowest, highest) = step.reach(state.position).into_inner();
        let stop = self.first_contact(lowest, highest);
        self.stop_in_last_step(stop);
        if repeats {
            self.look_for_turn();
        }
        Ok(shift)
    }

    /// Solves the next step with dense output, as long as the tolerance allows but no longer than
    /// `most`, for its end only or not.
    fn step<L: LocalEquation>(
        &mut self,
        local: &L,
        state: State,
        [repeats, only_end]: [bool; 2],
        most: f64,
    ) -> Result<Substep, f64> {
        let control = self.step_control(repeats);
        let scale = state.position.abs();
        let time_scale = local.time_scale(state);
        let free = match self.next_length {
            Some(length) => length,
            None => FIRST_STEP * time_scale,
        };
        let most = most.min(local.longest_substep());
        let shortest = (SHORTEST * free).min(0.5 * most);
        let longest = free.min(most);
        let last = self.history.steps().last();
        let length_before = last.map(|step| step.segment.length());
        let before = last
            .map(|step| *step.segment.series())
            .filter(|before| goes_on_from(before.half, longest));
        let guess = match &before {
            Some(before) => Guess::Before(before),
            None => Guess::Begin(local.acceleration_from(state)),
        };
        let (step, length, factor) = first_accepted(longest, shortest, |&mut length| {
            let tolerance = control.iteration_tolerance(scale, FIRST_STEP * length / free);
            let step = solve_by_16(self.settings.level, local, state, length, tolerance, guess)
                .map_err(|Diverged| HALVED)?;
            if self.settings.limits.are_left_behind_by(step.nodes()) {
                return Err(HALVED);
            }
            let factor = if only_end {
                control.judge_end(step.end_error() / scale, step.contraction)?
            } else {
                // Of the position, or of the rate where that is worse.
                let short = (4.0 * time_scale / length).max(1.0);
                let neglected = NEGLECTED_BETWEEN_NODES.min(RESOLVED / control.tolerance);
                let missed = short * step.tail() / neglected;
                control.judge(missed / scale, step.contraction)?
            };
            let most = most_growth(length, longest, length_before, ACCELERATION);
            Ok((step, length, factor.min(most)))
        })?;
        // A step cut short says little about the next one.
        self.next_length = Some(if length == most {
            free
        } else {
            length * factor
        });
        Ok(step)
    }
}
