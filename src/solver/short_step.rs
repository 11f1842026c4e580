//! Short steps, where the host changes the equation at each communication point.
//!
//! Nothing of the step before is of use then but what f was in it, and nothing of this
//! one is kept but its end. A step that is short against the motion's own time needs no more
//! than 4 nodes, whose end is of order 8. They fit one register, so that, unlike in
//! [`super::collocation`], nothing is gained by folding them into pairs.
//!
//! Gain over an endpoint-only step of 8 nodes: two thirds of the time. With the voltage set at each step and the
//! stretch read, a step of 0.01 takes 44 ns, one of 1, which is too long for 4 nodes, 135 (packed FMU, tolerance 1e-6,
//! AVX2, AMD EPYC family 25).

use fearless_simd::{Level, Simd, dispatch, f64x4};
use serde::{Deserialize, Serialize};

use super::rotation::Rotation;
use super::step_control::{StepControl, UNSEEN};
use super::tables::product::product_in_lanes;
use super::tables::{ENDS_4, GAUSS_4};
use super::{Equation, LocalEquation, State};
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::lanes::Lanes;
use crate::arithmetic::number::Number;

/// A short step is shorter than this part of the motion's time scale.
const SHORT: f64 = 0.25;

/// By how much 4 nodes integrate u⁸ wrongly over −1…1, and a quarter more for what
/// comes after it.
const NEXT_DEGREE: f64 = 1.25 * 0.011_610;

/// One step from a time on.
#[derive(Debug)]
pub struct ShortStep<'a> {
    /// Time of the model at its begin.
    pub time: &'a DoubleDouble,
    /// How long it is.
    pub length: f64,
    /// Positions between which it may go.
    pub bounds: (f64, f64),
    /// What it may miss.
    pub control: StepControl,
    /// The state, at its begin and then at its end. It is changed where it lies, since the next
    /// step waits for it: handing it on in memory takes a tenth of an iteration each time.
    pub state: &'a mut State,
    /// What f was in the last step, and then in this one.
    pub trend: &'a mut Trend,
}

/// What the last short step leaves for the next one: hosts mostly take equal steps, along which they change the
/// equation smoothly.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Trend {
    course: Course,
    rotation: Rotation,
}

/// What f was in a step, from which it is guessed what it will be in the next one.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Course {
    /// f at the end without what both parts of the load add to it.
    unloaded: f64,
    /// Its slope there times the length of the step.
    slope: f64,
    /// ∂f/∂load of both parts at the begin.
    response: [f64; 2],
    /// The sine of what alternates in the load at the end.
    sine: f64,
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
        let stiffness = local.sensitivity(state).position;
        is_short(&local, length, stiffness).then(|| Trend::at_rest(&local, state))
    }

    fn at_rest<L: LocalEquation>(local: &L, state: State) -> Trend {
        let [one, other] = L::parts(local.load(0.0));
        let response = local.sensitivity(state).load;
        let course = Course {
            unloaded: local.acceleration_from(state) - (one * response[0] + other * response[1]),
            slope: 0.0,
            response,
            sine: local.harmonic().map_or(0.0, |[_, angle]| angle.sin()),
        };
        Trend {
            course,
            rotation: Rotation::UNKNOWN,
        }
    }

    /// Whether the numbers can be those of a motion.
    pub fn is_valid(&self) -> bool {
        self.rotation.is_valid()
    }
}

impl ShortStep<'_> {
    /// Moves the state to its end and tells what f was. False where it is too long or
    /// does not stay between the bounds; then the state has not changed.
    pub fn take<E: Equation>(&mut self, level: Level, equation: &E) -> bool {
        // All of it, since what is not done in lanes takes as many instructions.
        dispatch!(level, simd => self.take_with(simd, equation).is_some())
    }

    #[inline(always)]
    fn take_with<S: Simd, E: Equation>(&mut self, simd: S, equation: &E) -> Option<()> {
        let local = equation.at(self.time);
        let (start, control) = (*self.state, self.control);
        let solved = solve(simd, &local, control, start, self.length, self.trend)?;
        let (part, scale) = (solved.part, start.position.abs());
        let response = solved.course.response;
        let allowed = (control.tolerance * part).max(UNSEEN) * scale;
        let good = solved.stays_between(self.bounds, start)
            && solved.is_within(control.end_tolerance_within(part) * scale)
            && load_is_integrated(&local, response, start, self.length, part, allowed);
        if !good {
            return None;
        }
        *self.state = solved.end;
        self.trend.course = solved.course;
        Some(())
    }
}

