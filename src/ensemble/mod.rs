//! Many independent motions at once, one in each SIMD lane.
//!
//! Each lane takes equal steps of its own length by the method of `multistep`. What that method looks
//! back on comes from the motion followed alone, by a [`Trajectory`], at the start, and from `history`
//! where the step changes. The motion is followed alone again where a limit is near, and where it
//! does not suit a multistep method. Between, one evaluation of f serves a step of all lanes.
//!
//! [`Trajectory`]: crate::solver::trajectory::Trajectory
//!
//! Memory does not grow with the length of the motions: a few hundred bytes for each of them.

use fearless_simd::{Level, Simd, dispatch, f64x8};

use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::lanes::Lanes;
use crate::arithmetic::number::Number;
use crate::solver::extremes::Extremes;
use crate::solver::limits::Limits;
use crate::solver::trajectory::{Failure, Progress};
use crate::solver::{Equation, State};

mod history;
mod multistep;
mod queue;
mod turning_point;

use multistep::LaneStates;
use queue::Queue;

/// Motions that are followed at once.
pub const LANES: usize = 8;

/// A number for each lane.
pub type PerLane = [f64; LANES];

/// From this tolerance on the method looks back on 9 values, below on 10. By 8 it takes 0.8 to 0.9 of the time at 1e-4
/// and 1e-6, with 3 to 40 times the error. By 11 it takes 0.93 to 1 of the time where f hardly depends on x', and twice
/// the time where it does: the more values, the less is stable.
const LOOSE: f64 = 3e-10;

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

    /// h²x'' at that time, by x and hx', for steps h with the `inverse` 1/h.
    fn acceleration(&self, position: N, way: N, step: N, inverse: N) -> N;

    /// The square of the natural frequency, or more.
    fn stiffness(&self, position: N) -> N;
}

/// A motion to be followed: an equation, a start and how far it may go.
#[derive(Clone, Copy, Debug)]
pub struct InitialValueProblem<E> {
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
    motions: &[InitialValueProblem<F::Equation>],
    [start, end]: [DoubleDouble; 2],
    tolerance: f64,
) -> Vec<Result<Arrival, Failure>> {
    let span = [start, end];
    match tolerance {
        LOOSE.. => Queue::<9, _>::new(level, motions, span, tolerance).follow(ensemble),
        _ => Queue::<10, _>::new(level, motions, span, tolerance).follow(ensemble),
    }
}

/// Eight lanes gain by AVX-512 also where it is not dispatched to otherwise, since one motion does not.
fn go<const POINTS: usize, F: Ensemble>(
    level: Level,
    ensemble: &mut F,
    motions: &mut LaneStates,
    allowed: f64,
) {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = level.as_avx512() {
        return avx512.vectorize(
            #[inline(always)]
            || go_with::<POINTS, _, _>(avx512, ensemble, motions, allowed),
        );
    }
    dispatch!(level, simd => go_with::<POINTS, _, _>(simd, ensemble, motions, allowed));
}

#[inline(always)]
fn go_with<const POINTS: usize, S: Simd, F: Ensemble>(
    simd: S,
    ensemble: &mut F,
    motions: &mut LaneStates,
    allowed: f64,
) {
    motions.go_on();
    let mut packed = ensemble.pack::<S, f64x8<S>>(simd);
    motions.go::<POINTS, _, _, _>(simd, &mut packed, allowed);
    ensemble.keep(&packed);
}
