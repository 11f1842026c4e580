//! The motions that wait for a lane, and what becomes of those in the lanes between two blocks of
//! steps.

use fearless_simd::Level;

use super::multistep::{BLOCK, Falkner, HISTORY, LaneStates, STIFFER};
use super::{Arrival, Ensemble, InitialValueProblem, LANES, history, turning_point};
use crate::arithmetic::double_double::DoubleDouble;
use crate::solver::extremes::Extremes;
use crate::solver::trajectory::{Failure, Progress, Trajectory};
use crate::solver::{Equation, LocalEquation, State};

/// A correction that is this much smaller than allowed asks for longer steps.
const IDLE_CORRECTION: f64 = 1.0 / 60.0;

/// Blocks between two looks at a lane that needs none: longer steps are thought of, and the
/// equation is seen from the time anew.
const CALM_BLOCKS: u64 = 8;

/// The motion alone has to be this much more accurate where it starts a multistep motion.
const START_SHARE: f64 = 0.01;

/// A motion whose steps have become this much shorter than at its start is followed alone.
const SHORTEST: f64 = 1.0 / 64.0;

/// Changes of the step after which a motion is followed alone.
const MOST_CHANGES: u32 = 10_000;

/// The motion in a lane.
#[derive(Clone, Copy, Debug)]
struct Lane {
    /// Which of the motions it is.
    motion: usize,
    /// Its time when it was last looked at.
    time: DoubleDouble,
    /// Blocks since then.
    passed: u64,
    /// Blocks from then to the next look.
    due: u64,
    /// Blocks from then to the end.
    left: u64,
    /// The first step.
    first: f64,
    /// Values of f that are known at the end of the last change of the step.
    known: usize,
    changes: u32,
}

/// The members that wait, and what all lanes have in common.
pub struct Queue<'a, const POINTS: usize, E> {
    level: Level,
    motions: &'a [InitialValueProblem<E>],
    start: DoubleDouble,
    end: DoubleDouble,
    tolerance: f64,
    /// The largest correction of a position in a step, over the position.
    correction: f64,
    /// The motions that no lane has taken yet. Those of the highest natural frequency at the start, which take
    /// the most steps, come first, so that no lane is left with a long one at the end.
    waiting: std::vec::IntoIter<usize>,
    arrivals: Vec<Result<Arrival, Failure>>,
}

