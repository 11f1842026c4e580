//! The integrator of one second-order equation x'' = f(t, x, x', z) and a few of first order,
//! z' = g(t, x, x', z), with dissipation, stiff or not.
//!
//! * [`stages`]: one step of collocation;
//! * `stage_values`: one state over the nodes of a step;
//! * `polynomials`: first-order states and integrals over a step;
//! * [`trajectory`]: steps one after another.
//!
//! Method: x is found by fixed-point iteration, as for the plain equation. What relaxes, the
//! first-order states and a damped rate, is solved by Newton's method in each iteration with x
//! held: for one state at a time that is a linear system in its slopes at the nodes. So the
//! iteration converges as that of the mechanics alone, however fast a state relaxes. Integrals
//! along the motion (energies supplied and lost) do not act back; they are summed up once the
//! stages are known. Between communication points that lie far apart, a system that is not stiff takes endpoint-only
//! steps (`solver::endpoint`).

mod newton;
mod nodes;
mod polynomials;
mod stage_values;
pub mod stages;
pub mod trajectory;

pub use trajectory::{Event, Failure, MOST_WORK, Progress, Trajectory};

use serde::{Deserialize, Serialize};

use super::State;
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::number::Number;

/// First-order states that a system may have.
pub const MOST_STATES: usize = 4;

/// Integrals along the motion that a system may have.
pub const MOST_INTEGRALS: usize = 6;

/// Position, rate, first-order states and integrals. What a system does not have is 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FullState {
    /// x, counted from the origin of the position, and x'.
    pub motion: State,
    /// z.
    pub internal: [f64; MOST_STATES],
    /// The integrals so far.
    pub integrals: [f64; MOST_INTEGRALS],
}

/// Position, rate and first-order states at one time, or at lanes of times.
#[derive(Clone, Copy, Debug)]
pub struct Stage<N = f64, const K: usize = MOST_STATES> {
    /// x, counted from the origin of the position.
    pub position: N,
    /// x'.
    pub rate: N,
    /// z.
    pub internal: [N; K],
}

impl<const K: usize> Stage<f64, K> {
    /// With this position and rate.
    pub fn of(motion: State, internal: [f64; K]) -> Self {
        Stage {
            position: motion.position,
            rate: motion.rate,
            internal,
        }
    }

    /// Position and rate.
    pub fn motion(&self) -> State {
        State {
            position: self.position,
            rate: self.rate,
        }
    }
}

/// The derivative y' of a state, and how fast the state relaxes.
#[derive(Clone, Copy, Debug)]
pub struct Slope<N = f64> {
    /// y'.
    pub value: N,
    /// −∂y'/∂y, not negative: only a part that relaxes, whatever else y' depends on.
    pub relaxation: N,
}

/// Typical sizes, to which errors are compared.
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    /// Of the position.
    pub position: f64,
    /// Of the rate.
    pub rate: f64,
    /// Of the first-order states.
    pub internal: [f64; MOST_STATES],
    /// Of the integrals, all alike.
    pub integrals: f64,
    /// How far the motion swings with the energy that it has: where integrals are summed up, that
    /// energy is to be as accurate as they are.
    pub swing: f64,
}

/// A system of one second-order equation and some of first order.
pub trait CoupledEquation {
    /// The system seen from a time.
    type Local<'a>: LocalCoupledEquation
    where
        Self: 'a;

    /// The system with the origin of time moved to `time`, that of the position to `origin`.
    fn at(&self, time: &DoubleDouble, origin: &DoubleDouble) -> Self::Local<'_>;

    /// The number of first-order states.
    fn states(&self) -> usize;

    /// The number of integrals.
    fn integrals(&self) -> usize;

    /// Whether no derivative depends on the time.
    fn is_autonomous(&self) -> bool;

    /// Whether the motion runs back the way it came: f(x, −x') = f(x, x') and no first-order
    /// state. Together with autonomy it makes a motion between two turning points repeat.
    fn is_time_reversible(&self) -> bool {
        false
    }

    /// Whether the motion between two turning points is repeated for ever, there and back, and nothing else is asked for.
    fn repeats(&self) -> bool {
        self.states() == 0
            && self.integrals() == 0
            && self.is_autonomous()
            && self.is_time_reversible()
    }

    /// Whether f and z' are smooth wherever the position is positive.
    fn is_regular(&self) -> bool {
        false
    }

    /// Whether an event besides the limits of the position is awaited.
    fn awaits_event(&self) -> bool {
        false
    }

