//! Many independent motions at once, one in each SIMD lane.
//!
//! Each lane takes strides of its own length (8 nodes, see `stride`); the lanes
//! share only the sweeps of the iteration. A motion that comes near a limit, or
//! that strides cannot follow, is given back to be followed alone.

use fearless_simd::{Level, Simd, dispatch, f64x8};

use crate::solver::collocation::Series;
use crate::solver::double::Double;
use crate::solver::extremes::Extremes;
use crate::solver::lanes::Lanes;
use crate::solver::limits::Limits;
use crate::solver::number::Number;
use crate::solver::step_control::{StepControl, Verdict};
use crate::solver::stride::{self, PAIRS};
use crate::solver::{Equation, LocalEquation, State};

/// Motions that are followed at once.
pub const LANES: usize = 8;

mod round;

use round::Round;

/// Numbers of all lanes.
pub type Row = [f64; LANES];

/// Steps of Newton's method to a turning point.
const MOST_ROUNDS: u32 = 8;

/// This near to a turning point, as a part of the stride, what is left of the
/// position is of third order: 1e-18 of the swing.
const NEAR: f64 = 1e-6;

/// Strides after which a motion is given back.
const MOST_STRIDES: u32 = 2_000_000;

/// The equations x'' = f(t, x, x') of all lanes, each seen from a time of its own.
pub trait Fleet {
    /// The equation of one lane.
    type Equation: Equation;
    /// The equations with their numbers in lanes.
    type Abreast<N: Number>: Abreast<N>;

    /// Puts an equation into a lane, seen from `time`.
    fn put(&mut self, lane: usize, equation: &Self::Equation, time: Double);

    /// The equations in lanes.
    fn abreast<S: Simd, V: Lanes<S, LANES>>(&self, simd: S) -> Self::Abreast<V>;

    /// Moves the times from which they are seen.
    fn advance<S: Simd, V: Lanes<S, LANES>>(&mut self, simd: S, by: &Row);
}

/// The equations of a [`Fleet`] with their numbers in lanes.
pub trait Abreast<N: Number> {
    /// What f needs to know of the time.
    type Load: Copy;

    /// The load at `offset` after the times from which they are seen.
    fn load(&self, offset: N) -> Self::Load;

    /// x'' under this load.
    fn acceleration(&self, load: Self::Load, position: N, rate: N) -> N;
}

/// A motion to be followed.
#[derive(Clone, Copy, Debug)]
pub struct Motion<E> {
    /// Its equation.
    pub equation: E,
    /// Its state at the start.
    pub start: State,
    /// Its limits.
    pub limits: Limits,
}

/// Where a motion came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// The state at the end.
    pub state: State,
    /// The extremes on the way.
    pub extremes: Extremes,
}

/// Follows all motions from `start` to `end` and returns, in their order, where
/// they came to; nothing for those that have to be followed alone.
pub fn follow<F: Fleet>(
    level: Level,
    fleet: &mut F,
    motions: &[Motion<F::Equation>],
    [start, end]: [Double; 2],
    tolerance: f64,
) -> Vec<Option<Arrival>> {
    let mut course = Course {
        level,
        motions,
        start,
        end,
        control: StepControl::new(tolerance),
        next: 0,
        arrivals: vec![None; motions.len()],
    };
    let mut lanes: [Option<Lane>; LANES] = [None; LANES];
    for (index, lane) in lanes.iter_mut().enumerate() {
        *lane = course.board(fleet, index);
    }
    let mut round = Round::IDLE;
    while lanes.iter().any(Option::is_some) {
        for (index, lane) in lanes.iter().enumerate() {
            round.ask(index, lane.as_ref(), course.end, course.control);
        }
        dispatch!(level, simd => solve_with(simd, fleet, &mut round));
        for (index, lane) in lanes.iter_mut().enumerate() {
            let Some(followed) = lane else {
                continue;
            };
            if !course.judge(followed, &mut round, index) {
                *lane = course.board(fleet, index);
                // The fleet has the next motion's time.
                round.half[index] = 0.0;
            }
        }
        dispatch!(level, simd => advance_with(simd, fleet, &round));
    }
    course.arrivals
}

#[inline(always)]
fn solve_with<S: Simd, F: Fleet>(simd: S, fleet: &F, round: &mut Round) {
    round.solve::<S, f64x8<S>, F>(simd, fleet);
}

#[inline(always)]
fn advance_with<S: Simd, F: Fleet>(simd: S, fleet: &mut F, round: &Round) {
    fleet.advance::<S, f64x8<S>>(simd, &round.half.map(|half| 2.0 * half));
}

