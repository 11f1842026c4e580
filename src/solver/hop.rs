//! Short steps, where the host changes the equation at each communication point.
//!
//! Nothing of the step before is of use then, and nothing of this one is kept but
//! its end. A step that is short against the motion's own time needs no more
//! than 4 nodes, whose end is of order 8. They fit one register, so that, unlike in
//! [`super::collocation`], nothing is gained by folding them into pairs.

use std::ops::RangeInclusive;

use fearless_simd::{Level, Simd, dispatch, f64x4};

use super::collocation::{Closeness, product};
use super::double::Double;
use super::lanes::Lanes;
use super::number::Number;
use super::step_control::StepControl;
use super::tables::GAUSS_4;
use super::{Equation, LocalEquation, State};

/// A hop is shorter than this part of the motion's time scale.
const SHORT: f64 = 0.25;

/// P_0 moves the position at the end by as much as P_1 times this, the other way.
const THIRD: f64 = 1.0 / 3.0;

/// Sweeps after which the iteration is given up: in a hop each shrinks the error
/// some thirtyfold at least.
const MOST_SWEEPS: u32 = 16;

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
        let part = self.length * local.natural_frequency(self.state);
        // 4 nodes see the load as it is over a quarter of what 16 do.
        if part.is_nan() || part >= SHORT || 4.0 * self.length > local.longest_substep() {
            return None;
        }
        let scale = self.state.position.abs();
        let f = match self.f {
            Some(f) => f,
            None => local.acceleration_from(self.state),
        };
        let closeness = control.closeness(scale, part);
        // Here, since a state that is handed over in two registers would be put down in two
        // stores and read in one load, which waits for both: a quarter of the time of a hop.
        let solved = dispatch!(level, simd => {
            solve(simd, &local, self.state, self.length, f, closeness)
        })?;
        let reach = solved.reach(self.state);
        let (lowest, highest) = self.clear;
        let good = *reach.start() > lowest
            && *reach.end() < highest
            && solved.is_within(control.settled_within(part) * scale, part);
        good.then_some((solved.end, solved.last_f))
    }
}

/// A hop that has been solved.
#[derive(Clone, Copy, Debug)]
struct Solved {
    /// The state at its end.
    end: State,
    /// f there.
    last_f: f64,
    /// By how much the Legendre coefficients of f, degree by degree, can move the
    /// position: their size times the square of half the length.
    size: [f64; 4],
}

impl Solved {
    /// A range that holds the motion from `start` on: the chord, and what a curve of
    /// this f can lie beside it.
    #[inline(always)]
    fn reach(&self, start: State) -> RangeInclusive<f64> {
        let (from, to) = (start.position, self.end.position);
        let beside = 0.5 * self.size.iter().sum::<f64>();
        from.min(to) - beside..=from.max(to) + beside
    }

    /// Whether the error at the end of a hop that is this `part` of the time scale is at
    /// most `bound`. The first degree that is missed, 4, falls from the size of the series
    /// as the square of degree 2 or the power 4/3 of degree 3, here 3/2; and it acts on
    /// the end by what degree 4 is in the motion's response to f.
    ///
    /// Written without quotients and roots, for which all else would have to wait.
    #[inline(always)]
    fn is_within(&self, bound: f64, part: f64) -> bool {
        let [zeroth, first, second, third] = self.size;
        let size = zeroth + first;
        let response = (0.25 * part * part) * (0.25 * part * part);
        let by_second = response * (second * second);
        let by_third = (response * response) * (third * third * third);
        by_second <= bound * size && by_third <= (bound * bound) * size
    }
}

/// Solves a hop; `f` is what it is about at the begin. Nothing where the iteration
/// does not converge.
#[inline(always)]
fn solve<S: Simd, L: LocalEquation>(
    simd: S,
    equation: &L,
    start: State,
    length: f64,
    f: f64,
    closeness: Closeness,
) -> Option<Solved> {
    let half = 0.5 * length;
    let square = half * half;
    let fill = |value: f64| <f64x4<S> as Lanes<S, 4>>::fill(simd, value);

    let place: f64x4<S> = Lanes::load(simd, &GAUSS_4.place);
    let load = equation.load(place * fill(half));
    let line = place.mul_add(fill(half * start.rate), fill(start.position));
    let mut bent = place * place * fill(0.5 * square * f);
    let mut gain = place * fill(half * f);
    let mut last_change = f64::NAN;
    for _ in 0..MOST_SWEEPS {
        let f = equation
            .acceleration(load, line + bent, fill(start.rate) + gain)
            .store();
        let twice: f64x4<S> = product(simd, &GAUSS_4.twice, &f);
        let once: f64x4<S> = product(simd, &GAUSS_4.once, &f);
        // Of what f adds, since in a short step the position would round it away.
        let new = twice * fill(square);
        let change = Lanes::<S, 4>::abs(new - bent).largest();
        bent = new;
        gain = once * fill(half);
        if closeness.is_reached(change, last_change, [change, last_change]) {
            let series: f64x4<S> = product(simd, &GAUSS_4.series, &f);
            let size = Lanes::<S, 4>::abs(series * fill(square)).store();
            let series = series.store();
            let end = State {
                position: start.position
                    + (length * start.rate + 2.0 * square * (series[0] - series[1] * THIRD)),
                rate: start.rate + length * series[0],
            };
            return Some(Solved {
                end,
                // Each Legendre polynomial is 1 there.
                last_f: (series[0] + series[1]) + (series[2] + series[3]),
                size,
            });
        }
        if change >= last_change {
            return None;
        }
        last_change = change;
    }
    None
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

        fn natural_frequency(&self, state: State) -> f64 {
            (1.0 + 5.0 * state.position.powi(-6)).sqrt()
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
            let time_scale = 1.0 / equation.natural_frequency(state);
            let part = 0.1 + 0.4 * random(4);
            let length = part * time_scale;
            let closeness = StepControl::new(1e-13).closeness(1.0, 0.1);
            let f = equation.acceleration_from(state);
            let solved = dispatch!(Level::new(), simd => {
                solve(simd, &equation, state, length, f, closeness)
            });
            let solved = solved.expect("it converges");
            let limits = Limits {
                lower: 1e-3,
                upper: 1e3,
            };
            let exact = Trajectory::new(state, Double::ZERO, limits, 1e-14);
            let mut exact = exact.without_strides();
            let followed = exact.advance(&equation, length);
            followed.expect("it can be followed");
            let position = solved.end.position - exact.position();
            let rate = (solved.end.rate - exact.rate()) * time_scale;
            let off = position.abs().max(rate.abs());
            if off > 1e-13 {
                seen += 1;
                assert!(
                    !solved.is_within(off / 1.1, part),
                    "{off} in {length} from {state:?}"
                );
            }
        }
        assert!(seen > 1000, "{seen}");
    }
}