/// Whether a step is short against the motion's time scale where ∂f/∂x is this, and the load turns no
/// more than half a turn in it, as much as 16 nodes see of it in a substep.
#[inline(always)]
fn is_short<L: LocalEquation>(local: &L, length: f64, stiffness: f64) -> bool {
    let turns = length * local.load_frequency();
    stiffness * (length * length) < SHORT * SHORT && turns <= std::f64::consts::PI
}

/// A short step that has been solved.
#[derive(Clone, Copy, Debug)]
struct Solved {
    /// The state at its end.
    end: State,
    /// What f was.
    course: Course,
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
        let [zeroth, first, second, third] = self.size;
        let beside = 0.5 * ((zeroth + first) + (second + third));
        let (one, other) = (start.position, self.end.position);
        let [low, high] = if one < other {
            [one, other]
        } else {
            [other, one]
        };
        low - beside > lowest && high + beside < highest
    }

    /// Whether the error at the end is at most `bound`, but for what [`load_is_integrated`]
    /// judges. The first degree that is missed, 4, falls from the size of the series as the square
    /// of degree 2 or the power 4/3 of degree 3, here 3/2; and it acts on the end by what degree 4
    /// is in the motion's response to f.
    ///
    /// Written without quotients and roots, for which all else would have to wait.
    #[inline(always)]
    fn is_within(&self, bound: f64) -> bool {
        let [zeroth, first, second, third] = self.size;
        let size = zeroth + first;
        let square = 0.25 * self.part * self.part;
        let response = square * square;
        let allowed = bound * size;
        let by_third = response * third;
        response * (second * second) <= allowed && by_third * by_third * third <= bound * allowed
    }
}

