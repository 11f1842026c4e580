//! Many independent motions at once, one in each SIMD lane.
//!
//! Each lane takes equal steps of its own length by the method of `multistep`. The motion alone,
//! by a [`Trajectory`], gives what that method looks back on. It is asked again where the step has
//! to change, where a limit is near, and where the motion does not suit a multistep method.
//! Between, one evaluation of f serves a step of all lanes.
//!
//! Memory does not grow with the length of the motions: a few hundred bytes for each of them.

use fearless_simd::{Level, Simd, dispatch, f64x8};

use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::lanes::Lanes;
use crate::arithmetic::number::Number;
use crate::solver::extremes::Extremes;
use crate::solver::limits::Limits;
use crate::solver::trajectory::{Failure, Progress, Trajectory};
use crate::solver::{Equation, LocalEquation, State};

mod multistep;
mod turning_point;

use multistep::{BLOCK, LaneStates, ORDER, STABLE};

/// Motions that are followed at once.
pub const LANES: usize = 8;

/// Numbers of all lanes.
pub type Row = [f64; LANES];

/// The largest correction of a position in a step, over the tolerance and the position. What is
/// corrected is the method's error by one order less: the error that stays is far smaller.
const CORRECTION: f64 = 0.01;

/// The correction falls with the step like its power of this order.
const FALL: f64 = (ORDER + 2) as f64;

/// A correction that is this much smaller than allowed asks for longer steps.
const IDLE_CORRECTION: f64 = 1.0 / 250.0;

/// The motion alone has to be this much more accurate where it starts a multistep motion.
const START_SHARE: f64 = 0.01;

/// A motion whose steps have become this much shorter than at its start is followed alone.
const SHORTEST: f64 = 1.0 / 64.0;

/// Starts after which a motion is followed alone: each takes as long as some thirty steps.
const MOST_STARTS: u32 = 10_000;

/// The equations x'' = f(t, x, x') of all lanes, each seen from a time of its own.
pub trait Ensemble {
    /// The equation of one lane.
    type Equation: Equation;
    /// The equations with their numbers in lanes.
    type Packed<N: Number>: Packed<N>;

    /// Whether a lane can hold this equation.
    fn takes(equation: &Self::Equation) -> bool;

    /// Puts an equation into a lane, seen from `time`, to be turned on by `step`.
    fn put(&mut self, lane: usize, equation: &Self::Equation, time: &DoubleDouble, step: f64);

    /// Sees the equation of a lane from another time.
    fn see_from(&mut self, lane: usize, equation: &Self::Equation, time: &DoubleDouble);

    /// The equations in lanes.
    fn pack<S: Simd, V: Lanes<S, LANES>>(&self, simd: S) -> Self::Packed<V>;

    /// Keeps what turning on has changed.
    fn keep<S: Simd, V: Lanes<S, LANES>>(&mut self, packed: &Self::Packed<V>);
}

/// The equations of an [`Ensemble`] with their numbers in lanes.
pub trait Packed<N: Number> {
    /// Moves the time from which each is seen by its step.
    fn turn(&mut self);

    /// x'' at that time.
    fn acceleration(&self, position: N, rate: N) -> N;

    /// The square of the natural frequency, or more.
    fn stiffness(&self, position: N) -> N;
}

/// A motion to be followed.
#[derive(Clone, Copy, Debug)]
pub struct Member<E> {
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
    /// The state there.
    pub state: State,
    /// The extremes on the way.
    pub extremes: Extremes,
    /// How far it came, and the limit if it has met one.
    pub progress: Progress,
}

/// Follows all motions from `start` to `end` with the relative `tolerance` of the position, and
/// returns, in their order, where they came to.
///
/// # Errors
/// Each is a [`Failure`] where the integration cannot go on.
pub fn follow<F: Ensemble>(
    level: Level,
    ensemble: &mut F,
    motions: &[Member<F::Equation>],
    [start, end]: [DoubleDouble; 2],
    tolerance: f64,
) -> Vec<Result<Arrival, Failure>> {
    let blank = Arrival {
        state: State {
            position: 0.0,
            rate: 0.0,
        },
        extremes: Extremes::at(0.0),
        progress: Progress::Whole,
    };
    let mut queue = Queue {
        level,
        motions,
        start,
        end,
        tolerance,
        next: 0,
        arrivals: vec![Ok(blank); motions.len()],
    };
    let mut packed = LaneStates::IDLE;
    let mut lanes: [Option<Lane>; LANES] = std::array::from_fn(|_| None);
    for (index, lane) in lanes.iter_mut().enumerate() {
        *lane = queue.take_next(ensemble, &mut packed, index);
    }
    while lanes.iter().any(Option::is_some) {
        let begin = (packed.position, packed.rate);
        go(level, ensemble, &mut packed);
        for (index, place) in lanes.iter_mut().enumerate() {
            let Some(lane) = place else {
                continue;
            };
            let state = State {
                position: begin.0[index],
                rate: begin.1[index],
            };
            if !queue.judge(lane, ensemble, &mut packed, index, state) {
                *place = queue.take_next(ensemble, &mut packed, index);
            }
        }
    }
    queue.arrivals
}

