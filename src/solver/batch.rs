//! Many independent motions at once, one in each SIMD lane.
//!
//! Each lane takes strides of its own length (8 nodes, see `stride`); the lanes
//! share only the sweeps of the iteration. A motion that comes near a limit, or
//! that strides cannot follow, is given back to be followed alone.

use fearless_simd::{Level, Simd, dispatch, f64x8};

use super::collocation::{self, Series, Substep};
use super::double::Double;
use super::extremes::Extremes;
use super::lanes::Lanes;
use super::limits::Limits;
use super::number::Number;
use super::step_control::{StepControl, Verdict};
use super::stride::{self, NEGLECTED, PAIRS};
use super::tables::GAUSS_8;
use super::{Equation, LocalEquation, State};

/// Motions that are followed at once.
pub const LANES: usize = 8;

/// Numbers of all lanes.
pub type Row = [f64; LANES];

/// Sweeps after which a lane that still moves takes a shorter stride.
const MOST_SWEEPS: u32 = 12;

/// Steps of Newton's method to a turning point.
const MOST_ROUNDS: u32 = 8;

/// This near to a turning point, as a part of the stride, what is left of the
/// position is of third order: 1e-18 of the swing.
const NEAR: f64 = 1e-6;

/// Strides after which a motion is given back.
const MOST_STRIDES: u32 = 2_000_000;

/// Corrections below this many ulps of the position are rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

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
            round.ask(index, lane.as_ref(), &course);
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
            let local = equation.at(self.start);
            let free = local.time_scale(*start);
            // An orbit is followed faster alone, a fast drive needs more nodes.
            if equation.is_autonomous() || local.longest_substep() < free {
                continue;
            }
            let f = local.acceleration(local.load(0.0), start.position, start.rate);
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
        let error = stride::end_error(&substep) / NEGLECTED / scale;
        let verdict = match ended {
            true => self.control.judge_stride(error, substep.contraction),
            false => Verdict::Reject(0.5),
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
        let beyond = 0.25 * (substep.highest - substep.lowest);
        let (low, high) = (substep.lowest - beyond, substep.highest + beyond);
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
            let local = equation.at(time);
            let f = local.acceleration(local.load(0.0), state.position, state.rate);
            let correction = -state.rate / f;
            // What is left out is of third order.
            if correction.abs() < near {
                return Some(state.position + 0.5 * state.rate * correction);
            }
            offset += correction;
            if !(offset > 0.0) {
                return None;
            }
        }
        None
    }
}

/// A stride in each lane: what is asked for, and what came out.
#[derive(Clone, Debug)]
struct Round {
    position: Row,
    rate: Row,
    half: Row,
    /// By how much the stride is longer than the one before.
    ratio: Row,
    /// The series before by half the square of its length, by degree.
    before: [Row; 2 * PAIRS],
    settled: Row,
    expected: Row,
    end_position: Row,
    end_rate: Row,
    highest: Row,
    lowest: Row,
    contraction: Row,
    /// The series of the stride, by degree.
    series: [Row; 2 * PAIRS],
    /// The rates at its nodes, in the order of time.
    rates: [Row; 2 * PAIRS],
    /// Above 0 where the iteration has not ended.
    excess: Row,
}

impl Round {
    /// Nothing to do in any lane: all rest at 1.
    const IDLE: Round = Round {
        position: [1.0; LANES],
        rate: [0.0; LANES],
        half: [0.0; LANES],
        ratio: [0.0; LANES],
        before: [[0.0; LANES]; 2 * PAIRS],
        settled: [1.0; LANES],
        expected: [0.0; LANES],
        end_position: [1.0; LANES],
        end_rate: [0.0; LANES],
        highest: [1.0; LANES],
        lowest: [1.0; LANES],
        contraction: [0.0; LANES],
        series: [[0.0; LANES]; 2 * PAIRS],
        rates: [[0.0; LANES]; 2 * PAIRS],
        excess: [0.0; LANES],
    };