/// Whether the error that a load makes at the end of a step, because 4 nodes integrate f up to degree 7
/// only, is at most `allowed`: that of the rate times the motion's time scale. The load's part of f
/// is multiplied by what the motion does to it, a power series in the part of the time scale
/// and in the part of the position that the step passes.
#[inline(always)]
fn load_is_integrated<L: LocalEquation>(
    local: &L,
    [by_one, by_other]: [f64; 2],
    state: State,
    length: f64,
    part: f64,
    allowed: f64,
) -> bool {
    let half = 0.5 * length;
    let passed = (half * state.rate / state.position).abs();
    match local.eighth_degree(half, 0.25 * part + 3.0 * passed) {
        Some([one, other]) => {
            let missed = NEXT_DEGREE * length * half * (one * by_one + other * by_other);
            missed <= allowed * part
        }
        None => true,
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
    trend: &mut Trend,
) -> Option<Solved> {
    let half = 0.5 * length;
    let square = half * half;
    let fill = |value: f64| <f64x4<S> as Lanes<S, 4>>::fill(simd, value);

    let place: f64x4<S> = Lanes::load(simd, &GAUSS_4.place);
    let offset = place * fill(half);
    let (sine, end_sine) = match local.harmonic() {
        Some(harmonic) => trend.rotation.sines(simd, harmonic, length),
        None => (fill(0.0), Some(0.0)),
    };
    let course = &trend.course;
    let load = local.load_with_sine(offset, sine);
    let line = offset.mul_add(fill(start.rate), fill(start.position));
    // Of an f that jumps as the load does and then rises evenly.
    // By the sine at the end of the last step, since that of this one is waited for.
    let [one, other] = L::parts(local.load_with_sine(0.0, course.sine));
    let first = course.unloaded + (one * course.response[0] + other * course.response[1]);
    let slope = course.slope;
    let gain = offset * place.mul_add(fill(slope * 0.25), fill(first));
    // Halved where nothing waits for it.
    let half_square = offset * offset * fill(0.5);
    let mut bent = half_square * place.mul_add(fill(slope * (1.0 / 6.0)), fill(first));
    let mut position = line + bent;
    let mut rate = gain + fill(start.rate);

    let mut f = local.acceleration(load, position, rate).store();
    let mut twice: f64x4<S> = product_in_lanes(simd, &GAUSS_4.twice, &f);
    // Of what f adds, since in a short step the position would round it away.
    let mut new = twice * fill(square);
    let mut change = Lanes::<S, 4>::abs(new - bent).largest();

    // Only now, so that it is worked out while the first iteration is waited for.
    let scale = start.position.abs();
    let sensitivity = local.sensitivity(start);
    if !is_short(local, length, sensitivity.position) {
        return None;
    }
    let square_part = sensitivity.position * (length * length);
    let part = square_part.sqrt();
    // What iterations leave of the change of the first one is known beforehand. In a time scale it may
    // be as large as what is repeated may miss: seen only after 1e3 time scales in which it always
    // has the same sign.
    let contraction = square_part + sensitivity.rate * length;
    let allowed = control.tolerance * scale * square_part;
    let mut left = change * contraction;
    if left > allowed {
        let tolerance = control.iteration_tolerance(scale, part);
        let mut iterations = 1;
        loop {
            iterations += 1;
            let once: f64x4<S> = product_in_lanes(simd, &GAUSS_4.once, &f);
            // Not from `bent`, for which it would have to wait.
            position = twice.mul_add(fill(square), line);
            rate = once.mul_add(fill(half), fill(start.rate));
            f = local.acceleration(load, position, rate).store();
            left *= contraction;
            if left <= allowed {
                break;
            }
            bent = new;
            twice = product_in_lanes(simd, &GAUSS_4.twice, &f);
            new = twice * fill(square);
            let last_change = change;
            change = Lanes::<S, 4>::abs(new - bent).largest();
            left = change * contraction;
            let rate = [change, last_change];
            let converged = tolerance.has_converged(iterations, change, last_change, rate);
            if converged.ok()? {
                break;
            }
        }
    }
    let sine = end_sine.unwrap_or_else(|| {
        // From the nodes, since another sine takes as long as half an iteration.
        let ends: f64x4<S> = product_in_lanes(simd, &ENDS_4, &sine.store());
        let [_, _, end, _] = Lanes::<S, 4>::store(ends);
        end
    });
    let series: f64x4<S> = product_in_lanes(simd, &GAUSS_4.series, &f);
    let added: f64x4<S> = product_in_lanes(simd, &ENDS_4, &f);
    let weight: f64x4<S> = Lanes::load(simd, &[square, half, 1.0, 1.0]);
    let drift: f64x4<S> = Lanes::load(simd, &[length * start.rate, 0.0, 0.0, 0.0]);
    let from: f64x4<S> = Lanes::load(simd, &[start.position, start.rate, 0.0, 0.0]);
    let [position, rate, _, _] = Lanes::<S, 4>::store(added.mul_add(weight, drift) + from);
    // The next step waits for these longer than for the state.
    let [_, _, last, slope] = Lanes::<S, 4>::store(added);
    let [one, other] = L::parts(local.load_with_sine(length, sine));
    let response = sensitivity.load;
    Some(Solved {
        end: State { position, rate },
        // Stored one by one and loaded so: numbers that were stored one by one could not be loaded
        // together before they are in the cache.
        course: Course {
            unloaded: last - (one * response[0] + other * response[1]),
            slope,
            response,
            sine,
        },
        size: Lanes::<S, 4>::abs(series * fill(square)).store(),
        part,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arithmetic::number::Number;
    use crate::solver::Sensitivity;
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

        fn eighth_degree(&self, half: f64, factor: f64) -> Option<[f64; 2]> {
            let turn = self.0 * half;
            let factorial = [24.0, 120.0, 720.0, 5040.0, 40320.0];
            let terms = (0..5).map(|k| turn.powi(k as i32 + 4) / factorial[k]);
            Some([terms.fold(0.0, |sum, term| sum * factor + term), 0.0])
        }

        fn parts<N: Number>(load: N) -> [N; 2] {
            [load, load.same(0.0)]
        }

        fn sensitivity(&self, state: State) -> Sensitivity {
            Sensitivity {
                position: 1.0 + 5.0 * state.position.powi(-6),
                load: [1.0, 0.0],
                rate: 2.0 * (state.rate / state.position).abs(),
            }
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
            let mut trend = Trend::at_rest(&equation, state);
            let control = StepControl::new(1e-13);
            let solved = dispatch!(Level::new(), simd => {
                solve(simd, &equation, control, state, length, &mut trend)
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
