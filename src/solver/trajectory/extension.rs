//! The next piece of a motion.

use super::Trajectory;
use crate::solver::collocation::{Diverged, Guess, Substep, Task, solve_by_16};
use crate::solver::double::Double;
use crate::solver::endpoint::{End, Way};
use crate::solver::extremes::Extremes;
use crate::solver::limits::Limits;
use crate::solver::orbit::Orbit;
use crate::solver::pieces::{CAPACITY, Piece};
use crate::solver::segment::{PAIRS, Segment};
use crate::solver::short_step::{ShortStep, Trend};
use crate::solver::step_control::Verdict;
use crate::solver::{Equation, LocalEquation, State};

/// First substep in units of the motion's time scale.
const FIRST_SUBSTEP: f64 = 2.0;

/// A substep shorter than this part of what it was to be cannot go on.
const SHORTEST: f64 = 1e-12;

impl Trajectory {
    /// Whether nothing is asked of the motion for the time `rest` but its end.
    pub(super) fn strides_over<E: Equation>(&self, equation: &E, rest: f64) -> bool {
        if !self.takes_strides {
            return false;
        }
        if self.restless && self.strides.reach(rest) {
            return true;
        }
        let orbits = self.follows_orbits && equation.repeats();
        if self.restless {
            return !orbits && self.strides.are_shorter_than(rest);
        }
        !orbits && self.steps.are_shorter_than(rest)
    }

    /// Makes the first step from the origin on in 4 nodes, if that is possible.
    pub(super) fn takes_short_step<E: Equation>(&mut self, equation: &E, step: f64) -> bool {
        if self.trend.is_none() {
            self.trend = Trend::first(equation, &self.time, self.start, step);
        }
        let clear = self.clear();
        let Some(trend) = &mut self.trend else {
            return false;
        };
        let short = ShortStep {
            time: &self.time,
            length: step,
            clear,
        };
        let control = self.control.repeated();
        let taken = short.take(self.level, equation, control, &mut self.start, trend);
        if !taken {
            // So that a guess that leads nowhere is not made again.
            self.trend = None;
        }
        taken
    }

    /// The positions between which nothing happens.
    fn clear(&self) -> (f64, f64) {
        let Limits { lower, upper } = self.limits;
        match self.extremes {
            Some(Extremes { lowest, highest }) => (lower.max(lowest), upper.min(highest)),
            None => (lower, upper),
        }
    }

    /// Follows the motion from the end of the last piece toward `target`, keeping
    /// none of it, and moves the origin there. Returns by how much; `clear` becomes
    /// false where the next stride might meet a limit or an extreme.
    pub(super) fn stride<E: Equation>(
        &mut self,
        equation: &E,
        target: Double,
        budget: &mut u32,
        clear: &mut bool,
    ) -> Double {
        let begin = self.end();
        self.arrive(begin);
        let mut way = Way {
            begin: self.origin.add(begin),
            now: Double::ZERO,
            state: self.state(),
            target: target.sub(begin),
            clear: self.clear(),
            budget: *budget,
        };
        let end = if self.restless {
            self.single_way(equation, &mut way)
        } else {
            self.steps.go(self.level, equation, self.control, &mut way)
        };
        *budget = way.budget;
        let shift = if end == End::Reached {
            target
        } else {
            begin.add(way.now)
        };
        self.stand_at(way.time(), way.state);
        *clear = end != End::Blocked;
        shift
    }

    /// Goes a way after which the equation changes: a plan of equal steps would serve once only.
    fn single_way<E: Equation>(&mut self, equation: &E, way: &mut Way) -> End {
        let control = self.control.repeated();
        let local = equation.seen_from(&way.begin);
        // A single step takes longer with 16 nodes.
        let single = way.target.since(Double::ZERO) < local.time_scale(way.state);
        if control.is_loose() || single {
            self.strides.go(self.level, equation, control, way)
        } else {
            self.strides.go_finely(self.level, equation, control, way)
        }
    }