    /// Asks for the next stride of a lane, or for none.
    fn ask<E>(&mut self, index: usize, lane: Option<&Lane>, course: &Course<E>) {
        let Some(lane) = lane else {
            self.half[index] = 0.0;
            return;
        };
        let rest = course.end.since(lane.time);
        let length = stride::share(rest, lane.free);
        self.position[index] = lane.state.position;
        self.rate[index] = lane.state.rate;
        self.half[index] = 0.5 * length;
        self.settled[index] = course.control.settled() * lane.state.position.abs();
        self.expected[index] = (lane.contraction * length * length).min(1.0);
        let Series { half, even, odd } = lane.before;
        self.ratio[index] = 0.5 * length / half;
        let size = 1.0 / (half * half);
        for k in 0..PAIRS {
            self.before[2 * k][index] = even[k] * size;
            self.before[2 * k + 1][index] = odd[k] * size;
        }
    }

    /// How often the motion turns in the stride of a lane, and about when, since
    /// its begin, it does so the last time.
    fn turns(&self, index: usize, begin: f64, end: f64) -> (usize, f64) {
        let half = self.half[index];
        let place = |k: usize| match k {
            _ if k < PAIRS => half * (1.0 - GAUSS_8.node[PAIRS - 1 - k]),
            _ if k < 2 * PAIRS => half * (1.0 + GAUSS_8.node[k - PAIRS]),
            _ => 2.0 * half,
        };
        let inside = self.rates.iter().map(|row| row[index]);
        let (mut count, mut about) = (0, 0.0);
        let mut before = (0.0, begin);
        for (k, rate) in inside.chain([end]).enumerate() {
            let now = (place(k), rate);
            if now.1 * before.1 < 0.0 {
                count += 1;
                about = before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1);
            }
            before = now;
        }
        (count, about)
    }

    /// The stride of a lane.
    fn substep(&self, index: usize) -> Substep<PAIRS> {
        Substep {
            end: State {
                position: self.end_position[index],
                rate: self.end_rate[index],
            },
            series: Series {
                half: self.half[index],
                even: std::array::from_fn(|k| self.series[2 * k][index]),
                odd: std::array::from_fn(|k| self.series[2 * k + 1][index]),
            },
            highest: self.highest[index],
            lowest: self.lowest[index],
            sweeps: 0,
            contraction: self.contraction[index],
        }
    }
}

/// Solves the strides of a round: `collocation::solve` with motions in the
/// lanes in place of nodes.
#[inline(always)]
fn solve_with<S: Simd, F: Fleet>(simd: S, fleet: &F, round: &mut Round) {
    solve::<S, f64x8<S>, F>(simd, fleet, round);
}