impl<'a, const POINTS: usize, E: Equation> Queue<'a, POINTS, E> {
    /// Motions that are to be followed from the start to the end of the span.
    pub fn new(
        level: Level,
        motions: &'a [InitialValueProblem<E>],
        [start, end]: [DoubleDouble; 2],
        tolerance: f64,
    ) -> Queue<'a, POINTS, E> {
        let blank = Arrival {
            state: State {
                position: 0.0,
                rate: 0.0,
            },
            extremes: Extremes::at(0.0),
            progress: Progress::Whole,
        };
        let frequency = |motion: &InitialValueProblem<E>| {
            let seen = motion.equation.seen_from(&start);
            seen.natural_frequency(motion.start)
        };
        let frequencies: Vec<f64> = motions.iter().map(frequency).collect();
        let mut waiting: Vec<usize> = (0..motions.len()).collect();
        waiting.sort_by(|&one, &other| frequencies[other].total_cmp(&frequencies[one]));
        Queue {
            level,
            motions,
            start,
            end,
            tolerance,
            correction: Falkner::<POINTS>::CORRECTION * tolerance,
            waiting: waiting.into_iter(),
            arrivals: vec![Ok(blank); motions.len()],
        }
    }

    /// Follows all of them.
    pub fn follow<F: Ensemble<Equation = E>>(
        mut self,
        ensemble: &mut F,
    ) -> Vec<Result<Arrival, Failure>> {
        let mut packed = LaneStates::IDLE;
        let mut lanes: [Option<Lane>; LANES] = std::array::from_fn(|_| None);
        for (index, lane) in lanes.iter_mut().enumerate() {
            *lane = self.take_next(ensemble, &mut packed, index);
        }
        while lanes.iter().any(Option::is_some) {
            let begin = (packed.position, packed.rate);
            super::go::<POINTS, F>(self.level, ensemble, &mut packed, self.correction);
            for (index, place) in lanes.iter_mut().enumerate() {
                let Some(lane) = place else {
                    continue;
                };
                lane.passed += 1;
                // NaN is not in the range.
                if lane.passed < lane.due && (0.0..).contains(&packed.margin[index]) {
                    continue;
                }
                let state = State {
                    position: begin.0[index],
                    rate: begin.1[index],
                };
                if !self.judge(lane, ensemble, &mut packed, index, state) {
                    *place = self.take_next(ensemble, &mut packed, index);
                }
            }
        }
        self.arrivals
    }

    /// Takes the next motion that a lane can follow into a lane; those before it are followed
    /// alone.
    fn take_next<F: Ensemble<Equation = E>>(
        &mut self,
        ensemble: &mut F,
        packed: &mut LaneStates,
        index: usize,
    ) -> Option<Lane> {
        while let Some(motion) = self.waiting.next() {
            let &InitialValueProblem {
                ref equation,
                start,
                limits,
            } = &self.motions[motion];
            let mut lane = Lane {
                motion,
                time: self.start,
                passed: 0,
                due: 0,
                left: 0,
                first: 0.0,
                known: POINTS,
                changes: 0,
            };
            packed.begin_with(index, Extremes::at(start.position), limits);
            // A motion that repeats is followed no further than it does.
            let takes = F::takes(equation) && !equation.repeats();
            if takes && self.start(&mut lane, ensemble, packed, index, start) {
                return Some(lane);
            }
            self.go_alone(&lane, packed.extremes_of(index), start);
        }
        packed.set_idle(index);
        None
    }

    /// Begins equal steps from the first state. False where the motion does not suit them.
    fn start<F: Ensemble<Equation = E>>(
        &mut self,
        lane: &mut Lane,
        ensemble: &mut F,
        packed: &mut LaneStates,
        index: usize,
        state: State,
    ) -> bool {
        let &InitialValueProblem {
            ref equation,
            limits,
            ..
        } = &self.motions[lane.motion];
        let local = equation.seen_from(&self.start);
        let frequency = local.natural_frequency(state);
        // As long as the method is stable; at a tight tolerance less, by experience.
        let by_error = (self.tolerance / 1e-7).powf(1.0 / Falkner::<POINTS>::FALL);
        let free = Falkner::<POINTS>::STABLE / frequency * by_error.min(1.0);
        let free = free.min(longest_step(&local));
        let rest = self.end.since(lane.time);
        let looked_back = (POINTS - 1) as f64;
        let blocks = ((rest / free - looked_back) / BLOCK as f64).ceil();
        if !(1.0..1e15).contains(&blocks) {
            return false;
        }
        let step = rest / (looked_back + BLOCK as f64 * blocks);
        let share = (START_SHARE * self.tolerance).max(1e-14);
        let mut alone = Trajectory::new(state, limits, share)
            .with_level(self.level)
            .without_endpoint_steps()
            .recording_extremes();
        for place in 0..POINTS {
            if place > 0 && alone.advance(equation, &mut lane.time, step) != Ok(Progress::Whole) {
                lane.time = self.start;
                return false;
            }
            let local = equation.seen_from(&lane.time);
            let f = local.acceleration_from(alone.state());
            packed.f[BLOCK + HISTORY - POINTS + place][index] = step * step * f;
        }
        if let Some(extremes) = alone.extremes() {
            packed.begin_with(index, extremes, limits);
        }
        lane.first = step;
        let State { position, rate } = alone.state();
        packed.position[index] = position;
        packed.rate[index] = rate;
        self.take_steps(lane, ensemble, packed, index, step, blocks as u64);
        true
    }

    /// Gives a lane so many blocks of steps of this length from its present time on, until the end.
    fn take_steps<F: Ensemble<Equation = E>>(
        &self,
        lane: &mut Lane,
        ensemble: &mut F,
        packed: &mut LaneStates,
        index: usize,
        step: f64,
        blocks: u64,
    ) {
        packed.set_step(index, step);
        lane.left = blocks;
        lane.due = blocks.min(CALM_BLOCKS);
        let equation = &self.motions[lane.motion].equation;
        ensemble.put(index, equation, &lane.time, step);
    }

    /// Goes on in equal steps of at most `free` from a state that a lane has come to, by the `known`
    /// values of h²f, of which row `newest` has the last. False where the motion does not suit them.
    fn change<F: Ensemble<Equation = E>>(
        &mut self,
        lane: &mut Lane,
        ensemble: &mut F,
        packed: &mut LaneStates,
        index: usize,
        [newest, known]: [usize; 2],
        free: f64,
    ) -> bool {
        let rest = self.end.since(lane.time);
        let blocks = (rest / free / BLOCK as f64).ceil();
        lane.changes += 1;
        let suits = (1.0..1e15).contains(&blocks)
            && lane.changes <= MOST_CHANGES
            && free >= SHORTEST * lane.first;
        if !suits {
            return false;
        }
        let step = rest / (BLOCK as f64 * blocks);
        let ratio = step / packed.step[index];
        let (values, known) =
            history::resampled(|back| packed.f[newest - back][index], known, ratio);
        if known < POINTS {
            return false;
        }
        for (back, value) in values.into_iter().enumerate() {
            packed.f[BLOCK + HISTORY - 1 - back][index] = value;
        }
        lane.known = known;
        self.take_steps(lane, ensemble, packed, index, step, blocks as u64);
        true
    }

    /// Looks at a lane after a block, which began in `state`. False where its motion has come to its
    /// end.
    fn judge<F: Ensemble<Equation = E>>(
        &mut self,
        lane: &mut Lane,
        ensemble: &mut F,
        packed: &mut LaneStates,
        index: usize,
        state: State,
    ) -> bool {
        let step = packed.step[index];
        let after = |lane: &Lane, blocks: u64| {
            let steps = DoubleDouble::new(step).scale((BLOCK as u64 * blocks) as f64);
            lane.time.add(steps)
        };
        let stable_step = |stiffness: f64| step / stiffness.sqrt();
        let ratio = packed.correction[index];
        let stiffness = packed.stiffness[index];
        let known = if lane.passed == 1 {
            lane.known
        } else {
            HISTORY
        };
        let within = |value: f64, most: f64| (0.0..=most).contains(&value);
        // NaN is in neither range.
        let fits =
            within(ratio, 1.0) && within(stiffness, STIFFER) && packed.position[index].is_finite();
        if !fits {
            lane.time = after(lane, lane.passed - 1);
            lane.passed = 0;
            let by_error = if ratio.is_finite() {
                (0.8 * ratio.max(1.0).powf(-1.0 / Falkner::<POINTS>::FALL)).clamp(0.3, 0.8)
            } else {
                0.3
            };
            let stable = stable_step(stiffness).max(0.3 * step);
            let shorter = (by_error * step).min(0.9 * stable);
            packed.position[index] = state.position;
            packed.rate[index] = state.rate;
            let history = [HISTORY - 1, known];
            return self.change(lane, ensemble, packed, index, history, shorter)
                || self.go_alone(lane, packed.extremes_of(index), state);
        }
        let [low, high] = [packed.range[0][index], packed.range[1][index]];
        if low <= packed.limits[0][index] || high >= packed.limits[1][index] {
            lane.time = after(lane, lane.passed - 1);
            return self.go_alone(lane, packed.extremes_of(index), state);
        }
        let mut extremes = packed.extremes_of(index);
        if low < extremes.lowest || high > extremes.highest {
            for turn in turning_point::turns_beyond_extremes(packed, index, state) {
                extremes.include(turn);
            }
            extremes.include(packed.position[index]);
            packed.set_extremes(index, extremes);
        }
        if lane.passed < lane.due {
            return true;
        }
        let state = State {
            position: packed.position[index],
            rate: packed.rate[index],
        };
        lane.time = after(lane, lane.passed);
        lane.left -= lane.passed;
        lane.passed = 0;
        lane.due = lane.left.min(CALM_BLOCKS);
        if lane.left == 0 {
            self.arrivals[lane.motion] = Ok(Arrival {
                state,
                extremes,
                progress: Progress::Whole,
            });
            return false;
        }
        let [ratio, stiffness] = packed.largest_since(index);
        let stable = stable_step(stiffness);
        if ratio < IDLE_CORRECTION && 1.4 * step < stable {
            let growth = (0.85 * ratio.max(1e-30).powf(-1.0 / Falkner::<POINTS>::FALL)).min(2.0);
            let local = self.motions[lane.motion].equation.seen_from(&lane.time);
            let longer = (growth * step).min(0.95 * stable).min(longest_step(&local));
            let history = [HISTORY + BLOCK - 1, known + BLOCK];
            return self.change(lane, ensemble, packed, index, history, longer)
                || self.go_alone(lane, extremes, state);
        }
        let equation = &self.motions[lane.motion].equation;
        ensemble.see_from(index, equation, &lane.time);
        true
    }

    /// Follows the rest of a motion from `state` on alone, and notes where it came to. Returns
    /// false: the lane is free.
    fn go_alone(&mut self, lane: &Lane, mut extremes: Extremes, state: State) -> bool {
        let &InitialValueProblem {
            ref equation,
            limits,
            ..
        } = &self.motions[lane.motion];
        let mut alone = Trajectory::new(state, limits, self.tolerance)
            .with_level(self.level)
            .recording_extremes();
        let before = lane.time.since(self.start);
        let mut time = lane.time;
        let progress = alone.advance(equation, &mut time, self.end.since(lane.time));
        if let Some(more) = alone.extremes() {
            extremes.include_all(more);
        }
        self.arrivals[lane.motion] = progress.map(|progress| Arrival {
            state: alone.state(),
            extremes,
            progress: match progress {
                Progress::Whole => Progress::Whole,
                Progress::Stopped { limit, after } => Progress::Stopped {
                    limit,
                    after: before + after,
                },
            },
        });
        false
    }
}

/// The longest step in which the load is seen as it is: 2π steps to its period. In a longer one the steps may fall together
/// with the periods, and the miss of a step vanishes.
fn longest_step(local: &impl LocalEquation) -> f64 {
    1.0 / local.load_frequency()
}
