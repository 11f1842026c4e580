//! The motion from a start onwards: substeps one after another, each answered
//! from its polynomial as long as the caller stays inside it.
//!
//! Where the motion repeats, the pieces are kept until the motion has
//! turned twice. Between two turning points it then runs there and back for
//! ever, so that no further substep is integrated, whatever the time asked for.

use fearless_simd::Level;
use serde::{Deserialize, Serialize};

use super::double::Double;
use super::endpoint::EndpointSteps;
use super::extremes::Extremes;
use super::limits::{Limit, Limits};
use super::orbit::Orbit;
pub use super::outcome::{Failure, Progress};
use super::pieces::{Piece, Pieces};
use super::short_step::Trend;
use super::step_control::StepControl;
use super::stride::Strides;
use super::{Equation, State};

mod extension;
mod present;
mod soundness;
mod substeps;

/// Substeps that one call may take: about a second of work.
const MOST_SUBSTEPS: u32 = 2_000_000;

/// What rounding may leave of a step that has been made.
const LAST_BITS: f64 = 1e-18;

/// A motion that is followed forward in time. It can be stored, and goes on bit
/// for bit on processors of the same SIMD level; check what was stored with
/// [`Trajectory::is_sound`] where it may have been tampered with.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Trajectory {
    #[serde(skip, default = "Level::new")]
    level: Level,
    control: StepControl,
    limits: Limits,
    /// Present time of the model: all steps summed up.
    time: Double,
    /// Time of the model at which the first piece begins; of no meaning without one.
    origin: Double,
    /// State at the origin.
    start: State,
    /// From the origin on without a gap.
    pieces: Pieces,
    /// The piece in which the present lies.
    index: usize,
    /// The present, counted from the origin; on an orbit folded into it.
    now: Double,
    /// −1 while an orbit is run back, else 1.
    direction: f64,
    /// For less time than this the present stays in its piece and meets nothing.
    slack: f64,
    first_turn: Option<Double>,
    orbit: Option<Orbit>,
    stop: Option<(Limit, Double)>,
    at_rest: bool,
    next_length: Option<f64>,
    /// Whether a motion that repeats is looked for.
    follows_orbits: bool,
    /// Whether fewer than 16 nodes may do.
    takes_strides: bool,
    /// Advances since the last restart.
    advances: u32,
    /// The last start was good for a single advance: the host changes the
    /// equation at each communication point, and looking ahead is of no use.
    restless: bool,
    /// What f was in the last short step.
    trend: Option<Trend>,
    /// Where communication points lie far apart.
    steps: EndpointSteps,
    /// The same where the equation changes at each of them.
    strides: Strides,
    /// How far the motion has swung, where that is recorded.
    extremes: Option<Extremes>,
    /// The time up to which it is, counted from the origin.
    recorded: Double,
}

impl Trajectory {
    /// A motion from `start` at `time`, followed with a relative `tolerance` of
    /// the position inside the `limits`.
    #[must_use]
    pub fn new(start: State, time: Double, limits: Limits, tolerance: f64) -> Trajectory {
        Trajectory {
            level: Level::new(),
            control: StepControl::new(tolerance),
            limits,
            time,
            origin: time,
            start,
            pieces: Pieces::none(),
            index: 0,
            now: Double::ZERO,
            direction: 1.0,
            slack: 0.0,
            first_turn: None,
            orbit: None,
            stop: None,
            at_rest: false,
            next_length: None,
            follows_orbits: true,
            takes_strides: true,
            advances: 0,
            restless: false,
            trend: None,
            steps: EndpointSteps::NONE,
            strides: Strides::NONE,
            extremes: None,
            recorded: Double::ZERO,
        }
    }

    /// The same motion, its extremes recorded from now on.
    #[must_use]
    pub fn recording_extremes(mut self) -> Trajectory {
        self.extremes = Some(Extremes::at(self.position()));
        self
    }

    /// Forgets the extremes so far: they are recorded from the present on, or not
    /// any more.
    pub fn record_extremes_anew(&mut self, recording: bool) {
        self.extremes = recording.then(|| Extremes::at(self.position()));
        // Along an orbit the motion turns where the orbit does only.
        self.recorded = self.orbit.map_or(self.now, |orbit| orbit.second_turn());
        self.slack = 0.0;
    }

    /// The extremes up to the present, where they are recorded.
    #[must_use]
    pub fn extremes(&self) -> Option<Extremes> {
        self.extremes
    }

    /// The same motion computed with another set of processor instructions.
    #[must_use]
    pub fn with_level(mut self, level: Level) -> Trajectory {
        self.level = level;
        self
    }

    /// The same motion, integrated all the way even where it repeats.
    #[must_use]
    pub fn without_orbits(mut self) -> Trajectory {
        self.follows_orbits = false;
        self
    }

    /// The same motion, integrated with 16 nodes all the way.
    #[must_use]
    pub fn without_strides(mut self) -> Trajectory {
        self.takes_strides = false;
        self
    }

    /// The present time of the model.
    #[must_use]
    #[inline]
    pub fn time(&self) -> &Double {
        &self.time
    }