    /// Adds one more piece; `rest` is the time still asked for. Returns by how
    /// much the origin was moved.
    /// The error is the length of a substep that was too short to go on.
    pub(super) fn extend<E: Equation>(&mut self, equation: &E, rest: f64) -> Result<Double, f64> {
        let repeats = self.follows_orbits && equation.repeats();
        let begin = self.end();
        let state = match self.pieces.list().last() {
            Some(piece) => piece.segment.end(),
            None => self.start,
        };
        let local = equation.seen_from(&self.origin.add(begin));
        if self.pieces.count() == 0 && state.rate == 0.0 {
            self.at_rest = self.follows_orbits
                && equation.is_autonomous()
                && local.acceleration_from(state) == 0.0;
            if self.at_rest {
                return Ok(Double::ZERO);
            }
            if repeats {
                self.first_turn = Some(Double::ZERO);
            }
        }
        let most = if self.restless { rest } else { f64::INFINITY };
        let substep = self.substep(&local, state, repeats, most)?;
        // Pieces are kept only while an orbit may still come out of them.
        let keep = repeats && self.pieces.count() < CAPACITY;
        let mut shift = Double::ZERO;
        if !keep {
            if self.extremes.is_some() && self.pieces.count() > 0 {
                self.arrive(begin);
            }
            shift = begin;
            self.origin = self.origin.add(begin);
            self.start = state;
            self.now = self.now.sub(begin);
            self.recorded = self.recorded.sub(begin);
            self.index = 0;
            self.first_turn = None;
            self.pieces.clear();
        }
        let begin = begin.sub(shift);
        let mut segment = Segment::new(state, substep.end, &substep.series);
        self.stop = self
            .limits
            .first_contact(&mut segment, substep.reach())
            .map(|(limit, offset)| (limit, begin.plus(offset)));
        self.pieces.push(Piece { begin, segment });
        if repeats && self.stop.is_none() {
            self.look_for_turn(state.rate);
        }
        Ok(shift)
    }

    /// Solves the next substep, as long as the tolerance allows but no longer than
    /// `most`.
    pub(super) fn substep<L: LocalEquation>(
        &mut self,
        local: &L,
        state: State,
        repeats: bool,
        most: f64,
    ) -> Result<Substep<PAIRS>, f64> {
        let control = if repeats || self.restless {
            self.control.repeated()
        } else {
            self.control
        };
        let scale = state.position.abs();
        let time_scale = local.time_scale(state);
        let free = match self.next_length {
            Some(length) => length,
            None => FIRST_SUBSTEP * time_scale,
        };
        let most = most.min(local.longest_substep());
        let shortest = (SHORTEST * free).min(0.5 * most);
        let mut length = free.min(most);
        let last = self.pieces.list().last();
        let before = last.map(|piece| piece.segment.series());
        loop {
            if length.is_nan() || length <= shortest {
                return Err(length);
            }
            let task = Task {
                start: state,
                length,
                closeness: control.closeness(scale, FIRST_SUBSTEP * length / free),
                guess: match &before {
                    Some(before) => Guess::Before(before),
                    None => Guess::Begin(local.acceleration_from(state)),
                },
                contraction: 1.0,
            };
            let solved = solve_by_16(self.level, local, &task);
            let verdict = match &solved {
                Ok(substep) if self.limits.are_left_behind_by(substep.nodes()) => {
                    Verdict::Reject(0.5)
                }
                Ok(substep) => {
                    // Of the position, or of the rate where that is worse.
                    let short = (4.0 * time_scale / length).max(1.0);
                    let missed = short * substep.tail() / NEGLECTED;
                    control.judge(missed / scale, substep.contraction)
                }
                Err(Diverged) => Verdict::Reject(0.5),
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
        let Some(Piece { begin, segment }) = self.pieces.last() else {
            return;
        };
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

/// Between the nodes the position misses less than this part of the last two
/// Legendre coefficients: f is integrated twice, which divides degree 16 by
/// some 16², and its series goes on falling. Measured on DC and AC motions with
/// substeps of 6 to 14: 5 to 18 times less, which leaves room for the rate,
/// whose error is larger by the inverse of the motion's time scale.
const NEGLECTED: f64 = 1000.0;
