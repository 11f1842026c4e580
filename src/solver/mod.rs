//! The integrator of x'' = f(t, x, x'). It knows no actuator and no FMI.
//!
//! * [`trajectory`]: a motion of this equation; [`coupled`]: one with first-order states and
//!   dissipation;
//! * [`integrator`]: what the first two have in common: the steps that are kept, events, the
//!   loop over steps; [`position_origin`]: where positions are counted from;
//! * [`collocation`]: one step of Gauss collocation with dense output;
//! * `endpoint`: steps of which only the end is asked for, of both kinds of motion;
//! * `short_step`: short steps of 4 nodes, where the equation changes at each of them; `rotation`: the sines of an
//!   alternating load in them;
//! * [`step_control`]: how long the next step may be; [`iteration`]: when its stages are solved;
//! * [`dense_output`]: the polynomials that steps leave behind;
//! * [`limits`], [`orbit`], [`extremes`]: where a motion stops, repeats, has swung to;
//! * [`linearized`]: the motion beside a motion; `tables`: nodes and weights of all methods;

pub mod collocation;
pub mod coupled;
pub mod dense_output;
mod endpoint;
pub mod extremes;
pub mod integrator;
pub mod iteration;
pub mod limits;
pub mod linearized;
pub mod orbit;
mod outcome;
pub mod position_origin;
mod rotation;
mod short_step;
pub mod step_control;
mod tables;
pub mod trajectory;

use serde::{Deserialize, Serialize};

use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::number::Number;

/// Position x and rate x' of the motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// x.
    pub position: f64,
    /// x'.
    pub rate: f64,
}

impl State {
    /// The state at the end of a step from here, `half` of whose length is given, where f has this mean; the `tilt` is
    /// a third of its first Legendre coefficient.
    #[inline(always)]
    pub fn after(self, half: f64, [mean, tilt]: [f64; 2]) -> State {
        let length = 2.0 * half;
        let bend = length * half * (mean - tilt);
        State {
            position: self.position + (length * self.rate + bend),
            rate: self.rate + length * mean,
        }
    }
}

/// An equation of motion x'' = f(t, x, x').
pub trait Equation {
    /// The equation seen from a time, with what depends on that time only
    /// worked out.
    type Local<'a>: LocalEquation
    where
        Self: 'a;

    /// The equation with the origin of time moved to `time`.
    fn at(&self, time: &DoubleDouble) -> Self::Local<'_>;

    /// [`Equation::at`] as a call, not inlined: for code in which size counts more than speed.
    #[inline(never)]
    fn seen_from(&self, time: &DoubleDouble) -> Self::Local<'_> {
        self.at(time)
    }

    /// Whether f does not depend on t.
    fn is_autonomous(&self) -> bool;

    /// Whether the motion run backwards in time is a motion too: f is conservative and even
    /// in x', f(x, x') = f(x, −x'). Damping is neither.
    fn is_time_reversible(&self) -> bool {
        false
    }

    /// Whether the motion between two turning points is repeated for ever, there and back.
    fn repeats(&self) -> bool {
        self.is_autonomous() && self.is_time_reversible()
    }
}

/// How f changes in a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensitivity {
    /// |∂f/∂x|, roughly: the absolute values of its terms added up, since their sum may vanish.
    pub position: f64,
    /// ∂f/∂load of the two parts of the load.
    pub load: [f64; 2],
    /// |∂f/∂x'|.
    pub rate: f64,
}

/// An [`Equation`] with its origin of time moved to the begin of a substep.
pub trait LocalEquation {
    /// What f needs to know of the time, at one time or at lanes of times.
    type Load<N: Number>: Copy;

    /// The load at `offset` after the origin of time.
    fn load<N: Number>(&self, offset: N) -> Self::Load<N>;

    /// The part of the load that alternates: its angular frequency, and its angle at the origin
    /// of time. Nothing where there is none.
    #[inline(always)]
    fn harmonic(&self) -> Option<[f64; 2]> {
        None
    }

    /// The load at `offset`, where the sine of its alternating part is known.
    #[inline(always)]
    fn load_with_sine<N: Number>(&self, offset: N, _sine: N) -> Self::Load<N> {
        self.load(offset)
    }

    /// x'' under this load.
    fn acceleration<N: Number>(&self, load: Self::Load<N>, position: N, rate: N) -> N;

    /// x'' + `addend`, for which a last multiplication may have room.
    #[inline(always)]
    fn acceleration_and<N: Number>(
        &self,
        load: Self::Load<N>,
        position: N,
        rate: N,
        addend: N,
    ) -> N {
        self.acceleration(load, position, rate) + addend
    }

    /// The fastest angular frequency with which the load alternates, 0 where it does not.
    fn load_frequency(&self) -> f64;

    /// The longest substep in whose 16 nodes the load is seen as it is, two of its periods:
    /// one that alternates faster would be mistaken for a slow one.
    #[inline(always)]
    fn longest_substep(&self) -> f64 {
        4.0 * std::f64::consts::PI / self.load_frequency()
    }

    /// How much each of the two parts of the load adds to the coefficient of u⁸ of f, at most,
    /// over a step of `half` to either side of its middle, which begins at the origin: u is −1 at
    /// the begin and 1 at the end. A load of degree 4 or higher is multiplied by a power series
    /// whose coefficients fall by `factor` from degree to degree. Nothing where both parts are of
    /// a lower degree.
    fn eighth_degree(&self, half: f64, factor: f64) -> Option<[f64; 2]>;

    /// The two parts of a load; the second one is 0 where there is but one.
    fn parts<N: Number>(load: Self::Load<N>) -> [N; 2];

    /// How f changes in a state.
    fn sensitivity(&self, state: State) -> Sensitivity;

    /// How fast the motion from here changes by itself: √|∂f/∂x|, roughly.
    #[inline(always)]
    fn natural_frequency(&self, state: State) -> f64 {
        self.sensitivity(state).position.sqrt()
    }

    /// The time scale of the motion from here, the inverse of that; in a function of its own,
    /// where a few nanoseconds count less than its size.
    #[inline(never)]
    fn time_scale(&self, state: State) -> f64 {
        1.0 / self.natural_frequency(state)
    }

    /// x'' in a state at the origin of time.
    #[inline(always)]
    fn acceleration_from(&self, state: State) -> f64 {
        self.acceleration(self.load(0.0), state.position, state.rate)
    }
}
