//! Short steps, where the host changes the equation at each communication point.
//!
//! Nothing of the step before is of use then but what f was in it, and nothing of this
//! one is kept but its end. A step that is short against the motion's own time needs no more
//! than 4 nodes, whose end is of order 8. They fit one register, so that, unlike in
//! [`super::collocation`], nothing is gained by folding them into pairs.
//!
//! Gain over an endpoint-only step of 8 nodes: two thirds of the time (58 ns beside 189, the voltage set at each step, AVX2).

use fearless_simd::{Level, Simd, dispatch, f64x4};
use serde::{Deserialize, Serialize};

use super::collocation::product;
use super::step_control::{StepControl, UNSEEN};
use super::tables::{ENDS_4, GAUSS_4};
use super::{Equation, LocalEquation, Sensitivity, State};
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::lanes::Lanes;
use crate::arithmetic::number::Number;

/// A short step is shorter than this part of the motion's time scale.
const SHORT: f64 = 0.25;

/// What a single iteration may leave in a time scale, as a part of the tolerance for what
/// is repeated: seen only after 1e4 time scales in which it always has the same sign.
const LEFT_BY_ONE: f64 = 0.1;

/// By how much 4 nodes integrate u⁸ wrongly over −1…1, and a quarter more for what
/// comes after it.
const NEXT_DEGREE: f64 = 1.25 * 0.011_610;

/// One step from a time on.
#[derive(Clone, Copy, Debug)]
pub struct ShortStep<'a> {
    /// Time of the model at its begin.
    pub time: &'a DoubleDouble,
    /// How long it is.
    pub length: f64,
    /// Positions between which it may go.
    pub bounds: (f64, f64),
}

/// What f was in the last short step, from which it is guessed what it will be in the next
/// one: hosts mostly take equal steps, along which they change the equation smoothly.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Trend {
    /// f at the end.
    end: f64,
    /// By how much it had risen.
    rise: f64,
    /// Both parts of the load at the end.
    load: [f64; 2],
    /// The sine of what alternates in it there.
    sine: f64,
    /// ∂f/∂load at the begin.
    response: [f64; 2],
}

impl Trend {
    /// f in a step of which nothing is known but its begin; nothing where it is too long.
    #[inline(never)]
    pub fn first<E: Equation>(
        equation: &E,
        time: &DoubleDouble,
        state: State,
        length: f64,
    ) -> Option<Trend> {
        let local = equation.seen_from(time);
        part_of_time_scale(&local, state, length)?;
        Some(Trend::at_rest(&local, state))
    }

    fn at_rest<L: LocalEquation>(local: &L, state: State) -> Trend {
        Trend {
            end: local.acceleration_from(state),
            rise: 0.0,
            load: L::parts(local.load(0.0)),
            sine: local.harmonic().map_or(0.0, |[_, angle]| angle.sin()),
            response: local.sensitivity(state).load,
        }
    }
}

impl ShortStep<'_> {
    /// Moves the state to its end and tells what f was. False where it is too long or
    /// does not stay between the bounds; then nothing has changed.
    ///
    /// The state is changed where it lies, since the next step waits for it: handing it on
    /// in memory takes a tenth of an iteration each time.
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
        let solved = solve(simd, &local, control, *state, self.length, trend)?;
        let scale = state.position.abs();
        let part = solved.part;
        let missed = quadrature_error(&local, solved.response, *state, self.length, part);
        let good = solved.stays_between(self.bounds, *state)
            && solved.is_within(control.end_tolerance_within(part) * scale)
            && missed <= (control.tolerance * part).max(UNSEEN) * scale;
        if !good {
            return None;
        }
        *state = solved.end;
        *trend = Trend {
            end: solved.f[1],
            rise: solved.f[1] - solved.f[0],
            load: solved.load,
            sine: solved.sine,
            response: solved.response,
        };
        Some(())
    }
}

/// The part of the motion's time scale that a step is, where it is not too long.
#[inline(always)]
fn part_of_time_scale<L: LocalEquation>(local: &L, state: State, length: f64) -> Option<f64> {
    let part = length * local.natural_frequency(state);
    // Half a turn of the load, as much as 16 nodes see of it in a substep.
    let turns = length * local.load_frequency();
    (part < SHORT && turns <= std::f64::consts::PI).then_some(part)
}