    /// Sets the clock, and moves nothing. Where the equation depends on time, a
    /// [`Trajectory::restart`] must follow.
    pub fn set_clock(&mut self, time: Double) {
        self.origin = self.origin.add(time.sub(self.time));
        self.time = time;
    }

    /// Lets time pass in which nothing moves.
    #[inline]
    pub fn wait(&mut self, time: Double) {
        self.time = self.time.add(time);
    }

    /// Starts anew from the present state: the equation has changed.
    #[inline]
    pub fn restart(&mut self) {
        self.restless = self.advances == 1;
        self.advances = 0;
        self.steps.restart();
        self.strides.restart();
        // Without a piece it stands at its start.
        if self.pieces.count() > 0 {
            self.start = self.state();
        }
        self.forget();
    }

    /// Forgets the motion so far, which has come to `state` at `time`.
    fn stand_at(&mut self, time: Double, state: State) {
        self.start = state;
        self.origin = time;
        self.forget();
    }

    /// Forgets the motion that has led to its start.
    fn forget(&mut self) {
        self.pieces.clear();
        self.index = 0;
        self.now = Double::ZERO;
        self.recorded = Double::ZERO;
        self.direction = 1.0;
        self.slack = 0.0;
        self.first_turn = None;
        self.orbit = None;
        self.stop = None;
        self.at_rest = false;
    }

    /// Follows the motion for the time `step` > 0. The `equation` must be the
    /// same as in the calls before, back to the last [`Trajectory::restart`].
    ///
    /// # Errors
    /// [`Failure`] where the integration cannot go on; the trajectory then
    /// stands at the end of the last substep.
    pub fn advance<E: Equation>(&mut self, equation: &E, step: f64) -> Result<Progress, Failure> {
        self.advances = self.advances.saturating_add(1);
        if step < self.slack {
            self.slack -= step;
            self.now = self.now.plus(self.direction * step);
            self.time = self.time.plus(step);
            return Ok(Progress::Whole);
        }
        if self.takes_strides && self.restless && self.advances == 1 {
            // First, since all that the next step does with the time waits for it.
            let time = self.time.plus(step).tightened();
            if self.takes_short_step(equation, step) {
                self.time = time;
                return Ok(Progress::Whole);
            }
        }
        if self.at_rest {
            self.time = self.time.plus(step);
            return Ok(Progress::Whole);
        }
        let progress = self.advance_further(equation, step);
        let passed = match progress {
            Ok(Progress::Whole) => step,
            Ok(Progress::Stopped { after, .. }) => after,
            Err(
                Failure::SubstepTooShort { after, .. } | Failure::TooManySubsteps { after, .. },
            ) => after,
        };
        self.time = self.time.plus(passed).tightened();
        progress
    }

    /// The same where the present piece does not suffice: out of the way of the
    /// steps for which it does, with its large frame. The time is left as it was.
    #[inline(never)]
    fn advance_further<E: Equation>(
        &mut self,
        equation: &E,
        step: f64,
    ) -> Result<Progress, Failure> {
        if self.pieces.count() == 0 {
            self.origin = self.time;
        }
        if let Some(orbit) = self.orbit {
            self.run_orbit(orbit, step);
            return Ok(Progress::Whole);
        }
        let mut target = self.now.plus(step);
        let mut budget = MOST_SUBSTEPS;
        let mut clear = true;
        loop {
            if let Some((limit, at)) = self.stop
                && target.since(at) >= 0.0
            {
                let after = step - target.since(at);
                self.arrive(at);
                return Ok(Progress::Stopped { limit, after });
            }
            let rest = target.since(self.end());
            if rest <= LAST_BITS * step {
                // Without a piece, strides came to it.
                if self.pieces.count() > 0 {
                    self.arrive(if rest > 0.0 { self.end() } else { target });
                }
                return Ok(Progress::Whole);
            }
            if budget == 0 {
                let after = step - self.stand_at_end(target);
                return Err(Failure::TooManySubsteps {
                    most: MOST_SUBSTEPS,
                    after,
                });
            }
            let added = if clear && self.strides_over(equation, rest) {
                Ok(self.stride(equation, target, &mut budget, &mut clear))
            } else {
                budget -= 1;
                clear = true;
                self.extend(equation, rest)
            };
            let shift = match added {
                Ok(shift) => shift,
                Err(length) => {
                    let after = step - self.stand_at_end(target);
                    return Err(Failure::SubstepTooShort { length, after });
                }
            };
            target = target.sub(shift);
            if self.at_rest || target == Double::ZERO {
                return Ok(Progress::Whole);
            }
            if let Some(orbit) = self.orbit
                && target.since(orbit.second_turn()) > 0.0
            {
                let rest = target.since(orbit.second_turn());
                self.arrive(orbit.second_turn());
                self.run_orbit(orbit, rest);
                return Ok(Progress::Whole);
            }
        }
    }

    /// The end of the last piece.
    #[inline]
    fn end(&self) -> Double {
        self.pieces.list().last().map_or(Double::ZERO, Piece::end)
    }

    /// Moves the present to the end of the last piece and returns the time
    /// from there to `target`.
    fn stand_at_end(&mut self, target: Double) -> f64 {
        let end = self.end();
        self.arrive(end);
        target.since(end)
    }
}