/// The motion in a lane.
#[derive(Clone, Copy, Debug)]
struct Lane {
    /// Which of the motions it is.
    motion: usize,
    time: Double,
    state: State,
    extremes: Extremes,
    /// Length of the next stride, where it is free.
    free: f64,
    /// The stride before.
    before: Series<PAIRS>,
    /// The contraction to be expected by the square of the length.
    contraction: f64,
    strides: u32,
}

/// What all lanes have in common.
struct Course<'a, E> {
    level: Level,
    motions: &'a [Motion<E>],
    start: Double,
    end: Double,
    control: StepControl,
    /// The motion that the next free lane takes.
    next: usize,
    arrivals: Vec<Option<Arrival>>,
}

impl<E: Equation> Course<'_, E> {
    /// Takes the next motion that strides can follow into a lane.
    fn board<F: Fleet<Equation = E>>(&mut self, fleet: &mut F, index: usize) -> Option<Lane> {
        loop {
            let motion = self.next;
            let Motion {
                equation, start, ..
            } = self.motions.get(motion)?;
            self.next += 1;
            let local = equation.seen_from(&self.start);
            let free = local.time_scale(*start);
            // An orbit is followed faster alone, a fast drive needs more nodes.
            if equation.repeats() || local.longest_substep() < free {
                continue;
            }
            let f = local.acceleration_from(*start);
            fleet.put(index, equation, self.start);
            return Some(Lane {
                motion,
                time: self.start,
                state: *start,
                extremes: Extremes::at(start.position),
                free: free.min(local.longest_substep()),
                before: Series::constant(f),
                contraction: f64::MAX,
                strides: 0,
            });
        }
    }

    /// Takes the stride of a lane or shortens the next one. False where its
    /// motion has come to its end or has to be followed alone.
    fn judge(&mut self, lane: &mut Lane, round: &mut Round, index: usize) -> bool {
        let length = 2.0 * round.half[index];
        let scale = lane.state.position.abs();
        let substep = round.substep(index);
        let ended = round.excess[index] <= 0.0 && substep.end.position.is_finite();
        let verdict = if ended {
            let error = stride::end_error(&substep) / scale;
            self.control
                .judge_stride::<PAIRS>(error, substep.contraction)
        } else {
            Verdict::Reject(0.5)
        };
        lane.strides += 1;
        let factor = match verdict {
            Verdict::Accept(factor) => factor,
            Verdict::Reject(factor) => {
                round.half[index] = 0.0;
                lane.free = factor * length;
                lane.contraction = f64::MAX;
                return lane.strides < MOST_STRIDES && lane.free > 0.0;
            }
        };
        let Motion {
            equation, limits, ..
        } = &self.motions[lane.motion];
        let (low, high) = substep.reach().into_inner();
        if !(limits.lower < low && high < limits.upper) {
            return false;
        }
        let Extremes { lowest, highest } = lane.extremes;
        if low < lowest || high > highest {
            let (turns, about) = round.turns(index, lane.state.rate, substep.end.rate);
            if turns > 1 {
                round.half[index] = 0.0;
                lane.free = 0.5 * length;
                return true;
            }
            if turns == 1 {
                let Some(turn) = self.turn(equation, lane, about) else {
                    return false;
                };
                lane.extremes.include(turn);
            }
            lane.extremes.include(substep.end.position);
        }
        let rest = self.end.since(lane.time);
        lane.state = substep.end;
        lane.before = substep.series;
        if length == rest {
            self.arrivals[lane.motion] = Some(Arrival {
                state: lane.state,
                extremes: lane.extremes,
            });
            return false;
        }
        lane.time = lane.time.plus(length);
        if rest >= 2.0 * lane.free {
            lane.contraction = stride::expected(substep.contraction) / (length * length);
            lane.free = factor * length;
        }
        lane.strides < MOST_STRIDES
    }

    /// The position at which the motion turns about `offset` after the begin of a
    /// stride, by Newton's method.
    fn turn(&self, equation: &E, lane: &Lane, mut offset: f64) -> Option<f64> {
        let near = NEAR * offset;
        for _ in 0..MOST_ROUNDS {
            let time = lane.time.plus(offset);
            let state = stride::state_after(
                self.level,
                equation,
                self.control,
                lane.time,
                lane.state,
                offset,
            )?;
            let local = equation.seen_from(&time);
            let correction = -state.rate / local.acceleration_from(state);
            // What is left out is of third order.
            if correction.abs() < near {
                return Some(state.position + 0.5 * state.rate * correction);
            }
            offset += correction;
            if offset.is_nan() || offset <= 0.0 {
                return None;
            }
        }
        None
    }
}