#[inline(always)]
fn solve<S: Simd, V: Lanes<S, LANES>, F: Fleet>(simd: S, fleet: &F, round: &mut Round) {
    let tables = &GAUSS_8;
    let equation = fleet.abreast::<S, V>(simd);
    let fill = |value: f64| V::fill(simd, value);
    let position = V::load(simd, &round.position);
    let rate = V::load(simd, &round.rate);
    let half = V::load(simd, &round.half);
    let ratio = V::load(simd, &round.ratio);
    let square = half * half;
    let step = half * rate;
    let middle = position + step;
    let zero = fill(0.0);

    let mut loads = [[equation.load(half); 2]; PAIRS];
    let mut f = [[zero; 2]; PAIRS];
    for i in 0..PAIRS {
        let shift = half * fill(tables.node[i]);
        loads[i] = [equation.load(half + shift), equation.load(half - shift)];
        let from = fill(1.0) + ratio;
        let reach = ratio * fill(tables.node[i]);
        f[i] = [
            continued(simd, &round.before, from + reach),
            continued(simd, &round.before, from - reach),
        ];
    }
    let settled = V::load(simd, &round.settled);
    let expected = V::load(simd, &round.expected);
    let rounding = fill(ROUNDING) * position.abs();
    let mut old = [[zero; 2]; PAIRS];
    let mut contraction = zero;
    let mut last_change = zero;
    let mut sweeps = 0;
    loop {
        sweeps += 1;
        let mut sums = [zero; PAIRS];
        let mut differences = [zero; PAIRS];
        let (mut mean, mut tilt) = (zero, zero);
        for j in 0..PAIRS {
            sums[j] = f[j][0] + f[j][1];
            differences[j] = f[j][0] - f[j][1];
            mean = sums[j].mul_add(fill(tables.mean[j]), mean);
            tilt = differences[j].mul_add(fill(tables.tilt[j]), tilt);
        }
        let mut change = zero;
        let mut highest = fill(f64::NEG_INFINITY);
        let mut lowest = fill(f64::INFINITY);
        let mut new = [[(zero, zero); 2]; PAIRS];
        for i in 0..PAIRS {
            let (mut once_odd, mut once_even) = (zero, mean);
            let (mut twice_even, mut twice_odd) = (zero - tilt, fill(tables.node[i]) * mean);
            for j in 0..PAIRS {
                once_odd = sums[j].mul_add(fill(tables.once_from_sums[j][i]), once_odd);
                once_even =
                    differences[j].mul_add(fill(tables.once_from_differences[j][i]), once_even);
                twice_even = sums[j].mul_add(fill(tables.twice_from_sums[j][i]), twice_even);
                twice_odd =
                    differences[j].mul_add(fill(tables.twice_from_differences[j][i]), twice_odd);
            }
            let even = twice_even.mul_add(square, middle);
            let odd = twice_odd.mul_add(square, fill(tables.node[i]) * step);
            let rate_even = once_even.mul_add(half, rate);
            let rate_odd = once_odd * half;
            new[i] = [
                (even + odd, rate_even + rate_odd),
                (even - odd, rate_even - rate_odd),
            ];
            for side in 0..2 {
                let place = new[i][side].0;
                change = change.max((place - old[i][side]).abs());
                highest = highest.max(place);
                lowest = lowest.min(place);
                old[i][side] = place;
            }
        }
        if sweeps > 1 {
            let observed = if sweeps == 2 {
                expected
            } else {
                change / last_change.max(fill(f64::MIN_POSITIVE))
            };
            contraction = contraction.max(observed);
            // The error left is the change times the rate of convergence.
            let left = change * contraction - settled * (fill(1.0) - contraction);
            let excess = left.min(change - rounding);
            if excess.largest() <= 0.0 || sweeps == MOST_SWEEPS {
                let end = (mean - tilt).mul_add(fill(2.0) * square, position + fill(2.0) * step);
                round.end_position = end.store();
                round.end_rate = mean.mul_add(fill(2.0) * half, rate).store();
                round.highest = highest.store();
                round.lowest = lowest.store();
                round.contraction = contraction.store();
                round.excess = excess.store();
                for k in 0..PAIRS {
                    round.rates[PAIRS + k] = new[k][0].1.store();
                    round.rates[PAIRS - 1 - k] = new[k][1].1.store();
                    let (mut even, mut odd) = (zero, zero);
                    for j in 0..PAIRS {
                        even = sums[j].mul_add(fill(tables.series_from_sums[j][k]), even);
                        odd =
                            differences[j].mul_add(fill(tables.series_from_differences[j][k]), odd);
                    }
                    round.series[2 * k] = (even * square).store();
                    round.series[2 * k + 1] = (odd * square).store();
                }
                return;
            }
            if sweeps == 2 {
                contraction = zero;
            }
        }
        last_change = change;
        for i in 0..PAIRS {
            for side in 0..2 {
                let (place, speed) = new[i][side];
                f[i][side] = equation.acceleration(loads[i][side], place, speed);
            }
        }
    }
}

/// f of the strides before, continued to u in each lane.
#[inline(always)]
fn continued<S: Simd, V: Lanes<S, LANES>>(simd: S, series: &[Row; 2 * PAIRS], u: V) -> V {
    collocation::clenshaw::<V, PAIRS>(u, |degree| V::load(simd, &series[degree]))
}
