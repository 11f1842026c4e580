//! The motion of a coupled system from a start onwards: steps one after another, each answered
//! from its polynomials as long as the caller stays inside it.

use fearless_simd::Level;
use serde::{Deserialize, Serialize};

use super::piece::Rest;
use super::{CoupledEquation, FullState, MOST_INTEGRALS, MOST_STATES};
use crate::solver::State;
use crate::solver::double::Double;
use crate::solver::extremes::Extremes;
use crate::solver::limits::{Limit, Limits};
use crate::solver::orbit::Orbit;
use crate::solver::segment::Segment;
use crate::solver::step_control::StepControl;

mod evaluation;
mod events;
mod extension;

/// Steps that one call may take.
const MOST_STEPS: u32 = 2_000_000;

/// What rounding may leave of a step that has been made.
const LAST_BITS: f64 = 1e-18;

/// Pieces kept to find an orbit.
pub(super) const CAPACITY: usize = 64;

/// Why a motion stops before the time asked for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Event {
    /// It has come to a limit of the position.
    Limit(Limit),
    /// The margin of the equation has vanished.
    Margin,
}

pub use crate::solver::outcome::Failure;

/// How far an advance came.
pub type Progress = crate::solver::outcome::Progress<Event>;

/// The motion over one step.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Piece {
    /// Time at which it begins, counted from the origin of time.
    pub begin: Double,
    /// Where the position is counted from.
    pub origin: Double,
    /// The position from there on.
    pub segment: Segment,
}

impl Piece {
    pub fn end(&self) -> Double {
        self.begin.plus(self.segment.length())
    }
}

/// A motion of a coupled system that is followed forward in time. It can be stored, and goes on
/// bit for bit on processors of the same SIMD level.
#[derive(Debug, Serialize, Deserialize)]
pub struct Trajectory {
    #[serde(skip, default = "Level::new")]
    pub(super) level: Level,
    pub(super) control: StepControl,
    pub(super) limits: Limits,
    /// Present time of the model: all steps summed up.
    pub(super) time: Double,
    /// Time of the model at which the first piece begins.
    pub(super) since: Double,
    /// State at that time, its position counted from `origin`.
    pub(super) start: FullState,
    pub(super) origin: Double,
    /// One after another without a gap; more than one only where an orbit is looked for.
    #[serde(deserialize_with = "super::validation::pieces")]
    pub(super) pieces: Vec<Piece>,
    /// First-order states and integrals over the only piece.
    pub(super) rest: Option<Rest>,
    /// The piece in which the present lies.
    pub(super) index: usize,
    /// The present, counted from `since`; on an orbit folded into it.
    pub(super) now: Double,
    /// −1 while an orbit is run back, else 1.
    pub(super) direction: f64,
    pub(super) first_turn: Option<Double>,
    pub(super) orbit: Option<Orbit>,
    pub(super) stop: Option<(Event, Double)>,
    pub(super) at_rest: bool,
    pub(super) next_length: Option<f64>,
    /// Advances since the last restart.
    pub(super) advances: u32,
    /// The last start was good for a single advance.
    pub(super) restless: bool,
    /// x'' and z' just before the last restart: where they jump, fast transients begin.
    pub(super) slopes_before: Option<(f64, [f64; MOST_STATES])>,
    /// Whether the margin of the equation is still awaited.
    pub(super) awaits_margin: bool,
    pub(super) extremes: Option<Extremes>,
    /// The time up to which they are recorded, counted from `since`.
    pub(super) recorded: Double,
}

impl Clone for Trajectory {
    fn clone(&self) -> Trajectory {
        let mut pieces = Vec::with_capacity(CAPACITY);
        pieces.extend_from_slice(&self.pieces);
        Trajectory { pieces, ..*self }
    }
}

impl Trajectory {
    /// A motion from `start` at `time`, followed with a relative `tolerance` of every state
    /// between the `limits` of the position. The position is counted from 0.
    #[must_use]
    pub fn new(start: FullState, time: Double, limits: Limits, tolerance: f64) -> Trajectory {
        Trajectory::with(Vec::with_capacity(CAPACITY), start, time, limits, tolerance)
    }

    /// [`Trajectory::new`] in the memory of this one.
    pub fn begin_anew(&mut self, start: FullState, time: Double, limits: Limits, tolerance: f64) {
        let mut pieces = std::mem::take(&mut self.pieces);
        pieces.clear();
        *self = Trajectory::with(pieces, start, time, limits, tolerance);
    }

    fn with(
        pieces: Vec<Piece>,
        start: FullState,
        time: Double,
        limits: Limits,
        tolerance: f64,
    ) -> Trajectory {
        Trajectory {
            level: Level::new(),
            control: StepControl::new(tolerance),
            limits,
            time,
            since: time,
            start,
            origin: Double::ZERO,
            pieces,
            rest: None,
            index: 0,
            now: Double::ZERO,
            direction: 1.0,
            first_turn: None,
            orbit: None,
            stop: None,
            at_rest: false,
            next_length: None,
            advances: 0,
            restless: false,
            slopes_before: None,
            awaits_margin: true,
            extremes: None,
            recorded: Double::ZERO,
        }
    }

    /// Records the extremes of the motion from now on.
    #[must_use]
    pub fn recording_extremes(mut self) -> Trajectory {
        self.extremes = Some(Extremes::at(self.position()));
        self
    }