/// A bound of the error that a load makes at the end of a step, of the rate times the
/// motion's time scale, because 4 nodes integrate f up to degree 7 only. The load's part of f
/// is multiplied by what the motion does to it, a power series in the part of the time scale
/// and in the part of the position that the step passes.
#[inline(always)]
fn quadrature_error<L: LocalEquation>(
    local: &L,
    [one, other]: [f64; 2],
    state: State,
    length: f64,
    part: f64,
) -> f64 {
    let half = 0.5 * length;
    let Some([first, second]) = local.load_series(half) else {
        return 0.0;
    };
    let passed = (half * state.rate / state.position).abs();
    let factor = 0.25 * part + 3.0 * passed;
    let terms = first.iter().zip(&second);
    let eighth = terms.fold(0.0, |sum, (a, b)| sum * factor + (one * a + other * b));
    NEXT_DEGREE * length * half * eighth / part
}

/// A short step that has been solved.
#[derive(Clone, Copy, Debug)]
struct Solved {
    /// The state at its end.
    end: State,
    /// f at its begin and there.
    f: [f64; 2],
    /// Both parts of the load at its end, and the sine of what alternates in it.
    load: [f64; 2],
    sine: f64,
    /// ∂f/∂load at its begin.
    response: [f64; 2],
    /// By how much the Legendre coefficients of f, degree by degree, can move the
    /// position: their size times the square of half the length.
    size: [f64; 4],
    /// The part of the time scale that it is.
    part: f64,
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

    /// Whether the error at the end is at most `bound`, but for that of
    /// [`quadrature_error`]. The first degree that is missed, 4, falls from the size of the
    /// series as the square of degree 2 or the power 4/3 of degree 3, here 3/2; and it acts on
    /// the end by what degree 4 is in the motion's response to f.
    ///
    /// Written without quotients and roots, for which all else would have to wait.
    #[inline(always)]
    fn is_within(&self, bound: f64) -> bool {
        let [zeroth, first, second, third] = self.size;
        let size = zeroth + first;
        let square = 0.25 * self.part * self.part;
        let response = square * square;
        let by_second = response * (second * second);
        let by_third = (response * response) * (third * third * third);
        by_second <= bound * size && by_third <= (bound * bound) * size
    }
}

