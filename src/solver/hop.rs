//! Short steps, where the host changes the equation at each communication point.
//!
//! Nothing of the step before is of use then but what f was in it, and nothing of this
//! one is kept but its end. A step that is short against the motion's own time needs no more
//! than 4 nodes, whose end is of order 8. They fit one register, so that, unlike in
//! [`super::collocation`], nothing is gained by folding them into pairs.

use fearless_simd::{Level, Simd, dispatch, f64x4};
use serde::{Deserialize, Serialize};

use super::collocation::{Closeness, product};
use super::double::Double;
use super::lanes::Lanes;
use super::number::Number;
use super::step_control::{StepControl, UNSEEN};
use super::tables::GAUSS_4;
use super::{Equation, LocalEquation, State};

/// A hop is shorter than this part of the motion's time scale.
const SHORT: f64 = 0.25;

/// Sweeps after which the iteration is given up: in a hop each shrinks the error
/// some thirtyfold at least.
const MOST_SWEEPS: u32 = 16;

/// One step from a time on.
#[derive(Clone, Copy, Debug)]
pub struct Hop<'a> {
    /// Time of the model at its begin.
    pub time: &'a Double,
    /// How long it is.
    pub length: f64,
    /// Positions between which it may go.
    pub clear: (f64, f64),
}

/// What f was in the last hop, from which it is guessed what it will be in the next one:
/// hosts mostly take equal steps, along which they change the equation smoothly.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Trend {
    /// f at the end.
    end: f64,
    /// By how much it had risen.
    rise: f64,
    /// By how much it had jumped at the begin, where the equation changed.
    jump: f64,
}

impl Trend {
    /// f in a hop of which nothing is known but its begin; nothing where it is too long.
    #[inline(never)]
    pub fn first<E: Equation>(
        equation: &E,
        time: &Double,
        state: State,
        length: f64,
    ) -> Option<Trend> {
        let local = equation.seen_from(time);
        part_of_time_scale(&local, state, length)?;
        Some(Trend::constant(local.acceleration_from(state)))
    }

    fn constant(f: f64) -> Trend {
        Trend {
            end: f,
            rise: 0.0,
            jump: 0.0,
        }
    }
}

impl Hop<'_> {
    /// Moves the state to its end and tells what f was. False where it is too long or
    /// does not stay between the clear positions; then nothing has changed.
    ///
    /// The state is changed where it lies, since the next hop waits for it: handing it on
    /// in memory takes a tenth of a sweep each time.
    pub fn take<E: Equation>(
        &self,
        level: Level,
        equation: &E,
        control: StepControl,
        state: &mut State,
        trend: &mut Trend,
    ) -> bool {
        // All of it, since what is not done in lanes takes as many instructions.
        dispatch!(level, simd => self.take_with(simd, equation, control, state, trend).is_some())
    }

    #[inline(always)]
    fn take_with<S: Simd, E: Equation>(
        &self,
        simd: S,
        equation: &E,
        control: StepControl,
        state: &mut State,
        trend: &mut Trend,
    ) -> Option<()> {
        let local = equation.at(self.time);
        let scale = state.position.abs();
        let mut part = f64::NAN;
        let closeness = || {
            part = part_of_time_scale(&local, *state, self.length)?;
            let missed = quadrature_error(&local, *state, self.length, part);
            // Of the rate as of the position, in the motion's own units.
            let bound = control.tolerance * part * scale;
            (missed <= bound.max(UNSEEN * scale)).then(|| control.closeness(scale, part))
        };
        let solved = solve(simd, &local, *state, self.length, trend, closeness)?;
        let good = solved.stays_between(self.clear, *state)
            && solved.is_within(control.settled_within(part) * scale, part);
        if !good {
            return None;
        }
        let [begin, end] = solved.f;
        *state = solved.end;
        *trend = Trend {
            end,
            rise: end - begin,
            jump: begin - trend.end,
        };
        Some(())
    }
}

/// The part of the motion's time scale that a hop is, where it is not too long.
#[inline(always)]
fn part_of_time_scale<L: LocalEquation>(local: &L, state: State, length: f64) -> Option<f64> {
    let part = length * local.natural_frequency(state);
    // Half a turn of the load, as much as 16 nodes see of it in a substep.
    let turns = length * local.load_frequency();
    (part < SHORT && turns <= std::f64::consts::PI).then_some(part)
}

/// By how much 4 nodes integrate u⁸ wrongly over −1…1, and a quarter more for what
/// comes after it.
const NEXT_DEGREE: f64 = 1.25 * 0.011_610;

/// A bound of the error that a load makes at the end of a step, of the rate times the
/// motion's time scale, because 4 nodes integrate f up to degree 7 only. The load's part of f
/// is multiplied by what the motion does to it, a power series in the part of the time scale
/// and in the part of the position that the step passes.
#[inline(always)]
fn quadrature_error<L: LocalEquation>(local: &L, state: State, length: f64, part: f64) -> f64 {
    let half = 0.5 * length;
    let Some(series) = local.load_series(state, half) else {
        return 0.0;
    };
    let passed = (half * state.rate / state.position).abs();
    let factor = 0.25 * part + 3.0 * passed;
    let eighth = series.iter().fold(0.0, |sum, term| sum * factor + term);
    NEXT_DEGREE * length * half * eighth / part
}

