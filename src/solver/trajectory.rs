//! The motion from a start onwards: substeps one after another, each answered
//! from its polynomial as long as the caller stays inside it.
//!
//! Where the equation is autonomous, the pieces are kept until the motion has
//! turned twice. Between two turning points it then runs there and back for
//! ever, so that no further substep is integrated, whatever the time asked for.

use fearless_simd::Level;

use super::collocation::{self, Substep};
use super::double::Double;
use super::limits::{Limit, Limits};
use super::segment::Segment;
use super::step_control::{StepControl, Verdict};
use super::{Equation, LocalEquation, State};

/// Pieces kept to find an orbit; an orbit near a saddle takes about 20.
const CAPACITY: usize = 48;

/// An orbit is repeated as long as the caller likes, and so is its error.
const ORBIT_SHARE: f64 = 0.01;

/// First substep in units of the motion's time scale.
const FIRST_SUBSTEP: f64 = 2.0;

/// A substep shorter than this part of the time scale cannot go on.
const SHORTEST: f64 = 1e-12;

/// Substeps that one call may take: about a second of work.
const MOST_SUBSTEPS: u32 = 2_000_000;

/// How far an advance came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// As far as asked.
    Whole,
    /// To a limit, this long after the begin of the advance.
    Stopped {
        /// The limit.
        limit: Limit,
        /// The time from the begin of the advance to the limit.
        after: f64,
    },
}

/// Why an advance could not be finished. The trajectory stands where it came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// Substeps became too short to go on.
    SubstepTooShort {
        /// The length of the last substep tried.
        length: f64,
        /// The time from the begin of the advance.
        after: f64,
    },
    /// The advance needs more substeps than one call may take.
    TooManySubsteps {
        /// The number of substeps allowed.
        most: u32,
        /// The time from the begin of the advance.
        after: f64,
    },
}

/// A segment and the time at which it begins, counted from the trajectory's origin.
#[derive(Clone, Copy, Debug)]
struct Piece {
    begin: Double,
    segment: Segment,
}

/// Where the present lies: at a state that is known, or inside a segment.
enum Present<'a> {
    At(State),
    Inside(&'a Segment, f64),
}

/// The motion between two turning points, which repeats there and back.
#[derive(Clone, Copy, Debug)]
struct Orbit {
    first_turn: Double,
    second_turn: Double,
}

/// A motion that is followed forward in time.
#[derive(Clone, Debug)]
pub struct Trajectory {
    level: Level,
    control: StepControl,
    limits: Limits,
    /// Time of the model at which the first piece begins.
    origin: Double,
    /// State at the origin.
    start: State,
    /// One more than are kept, to solve the next one in.
    pieces: [Piece; CAPACITY + 1],
    /// Number of pieces in use, from the origin on without a gap.
    count: usize,
    /// The piece in which the present lies.
    index: usize,
    /// The present, counted from the origin; on an orbit folded into it.
    now: Double,
    /// −1 while an orbit is run back, else 1.
    direction: f64,
    first_turn: Option<Double>,
    orbit: Option<Orbit>,
    stop: Option<(Limit, Double)>,
    at_rest: bool,
    next_length: Option<f64>,
    /// Whether a motion that repeats is looked for.
    follows_orbits: bool,
}

impl Trajectory {
    /// A motion from `start` at `time`, followed with a relative `tolerance` of
    /// the position inside the `limits`.
    #[must_use]
    pub fn new(start: State, time: Double, limits: Limits, tolerance: f64) -> Trajectory {
        let nothing = Piece {
            begin: Double::ZERO,
            segment: Segment::nothing(start),
        };
        Trajectory {
            level: Level::new(),
            control: StepControl::new(tolerance),
            limits,
            origin: time,
            start,
            pieces: [nothing; CAPACITY + 1],
            count: 0,
            index: 0,
            now: Double::ZERO,
            direction: 1.0,
            first_turn: None,
            orbit: None,
            stop: None,
            at_rest: false,
            next_length: None,
            follows_orbits: true,
        }
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

    /// Starts anew from the present state at `time`: the equation has changed.
    pub fn restart(&mut self, time: Double) {
        self.start = self.state();
        self.origin = time;
        self.count = 0;
        self.index = 0;
        self.now = Double::ZERO;
        self.direction = 1.0;
        self.first_turn = None;
        self.orbit = None;
        self.stop = None;
        self.at_rest = false;
    }

    /// The present position.
    #[must_use]
    pub fn position(&self) -> f64 {
        match self.present() {
            Present::At(state) => state.position,
            Present::Inside(segment, offset) => segment.position(offset),
        }
    }

    /// The present rate.
    #[must_use]
    pub fn rate(&self) -> f64 {
        self.direction
            * match self.present() {
                Present::At(state) => state.rate,
                Present::Inside(segment, offset) => segment.rate(offset),
            }
    }

    /// The present position and rate.
    #[must_use]
    pub fn state(&self) -> State {
        State {
            position: self.position(),
            rate: self.rate(),
        }
    }

    fn present(&self) -> Present<'_> {
        if self.count == 0 || self.now == Double::ZERO {
            return Present::At(self.start);
        }
        let Piece { begin, segment } = &self.pieces[self.index];
        let offset = self.now.sub(*begin).value();
        if offset == segment.length() {
            Present::At(segment.end())
        } else {
            Present::Inside(segment, offset)
        }
    }