    /// The origin from which the position is best counted at `position`, counted from the
    /// present origin: near a singularity of f, the singularity.
    fn origin_near(&self, _position: f64, present: DoubleDouble) -> DoubleDouble {
        present
    }
}

/// A [`CoupledEquation`] with its origins moved.
pub trait LocalCoupledEquation {
    /// What the derivatives need to know of the time.
    type Load<N: Number>: Copy;
    /// What they need to know of the position.
    type Geometry<N: Number>: Copy;

    /// The load at `offset` after the origin of time.
    fn load<N: Number>(&self, offset: N) -> Self::Load<N>;

    /// The part of the load that alternates: its angular frequency, and its angle at the origin
    /// of time. Nothing where there is none.
    fn harmonic(&self) -> Option<[f64; 2]>;

    /// The load at `offset`, where the sine of its alternating part is known.
    fn load_with_sine<N: Number>(&self, offset: N, sine: N) -> Self::Load<N>;

    /// What the derivatives need to know of `position`: computed once for all of them.
    fn geometry<N: Number>(&self, position: N) -> Self::Geometry<N>;

    /// z' of the k-th first-order state.
    fn slope<N: Number>(
        &self,
        k: usize,
        load: Self::Load<N>,
        geometry: &Self::Geometry<N>,
        stage: &Stage<N>,
    ) -> Slope<N>;

    /// x''.
    fn acceleration<N: Number>(
        &self,
        load: Self::Load<N>,
        geometry: &Self::Geometry<N>,
        stage: &Stage<N>,
    ) -> Slope<N>;

    /// z' of so many first-order states, and x''.
    fn derivatives(
        &self,
        states: usize,
        load: Self::Load<f64>,
        stage: &Stage,
    ) -> ([Slope; MOST_STATES], Slope) {
        let geometry = self.geometry(stage.position);
        let mut slopes = [Slope {
            value: 0.0,
            relaxation: 0.0,
        }; MOST_STATES];
        for (k, slope) in slopes.iter_mut().enumerate().take(states) {
            *slope = self.slope(k, load, &geometry, stage);
        }
        (slopes, self.acceleration(load, &geometry, stage))
    }

    /// The derivatives of the integrals at `offset`, where z' has these `slopes`.
    fn powers(
        &self,
        offset: f64,
        stage: &Stage,
        slopes: &[f64; MOST_STATES],
    ) -> [f64; MOST_INTEGRALS];

    /// Whether the equation is defined here.
    fn admits(&self, stage: &Stage) -> bool;

    /// Whether f or z' is less smooth than elsewhere at some stage between these two.
    fn bends_between(&self, _begin: &Stage, _end: &Stage) -> bool {
        false
    }

    /// The margin that vanishes where the event besides the limits happens.
    fn margin(&self, _offset: f64, _stage: &Stage) -> f64 {
        f64::INFINITY
    }

    /// The fastest angular frequency with which the load alternates, 0 where it does not.
    fn load_frequency(&self) -> f64;

    /// The longest step in whose 16 nodes the load is seen as it is, two of its periods:
    /// one that alternates faster would be mistaken for a slow one.
    fn longest_substep(&self) -> f64 {
        4.0 * std::f64::consts::PI / self.load_frequency()
    }

    /// How fast the motion from here changes by itself, without what relaxes, roughly.
    fn natural_frequency(&self, stage: &Stage) -> f64;

    /// Typical sizes around this stage.
    fn sizes(&self, stage: &Stage) -> Sizes;

    /// Those of the first-order states, where the motion has this natural frequency.
    fn state_sizes(&self, stage: &Stage, frequency: f64) -> [f64; MOST_STATES];

    /// The typical size of a position alone.
    fn size_of(&self, position: f64) -> f64;
}

impl FullState {
    /// A state with nothing but a position and a rate.
    pub fn of(motion: State) -> FullState {
        FullState {
            motion,
            internal: [0.0; MOST_STATES],
            integrals: [0.0; MOST_INTEGRALS],
        }
    }

    /// The state as a stage.
    pub fn stage(&self) -> Stage {
        Stage::of(self.motion, self.internal)
    }

    /// Whether all its numbers are finite.
    pub fn is_finite(&self) -> bool {
        let State { position, rate } = self.motion;
        let mut all = [position, rate].into_iter();
        all.all(f64::is_finite)
            && self.internal.iter().all(|z| z.is_finite())
            && self.integrals.iter().all(|sum| sum.is_finite())
    }
}