/// Eight lanes gain by AVX-512 also where it is not dispatched to otherwise, since one motion does not.
fn go<F: Ensemble>(level: Level, ensemble: &mut F, motions: &mut LaneStates) {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = level.as_avx512() {
        return avx512.vectorize(
            #[inline(always)]
            || go_with(avx512, ensemble, motions),
        );
    }
    dispatch!(level, simd => go_with(simd, ensemble, motions));
}

#[inline(always)]
fn go_with<S: Simd, F: Ensemble>(simd: S, ensemble: &mut F, motions: &mut LaneStates) {
    motions.go_on();
    let mut packed = ensemble.pack::<S, f64x8<S>>(simd);
    motions.go(simd, &mut packed);
    ensemble.keep(&packed);
}

/// The motion in a lane.
#[derive(Clone, Copy, Debug)]
struct Lane {
    /// Which of the motions it is.
    motion: usize,
    /// Its time at the end of the last block.
    time: DoubleDouble,
    extremes: Extremes,
    /// The first step.
    first: f64,
    /// Blocks until the end.
    blocks: u64,
    starts: u32,
}

/// The members that wait, and what all lanes have in common.
struct Queue<'a, E> {
    level: Level,
    motions: &'a [Member<E>],
    start: DoubleDouble,
    end: DoubleDouble,
    tolerance: f64,
    /// The motion that the next free lane takes.
    next: usize,
    arrivals: Vec<Result<Arrival, Failure>>,
}