    /// The extremes up to the present, where they are recorded.
    #[must_use]
    pub fn extremes(&self) -> Option<Extremes> {
        self.extremes
    }

    /// Computes the motion with this set of processor instructions.
    #[must_use]
    pub fn with_level(mut self, level: Level) -> Trajectory {
        self.level = level;
        self
    }

    /// The present time of the model.
    #[must_use]
    pub fn time(&self) -> &Double {
        &self.time
    }

    /// Sets the clock, and moves nothing. Where the equation depends on time, a
    /// [`Trajectory::restart`] must follow.
    pub fn set_clock(&mut self, time: Double) {
        self.since = self.since.add(time.sub(self.time));
        self.time = time;
    }

    /// Starts the extremes anew at the present position, or ends their recording.
    pub fn record_extremes_anew(&mut self, records: bool) {
        self.extremes = records.then(|| Extremes::at(self.position()));
        self.recorded = self.now;
    }

    /// Lets time pass in which nothing moves.
    pub fn wait(&mut self, time: Double) {
        self.time = self.time.add(time);
    }

    /// Goes on without awaiting the margin of the equation any more.
    pub fn pass_margin(&mut self) {
        self.awaits_margin = false;
        if matches!(self.stop, Some((Event::Margin, _))) {
            // The piece is cut at the present; what follows is looked at anew.
            self.restart();
        }
    }

    /// Starts anew from the present state: the equation has changed.
    pub fn restart(&mut self) {
        self.restless = self.advances == 1;
        self.advances = 0;
        if !self.pieces.is_empty() {
            self.slopes_before = Some(self.slopes_at_present());
            let state = self.full_state();
            self.origin = self.pieces[self.index].origin;
            self.start = state;
        }
        self.since = self.time;
        self.forget();
    }

    /// Adds to the integrals at once, and to the first-order states: a jump of an input.
    /// To be called right after a restart.
    pub fn jump(&mut self, states: &[f64; MOST_STATES], integrals: &[f64; MOST_INTEGRALS]) {
        for (state, jump) in self.start.internal.iter_mut().zip(states) {
            *state += jump;
        }
        for (integral, jump) in self.start.integrals.iter_mut().zip(integrals) {
            *integral += jump;
        }
    }

    /// Forgets the motion that has led to its start.
    fn forget(&mut self) {
        self.pieces.clear();
        self.rest = None;
        self.index = 0;
        self.now = Double::ZERO;
        self.recorded = Double::ZERO;
        self.direction = 1.0;
        self.first_turn = None;
        self.orbit = None;
        self.stop = None;
        self.at_rest = false;
    }

    /// Follows the motion for the time `step` > 0. The `equation` must be the same as in the
    /// calls before, back to the last [`Trajectory::restart`].
    ///
    /// # Errors
    /// [`Failure`] where the integration cannot go on; the trajectory then stands at the end of
    /// the last step.
    pub fn advance<E: CoupledEquation>(
        &mut self,
        equation: &E,
        step: f64,
    ) -> Result<Progress, Failure> {
        self.advances = self.advances.saturating_add(1);
        if self.at_rest {
            self.time = self.time.plus(step);
            return Ok(Progress::Whole);
        }
        let progress = self.advance_further(equation, step);
        let passed = match progress {
            Ok(Progress::Whole) => step,
            Ok(Progress::Stopped { after, .. })
            | Err(
                Failure::SubstepTooShort { after, .. } | Failure::TooManySubsteps { after, .. },
            ) => after,
        };
        self.time = self.time.plus(passed).tightened();
        progress
    }

    fn advance_further<E: CoupledEquation>(
        &mut self,
        equation: &E,
        step: f64,
    ) -> Result<Progress, Failure> {
        if let Some(orbit) = self.orbit {
            self.run_orbit(orbit, step);
            return Ok(Progress::Whole);
        }
        let mut target = self.now.plus(step);
        for _ in 0..MOST_STEPS {
            if let Some((event, at)) = self.stop
                && target.since(at) >= 0.0
            {
                let after = step - target.since(at);
                self.arrive(at);
                return Ok(Progress::Stopped {
                    limit: event,
                    after,
                });
            }
            let rest = target.since(self.end());
            if rest <= LAST_BITS * step {
                self.arrive(if rest > 0.0 { self.end() } else { target });
                return Ok(Progress::Whole);
            }
            let shift = match self.extend(equation, rest) {
                Ok(shift) => shift,
                Err(length) => {
                    let after = step - self.stand_at_end(target);
                    return Err(Failure::SubstepTooShort { length, after });
                }
            };
            target = target.sub(shift);
            if self.at_rest {
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
        let after = step - self.stand_at_end(target);
        Err(Failure::TooManySubsteps {
            most: MOST_STEPS,
            after,
        })
    }

    /// The end of the last piece.
    pub(super) fn end(&self) -> Double {
        self.pieces.last().map_or(Double::ZERO, Piece::end)
    }

    /// Moves the present to the end of the last piece and returns the time from there to
    /// `target`.
    fn stand_at_end(&mut self, target: Double) -> f64 {
        let end = self.end();
        self.arrive(end);
        target.since(end)
    }

    /// The present position and rate, the position counted from 0.
    #[must_use]
    pub fn state(&self) -> State {
        State {
            position: self.position(),
            rate: self.rate(),
        }
    }
}
