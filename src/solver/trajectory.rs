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
use super::orbit::Orbit;
pub use super::outcome::{Failure, Progress};
use super::segment::Segment;
use super::step_control::{StepControl, Verdict};
use super::{Equation, LocalEquation, State};

/// Pieces kept to find an orbit; an orbit near a saddle takes about 20.
const CAPACITY: usize = 48;

/// An orbit is repeated as long as the caller likes, and so is its error; the
/// errors of ever new starts add up. Neither costs more than a sweep or two.
const REPEATED_SHARE: f64 = 0.001;

/// First substep in units of the motion's time scale.
const FIRST_SUBSTEP: f64 = 2.0;

/// A substep shorter than this part of the time scale cannot go on.
const SHORTEST: f64 = 1e-12;

/// Substeps that one call may take: about a second of work.
const MOST_SUBSTEPS: u32 = 2_000_000;

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
    /// For less time than this the present stays in its piece and meets nothing.
    slack: f64,
    first_turn: Option<Double>,
    orbit: Option<Orbit>,
    stop: Option<(Limit, Double)>,
    at_rest: bool,
    next_length: Option<f64>,
    /// Whether a motion that repeats is looked for.
    follows_orbits: bool,
    /// Advances since the last restart.
    advances: u32,
    /// The last start was good for a single advance: the host changes the
    /// equation at each communication point, and looking ahead is of no use.
    restless: bool,
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
            slack: 0.0,
            first_turn: None,
            orbit: None,
            stop: None,
            at_rest: false,
            next_length: None,
            follows_orbits: true,
            advances: 0,
            restless: false,
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
        self.restless = self.advances == 1;
        self.advances = 0;
        self.count = 0;
        self.index = 0;
        self.now = Double::ZERO;
        self.direction = 1.0;
        self.slack = 0.0;
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
        let offset = self.now.since(*begin);
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
        self.advances = self.advances.saturating_add(1);
        if step < self.slack {
            self.slack -= step;
            self.now = self.now.plus(self.direction * step);
            return Ok(Progress::Whole);
        }
        if let Some(orbit) = self.orbit {
            self.run_orbit(orbit, step);
            return Ok(Progress::Whole);
        }
        if self.at_rest {
            return Ok(Progress::Whole);
        }
        let mut target = self.now.plus(step);
        let mut substeps = 0;
        loop {
            if let Some((limit, at)) = self.stop
                && target.since(at) >= 0.0
            {
                let after = step - target.since(at);
                self.arrive(at);
                return Ok(Progress::Stopped { limit, after });
            }
            if self.count > 0 && target.since(self.end()) <= 0.0 {
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
            let rest = target.since(self.end());
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
    }

    /// The end of the last piece.
    fn end(&self) -> Double {
        if self.count == 0 {
            return Double::ZERO;
        }
        let last = &self.pieces[self.count - 1];
        last.begin.plus(last.segment.length())
    }

    /// Moves the present to the end of the last piece and returns the time
    /// from there to `target`.
    fn stand_at_end(&mut self, target: Double) -> f64 {
        let end = self.end();
        self.arrive(end);
        target.since(end)
    }

    /// Moves the present to `target`, which lies in one of the pieces.
    fn arrive(&mut self, target: Double) {
        self.now = target;
        if self.count == 0 {
            // Not even the first substep could be solved.
            return;
        }
        while self.index + 1 < self.count && target.since(self.pieces[self.index + 1].begin) > 0.0 {
            self.index += 1;
        }
        while self.index > 0 && target.since(self.pieces[self.index].begin) < 0.0 {
            self.index -= 1;
        }
        let Piece { begin, segment } = &mut self.pieces[self.index];
        let offset = target.since(*begin);
        let ahead = segment.length() - offset;
        if ahead == 0.0 {
            self.slack = 0.0;
            return;
        }
        segment.expand();
        let mut room = if self.direction > 0.0 { ahead } else { offset };
        if let Some(orbit) = &self.orbit {
            room = room.min(orbit.time_to_turn(target, self.direction));
        }
        if let Some((_, at)) = self.stop {
            room = room.min(at.since(target));
        }
        // Less than all of it, since it is counted down with rounding.
        self.slack = room * (1.0 - 1e-9);
    }

    /// Moves the present along the orbit by the time `step`.
    fn run_orbit(&mut self, orbit: Orbit, step: f64) {
        let (now, direction) = orbit.run(self.now, self.direction, step);
        self.direction = direction;
        self.arrive(now);
    }

    /// Adds one more piece; `rest` is the time still asked for. Returns by how
    /// much the origin was moved.
    /// The error is the length of a substep that was too short to go on.
    fn extend<E: Equation>(&mut self, equation: &E, rest: f64) -> Result<Double, f64> {
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
        let most = if self.restless { rest } else { f64::INFINITY };
        let substep = self.substep(&local, state, autonomous, slot, most)?;
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
            .first_contact(&mut piece.segment, substep.nodes())
            .map(|(limit, offset)| (limit, piece.begin.plus(offset)));
        if autonomous && self.stop.is_none() {
            self.look_for_turn(state.rate);
        }
        Ok(shift)
    }

    /// Solves the next substep into a slot, as long as the tolerance allows but
    /// no longer than `most`.
    fn substep<L: LocalEquation>(
        &mut self,
        local: &L,
        state: State,
        autonomous: bool,
        slot: usize,
        most: f64,
    ) -> Result<Substep, f64> {
        let time_scale = local.time_scale(state);
        let shortest = (SHORTEST * time_scale).min(0.5 * most);
        let mut control = self.control;
        if autonomous || self.restless {
            control.tolerance *= REPEATED_SHARE;
        }
        let scale = state.position.abs();
        let free = self.next_length.unwrap_or(FIRST_SUBSTEP * time_scale);
        let most = most.min(local.longest_substep());
        let mut length = free.min(most);
        loop {
            if length.is_nan() || length <= shortest {
                return Err(length);
            }
            let settled = control.settled() * scale;
            let segment = &mut self.pieces[slot].segment;
            let solved = collocation::solve(self.level, local, state, length, settled, segment);
            let verdict = match &solved {
                Ok(substep) if self.limits.are_left_behind_by(substep.nodes()) => {
                    Verdict::Reject(0.5)
                }
                Ok(substep) => control.judge(substep.error / scale, substep.contraction),
                Err(collocation::Diverged) => Verdict::Reject(0.5),
            };
            match (verdict, solved) {
                (Verdict::Accept(factor), Ok(substep)) => {
                    // A substep cut short says little about the next one.
                    self.next_length = Some(if length == most {
                        free
                    } else {
                        length * factor
                    });
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
        let turn = begin.plus(offset);
        match self.first_turn {
            None => self.first_turn = Some(turn),
            Some(first_turn) if turn.since(first_turn) > 0.0 => {
                self.orbit = Some(Orbit::between(first_turn, turn));
            }
            Some(_) => {}
        }
    }
}
