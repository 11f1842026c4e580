//! Short steps, where the host changes the equation at each communication point.
//!
//! Nothing of the step before is of use then, and nothing of this one is kept but
//! its end. A step that is short against the motion's own time needs no more
//! than 4 nodes, whose end is of order 8.

use fearless_simd::Level;

use super::collocation::{Guess, Series, Substep, Task, solve_by_4};
use super::double::Double;
use super::step_control::StepControl;
use super::{Equation, LocalEquation, State};

/// Node pairs.
const PAIRS: usize = 2;

/// A hop is shorter than this part of the motion's time scale.
const SHORT: f64 = 0.25;

/// One step from a state at a time.
#[derive(Clone, Copy, Debug)]
pub struct Hop {
    /// Time of the model at its begin.
    pub time: Double,
    /// State there.
    pub state: State,
    /// About what f is at its begin, such as what it was before the equation changed.
    pub f: Option<f64>,
    /// How long it is.
    pub length: f64,
    /// Positions between which it may go.
    pub clear: (f64, f64),
}

impl Hop {
    /// The state and f at its end; nothing where it is too long or does not stay between
    /// the clear positions.
    pub fn end<E: Equation>(
        &self,
        level: Level,
        equation: &E,
        control: StepControl,
    ) -> Option<(State, f64)> {
        let local = equation.at(self.time);
        let part = self.length / local.time_scale(self.state);
        // 4 nodes see the load as it is over a quarter of what 16 do.
        if part.is_nan() || part >= SHORT || 4.0 * self.length > local.longest_substep() {
            return None;
        }
        let scale = self.state.position.abs();
        let f = match self.f {
            Some(f) => f,
            None => local.acceleration_from(self.state),
        };
        let task = Task {
            start: self.state,
            length: self.length,
            closeness: control.closeness(scale, part),
            guess: Guess::Begin(f),
            contraction: 1.0,
        };
        let substep = solve_by_4(level, &local, &task).ok()?;
        let reach = substep.reach();
        let (lowest, highest) = self.clear;
        let good = *reach.start() > lowest
            && *reach.end() < highest
            && error(&substep, part) <= control.settled_within(part) * scale;
        good.then(|| (substep.end, last_f(&substep)))
    }
}

/// f at the end: each Legendre polynomial is 1 there.
#[inline(always)]
fn last_f(substep: &Substep<PAIRS>) -> f64 {
    let Series { half, even, odd } = &substep.series;
    (even.iter().sum::<f64>() + odd.iter().sum::<f64>()) / (half * half)
}

/// Estimate of the error at the end, in a hop that is this `part` of the time
/// scale. The first degree that is missed, 4, falls from the size of the series as
/// the square of degree 2 or the power 4/3 of degree 3, here 3/2; and it acts on
/// the end by what degree 4 is in the motion's response to f.
#[inline(always)]
fn error(substep: &Substep<PAIRS>, part: f64) -> f64 {
    let Series { even, odd, .. } = &substep.series;
    let size = (even[0].abs() + odd[0].abs()).max(f64::MIN_POSITIVE);
    let inverse = 1.0 / size;
    let (second, third) = (even[1].abs() * inverse, odd[1].abs() * inverse);
    let missed = (second * second).max(third * third.sqrt());
    let half = 0.5 * part;
    size * missed * (half * half) * (half * half)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::limits::Limits;
    use crate::solver::number::Number;
    use crate::solver::trajectory::Trajectory;

    /// x'' = sin(ωt) − x + x⁻⁵ − x'²/x: stiff on one side, and the rate enters.
    #[derive(Clone, Copy)]
    struct Pushed(f64);

    impl Equation for Pushed {
        type Local = Pushed;

        fn at(&self, _time: Double) -> Pushed {
            *self
        }

        fn is_autonomous(&self) -> bool {
            false
        }
    }

    impl LocalEquation for Pushed {
        type Load<N: Number> = N;

        #[inline(always)]
        fn load<N: Number>(&self, offset: N) -> N {
            (offset * offset.same(self.0)).sin()
        }

        #[inline(always)]
        fn acceleration<N: Number>(&self, load: N, x: N, rate: N) -> N {
            let inverse = x.same(1.0) / x;
            let square = inverse * inverse;
            load - x + square * square * inverse - rate * rate * inverse
        }

        fn longest_substep(&self) -> f64 {
            f64::INFINITY
        }

        fn time_scale(&self, state: State) -> f64 {
            (1.0 + 5.0 * state.position.powi(-6)).sqrt().recip()
        }
    }

    /// Against substeps of 16 nodes, on hops long enough for an error to be seen.
    #[test]
    fn the_error_is_not_underestimated() {
        let mut seen = 0;
        for k in 0..4000 {
            let random = |m: u32| f64::from((k * 7919 + m * 104_729) % 1009) / 1009.0;
            let equation = Pushed(0.1 + random(1));
            let state = State {
                position: 0.7 + random(2),
                rate: random(3) - 0.5,
            };
            let time_scale = equation.time_scale(state);
            let part = 0.1 + 0.4 * random(4);
            let length = part * time_scale;
            let task = Task {
                start: state,
                length,
                closeness: StepControl::new(1e-13).closeness(1.0, 0.1),
                guess: Guess::Begin(equation.acceleration_from(state)),
                contraction: 1.0,
            };
            let solved = solve_by_4(Level::new(), &equation, &task);
            let substep = solved.expect("it converges");
            let limits = Limits {
                lower: 1e-3,
                upper: 1e3,
            };
            let exact = Trajectory::new(state, Double::ZERO, limits, 1e-14);
            let mut exact = exact.without_strides();
            let followed = exact.advance(&equation, length);
            followed.expect("it can be followed");
            let position = substep.end.position - exact.position();
            let rate = (substep.end.rate - exact.rate()) * time_scale;
            let off = position.abs().max(rate.abs());
            if off > 1e-13 {
                seen += 1;
                assert!(
                    off < 1.1 * error(&substep, part),
                    "{off} in {length} from {state:?}"
                );
            }
        }
        assert!(seen > 1000, "{seen}");
    }
}