/// A hop that has been solved.
#[derive(Clone, Copy, Debug)]
struct Solved {
    /// The state at its end.
    end: State,
    /// f at its begin and there.
    f: [f64; 2],
    /// By how much the Legendre coefficients of f, degree by degree, can move the
    /// position: their size times the square of half the length.
    size: [f64; 4],
}

impl Solved {
    /// Whether the motion from `start` on stays between these positions: the chord does,
    /// and what a curve of this f can lie beside it.
    #[inline(always)]
    fn stays_between(&self, (lowest, highest): (f64, f64), start: State) -> bool {
        let beside = 0.5 * self.size.iter().sum::<f64>();
        let holds = |position: f64| position - beside > lowest && position + beside < highest;
        holds(start.position) & holds(self.end.position)
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

/// Solves a hop after one with this `trend`; `closeness` is how closely to solve it, if it
/// is to be solved at all. Nothing where the iteration does not converge.
#[inline(always)]
fn solve<S: Simd, L: LocalEquation>(
    simd: S,
    equation: &L,
    start: State,
    length: f64,
    trend: &Trend,
    mut closeness: impl FnMut() -> Option<Closeness>,
) -> Option<Solved> {
    let half = 0.5 * length;
    let square = half * half;
    let fill = |value: f64| <f64x4<S> as Lanes<S, 4>>::fill(simd, value);

    let place: f64x4<S> = Lanes::load(simd, &GAUSS_4.place);
    let offset = place * fill(half);
    let load = equation.load(offset);
    let line = offset.mul_add(fill(start.rate), fill(start.position));
    // Of an f that rises evenly.
    let first = trend.end + trend.jump;
    let gain = offset * place.mul_add(fill(trend.rise * 0.25), fill(first));
    let mut bent =
        (offset * offset) * place.mul_add(fill(trend.rise * (1.0 / 12.0)), fill(first * 0.5));
    let mut position = line + bent;
    let mut rate = gain + fill(start.rate);
    let mut last_change = f64::INFINITY;
    let mut wanted: Option<Closeness> = None;
    for _ in 0..MOST_SWEEPS {
        let f = equation.acceleration(load, position, rate).store();
        let twice: f64x4<S> = product(simd, &GAUSS_4.twice, &f);
        let once: f64x4<S> = product(simd, &GAUSS_4.once, &f);
        // Of what f adds, since in a short step the position would round it away.
        let new = twice * fill(square);
        let change = Lanes::<S, 4>::abs(new - bent).largest();
        bent = new;
        // Not from `bent`, for which it would have to wait.
        position = twice.mul_add(fill(square), line);
        rate = once.mul_add(fill(half), fill(start.rate));
        match wanted {
            // Only now, so that it is worked out while the first sweep is waited for.
            None => wanted = Some(closeness()?),
            Some(wanted) if wanted.is_reached(change, last_change, [change, last_change]) => {
                let series: f64x4<S> = product(simd, &GAUSS_4.series, &f);
                let added: f64x4<S> = product(simd, &GAUSS_4.end, &f);
                let scale: f64x4<S> = Lanes::load(simd, &[square, half, 1.0, 1.0]);
                let drift: f64x4<S> = Lanes::load(simd, &[length * start.rate, 0.0, 0.0, 0.0]);
                let from: f64x4<S> = Lanes::load(simd, &[start.position, start.rate, 0.0, 0.0]);
                let [position, rate, last, first] =
                    Lanes::<S, 4>::store(added.mul_add(scale, drift) + from);
                return Some(Solved {
                    end: State { position, rate },
                    f: [first, last],
                    size: Lanes::<S, 4>::abs(series * fill(square)).store(),
                });
            }
            Some(_) if change >= last_change => return None,
            Some(_) => {}
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
        type Local<'a> = Pushed;

        fn at(&self, _time: &Double) -> Pushed {
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

        fn load_frequency(&self) -> f64 {
            self.0
        }

        fn load_series(&self, _state: State, half: f64) -> Option<[f64; 5]> {
            let turn = self.0 * half;
            Some([24.0, 120.0, 720.0, 5040.0, 40320.0].map(f64::recip))
                .map(|series| std::array::from_fn(|k| series[k] * turn.powi(k as i32 + 4)))
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
            let time_scale = equation.time_scale(state);
            let part = 0.1 + 0.4 * random(4);
            let length = part * time_scale;
            let closeness = || Some(StepControl::new(1e-13).closeness(1.0, 0.1));
            let trend = Trend::constant(equation.acceleration_from(state));
            let solved = dispatch!(Level::new(), simd => {
                solve(simd, &equation, state, length, &trend, closeness)
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