impl<E: Equation> Queue<'_, E> {
    /// Takes the next motion that a lane can follow into a lane; those before it are followed
    /// alone.
    fn take_next<F: Ensemble<Equation = E>>(
        &mut self,
        ensemble: &mut F,
        packed: &mut LaneStates,
        index: usize,
    ) -> Option<Lane> {
        while let Some(&Member {
            ref equation,
            start,
            ..
        }) = self.motions.get(self.next)
        {
            let mut lane = Lane {
                motion: self.next,
                time: self.start,
                extremes: Extremes::at(start.position),
                first: 0.0,
                blocks: 0,
                starts: 0,
            };
            self.next += 1;
            // A motion that repeats is followed no further than it does.
            if !F::takes(equation) || equation.repeats() {
                self.go_alone(&lane, start);
                continue;
            }
            let frequency = equation.seen_from(&self.start).natural_frequency(start);
            // As long as the method is stable; at a tight tolerance less, by experience.
            let free = STABLE / frequency * (self.tolerance / 1e-7).powf(1.0 / FALL).min(1.0);
            if self.start(&mut lane, ensemble, packed, index, start, free) {
                return Some(lane);
            }
        }
        packed.step[index] = 0.0;
        packed.position[index] = 1.0;
        packed.rate[index] = 0.0;
        packed.f.iter_mut().for_each(|row| row[index] = 0.0);
        None
    }

    /// Begins equal steps of at most `free` from the state that a lane has come to. False where
    /// the motion has been followed to its end alone.
    fn start<F: Ensemble<Equation = E>>(
        &mut self,
        lane: &mut Lane,
        ensemble: &mut F,
        packed: &mut LaneStates,
        index: usize,
        state: State,
        free: f64,
    ) -> bool {
        let &Member {
            ref equation,
            limits,
            ..
        } = &self.motions[lane.motion];
        let rest = self.end.since(lane.time);
        let looked_back = (ORDER - 1) as f64;
        let blocks = ((rest / free - looked_back) / BLOCK as f64).ceil();
        lane.starts += 1;
        let suits = (1.0..1e15).contains(&blocks)
            && lane.starts <= MOST_STARTS
            && free >= SHORTEST * lane.first;
        if !suits {
            return self.go_alone(lane, state);
        }
        let step = rest / (looked_back + BLOCK as f64 * blocks);
        let share = (START_SHARE * self.tolerance).max(1e-14);
        let mut alone = Trajectory::new(state, limits, share)
            .with_level(self.level)
            .without_endpoint_steps()
            .recording_extremes();
        let mut time = lane.time;
        for place in 0..ORDER {
            if place > 0 && alone.advance(equation, &mut time, step) != Ok(Progress::Whole) {
                return self.go_alone(lane, state);
            }
            let local = equation.seen_from(&time);
            packed.f[BLOCK + place][index] = local.acceleration_from(alone.state());
        }
        if let Some(Extremes { lowest, highest }) = alone.extremes() {
            lane.extremes.include(lowest);
            lane.extremes.include(highest);
        }
        if lane.starts == 1 {
            lane.first = step;
        }
        lane.blocks = blocks as u64;
        lane.time = time;
        let State { position, rate } = alone.state();
        packed.position[index] = position;
        packed.rate[index] = rate;
        packed.step[index] = step;
        ensemble.put(index, equation, &lane.time, step);
        true
    }

    /// Takes the block of a lane, which began in `state`, or starts it anew. False where its motion
    /// has come to its end.
    fn judge<F: Ensemble<Equation = E>>(
        &mut self,
        lane: &mut Lane,
        ensemble: &mut F,
        packed: &mut LaneStates,
        index: usize,
        state: State,
    ) -> bool {
        let limits = self.motions[lane.motion].limits;
        let step = packed.step[index];
        let allowed = CORRECTION * self.tolerance * state.position.abs();
        let ratio = packed.correction[index] / allowed;
        let stable = STABLE / packed.stiffness[index].sqrt();
        // NaN is in neither range.
        let fits = (0.0..=1.0).contains(&ratio) && (0.0..=1.1 * stable).contains(&step);
        if !fits {
            let by_error = if ratio.is_finite() {
                (0.8 * ratio.max(1.0).powf(-1.0 / FALL)).clamp(0.3, 0.8)
            } else {
                0.3
            };
            let shorter = (by_error * step).min(0.9 * stable.max(0.3 * step));
            return self.start(lane, ensemble, packed, index, state, shorter);
        }
        let (low, high) = (packed.lowest[index], packed.highest[index]);
        if low <= limits.lower || high >= limits.upper {
            return self.go_alone(lane, state);
        }
        let Extremes { lowest, highest } = lane.extremes;
        if low < lowest || high > highest {
            for turn in turning_point::turns(packed, index, state.rate) {
                lane.extremes.include(turn);
            }
            lane.extremes.include(packed.positions[BLOCK - 1][index]);
        }
        let state = State {
            position: packed.position[index],
            rate: packed.rate[index],
        };
        lane.blocks -= 1;
        if lane.blocks == 0 {
            self.arrivals[lane.motion] = Ok(Arrival {
                state,
                extremes: lane.extremes,
                progress: Progress::Whole,
            });
            return false;
        }
        lane.time = lane.time.plus(BLOCK as f64 * step);
        if ratio < IDLE_CORRECTION && 1.4 * step < stable {
            let growth = (0.85 * ratio.max(1e-30).powf(-1.0 / FALL)).min(2.0);
            let longer = (growth * step).min(0.95 * stable);
            return self.start(lane, ensemble, packed, index, state, longer);
        }
        ensemble.see_from(index, &self.motions[lane.motion].equation, &lane.time);
        true
    }

    /// Follows the rest of a motion from `state` on alone, and notes where it came to. Returns
    /// false: the lane is free.
    fn go_alone(&mut self, lane: &Lane, state: State) -> bool {
        let &Member {
            ref equation,
            limits,
            ..
        } = &self.motions[lane.motion];
        let mut extremes = lane.extremes;
        let mut alone = Trajectory::new(state, limits, self.tolerance)
            .with_level(self.level)
            .recording_extremes();
        let before = lane.time.since(self.start);
        let mut time = lane.time;
        let progress = alone.advance(equation, &mut time, self.end.since(lane.time));
        if let Some(Extremes { lowest, highest }) = alone.extremes() {
            extremes.include(lowest);
            extremes.include(highest);
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