    /// Follows the motion for the time `step` > 0. The `equation` must be the
    /// same as in the calls before, back to the last [`Trajectory::restart`].
    ///
    /// # Errors
    /// [`Failure`] where the integration cannot go on; the trajectory then
    /// stands at the end of the last substep.
    pub fn advance<E: Equation>(&mut self, equation: &E, step: f64) -> Result<Progress, Failure> {
        if let Some(orbit) = self.orbit {
            self.run_orbit(orbit, step);
            return Ok(Progress::Whole);
        }
        if self.at_rest {
            return Ok(Progress::Whole);
        }
        let mut target = self.now.add(Double::new(step));
        let mut substeps = 0;
        loop {
            if let Some((limit, at)) = self.stop
                && target.sub(at).value() >= 0.0
            {
                let after = step - target.sub(at).value();
                self.arrive(at);
                return Ok(Progress::Stopped { limit, after });
            }
            if self.count > 0 && target.sub(self.end()).value() <= 0.0 {
                self.arrive(target);
                return Ok(Progress::Whole);
            }
            if substeps == MOST_SUBSTEPS {
                let after = step - self.stand_at_end(target);
                return Err(Failure::TooManySubsteps {
                    most: MOST_SUBSTEPS,
                    after,
                });
            }
            substeps += 1;
            let shift = match self.extend(equation) {
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
                && target.sub(orbit.second_turn).value() > 0.0
            {
                let rest = target.sub(orbit.second_turn).value();
                self.arrive(orbit.second_turn);
                self.run_orbit(orbit, rest);
                return Ok(Progress::Whole);
            }
        }
    }

    /// The end of the last piece.
    fn end(&self) -> Double {
        if self.count == 0 {
            return Double::ZERO;
        }
        let last = &self.pieces[self.count - 1];
        last.begin.add(Double::new(last.segment.length()))
    }

    /// Moves the present to the end of the last piece and returns the time
    /// from there to `target`.
    fn stand_at_end(&mut self, target: Double) -> f64 {
        let end = self.end();
        self.arrive(end);
        target.sub(end).value()
    }

    /// Moves the present to `target`, which lies in one of the pieces.
    fn arrive(&mut self, target: Double) {
        self.now = target;
        while self.index + 1 < self.count
            && target.sub(self.pieces[self.index + 1].begin).value() > 0.0
        {
            self.index += 1;
        }
        while self.index > 0 && target.sub(self.pieces[self.index].begin).value() < 0.0 {
            self.index -= 1;
        }
        let piece = &mut self.pieces[self.index];
        let at_end = target.sub(piece.begin).value() == piece.segment.length();
        if !at_end {
            piece.segment.expand();
        }
    }

    /// Moves the present along the orbit by the time `step`.
    fn run_orbit(&mut self, orbit: Orbit, step: f64) {
        let half_period = orbit.second_turn.sub(orbit.first_turn);
        let period = half_period.scale(2.0);
        // The remainder of two f64 is exact; the low part of the period
        // enters once for each whole period.
        let mut rest = Double::new(step);
        if step >= period.value() {
            let whole = (step / period.high).floor();
            let remainder = Double::new(step % period.high);
            rest = remainder.sub(Double::new(whole * period.low));
        }
        let mut now = self.now.add(rest.scale(self.direction));
        // Two reflections come back to the first direction; a third and fourth
        // happen where rounding left a little more than a period.
        for _ in 0..4 {
            let turn = if now.sub(orbit.second_turn).value() > 0.0 {
                orbit.second_turn
            } else if now.sub(orbit.first_turn).value() < 0.0 && self.direction < 0.0 {
                orbit.first_turn
            } else {
                break;
            };
            now = turn.scale(2.0).sub(now);
            self.direction = -self.direction;
        }
        self.arrive(now);
    }

    /// Adds one more piece. Returns by how much the origin was moved.
    /// The error is the length of a substep that was too short to go on.
    fn extend<E: Equation>(&mut self, equation: &E) -> Result<Double, f64> {
        let autonomous = self.follows_orbits && equation.is_autonomous();
        let begin = self.end();
        let state = match self.count {
            0 => self.start,
            count => self.pieces[count - 1].segment.end(),
        };
        let local = equation.at(self.origin.add(begin));
        if autonomous && self.count == 0 && state.rate == 0.0 {
            self.first_turn = Some(Double::ZERO);
            let load = local.load(0.0);
            self.at_rest = local.acceleration(load, state.position, 0.0) == 0.0;
            if self.at_rest {
                return Ok(Double::ZERO);
            }
        }
        // Pieces are kept only while an orbit may still come out of them. The
        // new one is solved beside the old ones, which stand until it is done.
        let keep = autonomous && self.count < CAPACITY;
        let slot = self.count;
        let substep = self.substep(&local, state, autonomous, slot)?;
        let mut shift = Double::ZERO;
        if keep {
            self.count += 1;
        } else {
            shift = begin;
            self.origin = self.origin.add(begin);
            self.start = state;
            self.now = self.now.sub(begin);
            self.pieces[0] = self.pieces[slot];
            self.count = 1;
            self.index = 0;
            self.first_turn = None;
        }
        let piece = &mut self.pieces[self.count - 1];
        piece.begin = begin.sub(shift);
        self.stop = self
            .limits
            .first_contact(&mut piece.segment, substep.lowest..=substep.highest)
            .map(|(limit, offset)| (limit, piece.begin.add(Double::new(offset))));
        if autonomous && self.stop.is_none() {
            self.look_for_turn(state.rate);
        }
        Ok(shift)
    }

    /// Solves the next substep into a slot, as long as the tolerance allows.
    fn substep<L: LocalEquation>(
        &mut self,
        local: &L,
        state: State,
        autonomous: bool,
        slot: usize,
    ) -> Result<Substep, f64> {
        let time_scale = local.time_scale(state);
        let shortest = SHORTEST * time_scale;
        let mut control = self.control;
        if autonomous {
            control.tolerance *= ORBIT_SHARE;
        }
        let scale = state.position.abs();
        let mut length = self.next_length.unwrap_or(FIRST_SUBSTEP * time_scale);
        loop {
            if length.is_nan() || length <= shortest {
                return Err(length);
            }
            let settled = control.settled() * scale;
            let segment = &mut self.pieces[slot].segment;
            let solved = collocation::solve(self.level, local, state, length, settled, segment);
            let verdict = match &solved {
                Ok(substep) => control.judge(substep.error / scale, substep.contraction),
                Err(collocation::Diverged) => Verdict::Reject(0.5),
            };
            match (verdict, solved) {
                (Verdict::Accept(factor), Ok(substep)) => {
                    self.next_length = Some(length * factor);
                    return Ok(substep);
                }
                (Verdict::Reject(factor) | Verdict::Accept(factor), _) => length *= factor,
            }
        }
    }

    /// Notes a turning point of the last piece; the second one closes the orbit.
    fn look_for_turn(&mut self, rate_at_begin: f64) {
        let Piece { begin, segment } = &mut self.pieces[self.count - 1];
        if rate_at_begin * segment.end().rate >= 0.0 {
            return;
        }
        segment.expand();
        let offset = segment.crossing(0.0, segment.length(), Segment::rate);
        let turn = begin.add(Double::new(offset));
        match self.first_turn {
            None => self.first_turn = Some(turn),
            Some(first_turn) if turn.sub(first_turn).value() > 0.0 => {
                self.orbit = Some(Orbit {
                    first_turn,
                    second_turn: turn,
                });
            }
            Some(_) => {}
        }
    }
}