/// Solves a step after one with this `trend`. Nothing where it is too long or the iteration
/// does not converge.
#[inline(always)]
fn solve<S: Simd, L: LocalEquation>(
    simd: S,
    local: &L,
    control: StepControl,
    start: State,
    length: f64,
    trend: &Trend,
) -> Option<Solved> {
    let half = 0.5 * length;
    let square = half * half;
    let fill = |value: f64| <f64x4<S> as Lanes<S, 4>>::fill(simd, value);

    let place: f64x4<S> = Lanes::load(simd, &GAUSS_4.place);
    let offset = place * fill(half);
    let sine = match local.harmonic() {
        Some([frequency, angle]) => offset.mul_add(fill(frequency), fill(angle)).sin(),
        None => fill(0.0),
    };
    let load = local.load_with_sine(offset, sine);
    let line = offset.mul_add(fill(start.rate), fill(start.position));
    // Of an f that jumps as the load does and then rises evenly.
    // By the sine at the end of the last step, since that of this one is waited for.
    let load_at_begin = L::parts(local.load_with_sine(0.0, trend.sine));
    let [one, other] = [0, 1].map(|k| load_at_begin[k] - trend.load[k]);
    let first = trend.end + (one * trend.response[0] + other * trend.response[1]);
    let gain = offset * place.mul_add(fill(trend.rise * 0.25), fill(first));
    let mut bent =
        (offset * offset) * place.mul_add(fill(trend.rise * (1.0 / 12.0)), fill(first * 0.5));
    let mut position = line + bent;
    let mut rate = gain + fill(start.rate);

    let mut f = local.acceleration(load, position, rate).store();
    let mut twice: f64x4<S> = product(simd, &GAUSS_4.twice, &f);
    // Of what f adds, since in a short step the position would round it away.
    let mut new = twice * fill(square);
    let mut change = Lanes::<S, 4>::abs(new - bent).largest();

    // Only now, so that it is worked out while the first iteration is waited for.
    let scale = start.position.abs();
    let part = part_of_time_scale(local, start, length)?;
    let Sensitivity {
        load: response,
        rate: damping,
    } = local.sensitivity(start);
    // What is left of an error of the guess is known beforehand.
    let contraction = part * part + damping * length;
    if change * contraction > LEFT_BY_ONE * control.tolerance * scale * (part * part) {
        let tolerance = control.iteration_tolerance(scale, part);
        let mut iterations = 1;
        loop {
            iterations += 1;
            let once: f64x4<S> = product(simd, &GAUSS_4.once, &f);
            bent = new;
            // Not from `bent`, for which it would have to wait.
            position = twice.mul_add(fill(square), line);
            rate = once.mul_add(fill(half), fill(start.rate));
            f = local.acceleration(load, position, rate).store();
            twice = product(simd, &GAUSS_4.twice, &f);
            new = twice * fill(square);
            let last_change = change;
            change = Lanes::<S, 4>::abs(new - bent).largest();
            let rate = [change, last_change];
            let converged = tolerance.has_converged(iterations, change, last_change, rate);
            if converged.ok()? {
                break;
            }
        }
    }
    // From the nodes, since another sine takes as long as half an iteration.
    let sine = if local.load_frequency() == 0.0 {
        0.0
    } else {
        let ends: f64x4<S> = product(simd, &ENDS_4, &sine.store());
        let [_, _, end, _] = Lanes::<S, 4>::store(ends);
        end
    };
    let series: f64x4<S> = product(simd, &GAUSS_4.series, &f);
    let added: f64x4<S> = product(simd, &ENDS_4, &f);
    let weight: f64x4<S> = Lanes::load(simd, &[square, half, 1.0, 1.0]);
    let drift: f64x4<S> = Lanes::load(simd, &[length * start.rate, 0.0, 0.0, 0.0]);
    let from: f64x4<S> = Lanes::load(simd, &[start.position, start.rate, 0.0, 0.0]);
    let [position, rate, last, first] = Lanes::<S, 4>::store(added.mul_add(weight, drift) + from);
    Some(Solved {
        end: State { position, rate },
        f: [first, last],
        load: L::parts(local.load_with_sine(length, sine)),
        sine,
        response,
        size: Lanes::<S, 4>::abs(series * fill(square)).store(),
        part,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arithmetic::number::Number;
    use crate::solver::limits::Limits;
    use crate::solver::trajectory::Trajectory;

    /// x'' = sin(ωt) − x + x⁻⁵ − x'²/x: stiff on one side, and the rate enters.
    #[derive(Clone, Copy)]
    struct Pushed(f64);

    impl Equation for Pushed {
        type Local<'a> = Pushed;

        fn at(&self, _time: &DoubleDouble) -> Pushed {
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

        fn load_series(&self, half: f64) -> Option<[[f64; 5]; 2]> {
            let turn = self.0 * half;
            let factorial = [24.0, 120.0, 720.0, 5040.0, 40320.0];
            let series = std::array::from_fn(|k| turn.powi(k as i32 + 4) / factorial[k]);
            Some([series, [0.0; 5]])
        }

        fn parts<N: Number>(load: N) -> [N; 2] {
            [load, load.same(0.0)]
        }

        fn sensitivity(&self, state: State) -> Sensitivity {
            Sensitivity {
                load: [1.0, 0.0],
                rate: 2.0 * (state.rate / state.position).abs(),
            }
        }

        fn natural_frequency(&self, state: State) -> f64 {
            (1.0 + 5.0 * state.position.powi(-6)).sqrt()
        }
    }

    /// Against substeps of 16 nodes, on steps long enough for an error to be seen.
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
            let length = (0.15 + 0.1 * random(4)) * time_scale;
            let trend = Trend::at_rest(&equation, state);
            let control = StepControl::new(1e-13);
            let solved = dispatch!(Level::new(), simd => {
                solve(simd, &equation, control, state, length, &trend)
            });
            let Some(solved) = solved else {
                continue;
            };
            let limits = Limits {
                lower: 1e-3,
                upper: 1e3,
            };
            let exact = Trajectory::new(state, limits, 1e-14);
            let mut exact = exact.without_endpoint_steps();
            let followed = exact.advance(&equation, &mut DoubleDouble::new(0.0), length);
            followed.expect("it can be followed");
            let position = solved.end.position - exact.position();
            let rate = (solved.end.rate - exact.rate()) * time_scale;
            let off = position.abs().max(rate.abs());
            // Ten tolerances of the reference are nothing beside it.
            if off > 1e-12 {
                seen += 1;
                assert!(
                    !solved.is_within(off / 1.1),
                    "{off} in {length} from {state:?}"
                );
            }
        }
        assert!(seen > 400, "{seen}");
    }
}
