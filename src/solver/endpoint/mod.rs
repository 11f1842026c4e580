//! Long steps of which only the end is asked for.
//!
//! Between communication points that lie farther apart than a step, nothing of it is needed
//! but its end, which superconverges: 8 nodes reach order 16 there. Steps are equal as long as
//! their error allows, so that a [`Plan`] serves many of them, and share the way to the
//! communication point evenly.
//!
//! What a plan gains over steps that are solved one by one: 1.7 to 1.9 times on driven motions at 1e-6,
//! 2.5 times at 1e-9, twice at 1e-12, at equal error.

use fearless_simd::{Level, Simd, SimdBase, dispatch, f64x4};
use serde::{Deserialize, Serialize};

use super::double::Double;
use super::iteration::{Diverged, IterationTolerance, MOST_ITERATIONS};
use super::step_control::{HALVED, SHORTEST, StepControl, factor, shortened};
use super::{Equation, LocalEquation, State};

mod before;
mod matrix;
mod plan;
mod single;
mod stages;
mod table;
mod way;

use before::{Before, STEEPEST};
use plan::{NODES, Plan, largest, pair, shifted, sine_and_cosine, unpair};
pub use single::SingleSteps;
use stages::{AVERAGED, Stages, averaged, solve, stays_between};
pub use way::{End, Way};

/// The end of a step misses less than this part of the estimate below. Measured on driven motions of
/// all kinds, near escape too (`tests/stress`): the error of a whole motion stays below half a
/// tolerance times what the motion makes of it.
const NEGLECTED_WITH_PLAN: f64 = 2e4;

/// What the iteration of the stages may leave, as a multiple of what a step may miss: it adds up from
/// step to step less than that.
const LEFT: f64 = 10.0;

/// Order of the error at the end of a step.
const ORDER: f64 = 2.0 * NODES as f64;

/// Contraction above which shorter steps are cheaper.
const SLOW: f64 = 0.25;

/// Steps after which their length is looked at, and by which part it must be too long or too short
/// to be changed: a new plan costs as much as a step.
const CALM: u32 = 8;
const TOO_LONG: f64 = 0.96;
const TOO_SHORT: f64 = 1.25;

/// Steps after which the load and its phase are taken anew from the time.
const RENEWED: f64 = 16.0;

/// Steps whose sum is off by less than this part of one are those of the last plan.
const SAME: f64 = 1e-9;

/// A slope that is off by this, times the square of half the length, is replaced.
const SLOPE_OFF: f64 = 0.04;

/// Fewer steps do not pay for the matrices of a slope, unless they come again.
const FEW: f64 = 3.0;

/// A load whose period is less than this part of the time scale is left to 16 nodes, which need
/// half as many steps.
const FAST: f64 = 0.1;

const FIRST_ITERATIONS: u32 = 4;
const LEAST_ITERATIONS: u32 = 2;

/// What steps leave behind for the next ones. Plans are not stored: they follow from the rest.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct EndpointSteps {
    /// Length of the next one, where it is free.
    length: Option<f64>,
    before: Option<Before>,
    /// How often the stages are iterated before it is looked whether that was enough.
    iterations: u32,
    seen: Seen,
    /// ∂f/∂x of late, and over how many states it is averaged.
    slope: f64,
    states: f64,
    #[serde(skip)]
    plan: Plan,
}

/// The worst of the steps since the length was looked at: its error as a part of what is allowed,
/// and its contraction.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Seen {
    steps: u32,
    error: f64,
    contraction: f64,
}

impl Seen {
    const NOTHING: Seen = Seen {
        steps: 0,
        error: 0.0,
        contraction: 0.0,
    };

    /// By which factor steps may be longer.
    #[inline(always)]
    fn factor(&self) -> f64 {
        factor(self.error, ORDER).min((SLOW / self.contraction.max(1e-6)).sqrt())
    }

    /// After enough steps of this `length`, how long they should be from now on if that is another
    /// length than is `wanted`, which they have when the way allows it.
    #[inline(always)]
    fn another_length(&mut self, length: f64, wanted: f64) -> Option<f64> {
        if self.steps < CALM {
            return None;
        }
        let next = self.factor() * length;
        *self = Seen::NOTHING;
        if next < TOO_LONG * length {
            Some(next)
        } else if next > TOO_SHORT * wanted {
            Some(next.min(2.0 * length).max(wanted))
        } else {
            None
        }
    }
}

impl EndpointSteps {
    /// No step yet.
    pub const NONE: EndpointSteps = EndpointSteps {
        length: None,
        before: None,
        iterations: FIRST_ITERATIONS,
        seen: Seen::NOTHING,
        slope: 0.0,
        states: 0.0,
        plan: Plan::NONE,
    };

    /// Whether the way to go is longer than a step.
    pub fn are_shorter_than(&self, rest: f64) -> bool {
        self.length.is_none_or(|length| length < rest)
    }

    /// The equation has changed: f does not go on where it was.
    pub fn restart(&mut self) {
        self.before = None;
        self.iterations = FIRST_ITERATIONS;
        self.seen = Seen::NOTHING;
        self.states = 0.0;
    }

    /// Whether the numbers can be those of steps.
    pub fn are_valid(&self) -> bool {
        let positive = |number: f64| number > 0.0 && number.is_finite();
        let Seen {
            steps,
            error,
            contraction,
        } = self.seen;
        self.before.is_none_or(|before| before.is_valid())
            && self.length.is_none_or(positive)
            && (LEAST_ITERATIONS..=MOST_ITERATIONS).contains(&self.iterations)
            && [error, contraction].iter().all(|worst| *worst >= 0.0)
            && steps <= CALM
            && self.slope.is_finite()
            && (0.0..=AVERAGED).contains(&self.states)
    }

    /// Goes the way as far as it can.
    pub fn go<E: Equation>(
        &mut self,
        level: Level,
        equation: &E,
        control: StepControl,
        way: &mut Way,
    ) -> End {
        dispatch!(level, simd => self.go_with(simd, equation, control, way))
    }

    #[inline(always)]
    fn go_with<S: Simd, E: Equation>(
        &mut self,
        simd: S,
        equation: &E,
        control: StepControl,
        way: &mut Way,
    ) -> End {
        loop {
            if let Some(end) = self.equal_steps(simd, equation, control, way) {
                return end;
            }
        }
    }

    /// Takes equal steps toward the target, until their length should change.
    #[inline(always)]
    fn equal_steps<S: Simd, E: Equation>(
        &mut self,
        simd: S,
        equation: &E,
        control: StepControl,
        way: &mut Way,
    ) -> Option<End> {
        let mut local = equation.at(&way.time());
        let time_scale = 1.0 / local.natural_frequency(way.state);
        let rest = way.target.since(way.now);
        let wanted = *self.length.get_or_insert(time_scale);
        // Half of what 16 nodes can do: a period of the load.
        let longest = 0.5 * local.longest_substep();
        let free = wanted.min(longest);
        let count = (rest / free - 1e-9).ceil().max(1.0);
        let mut length = rest / count;
        // The host's times are rounded: steps that only differ by that share a plan.
        if let Some(before) = &self.before
            && (rest - 2.0 * before.half * count).abs() < SAME * length
        {
            length = 2.0 * before.half;
        }
        let shortest = SHORTEST * rest.min(time_scale);
        if length.is_nan() || length <= shortest || longest < FAST * time_scale {
            return Some(End::Blocked);
        }
        let half = 0.5 * length;
        let product = self.product(simd, &local, way.state, half, count);
        let [frequency, angle] = local.harmonic().unwrap_or_default();
        let alternates = frequency != 0.0;
        self.plan.prepare(simd, half, product, frequency);
        let plan = &self.plan;
        let slope = plan.slope;
        let mut phase = match alternates {
            true => sine_and_cosine(simd, angle),
            false => [0.0; 2],
        };
        let mut guess = match &self.before {
            Some(before) => before.continued(simd, plan),
            None => [f64x4::splat(simd, local.acceleration_from(way.state)); 2],
        };
        // Of the rate as of the position, in the motion's own units.
        let end_tolerance = (half / time_scale).min(1.0) * control.end_tolerance();
        let square = half * half;
        let mut state = way.state;
        let mut left = count;
        // Steps since the load was taken.
        let mut taken = 0.0;
        let mut last = None;
        let end = loop {
            if way.budget == 0 {
                break Some(End::TooMany);
            }
            way.budget -= 1;
            let scale = state.position.abs();
            let tolerance = IterationTolerance::new(LEFT * end_tolerance * scale, scale);
            let offset = plan.offset(simd, taken * length);
            let loads = if alternates {
                let sine = plan.sine(simd, phase);
                [
                    local.load_with_sine(offset[0], sine[0]),
                    local.load_with_sine(offset[1], sine[1]),
                ]
            } else {
                [local.load(offset[0]), local.load(offset[1])]
            };
            let solved = solve(
                simd,
                plan,
                &local,
                loads,
                state,
                guess,
                self.iterations,
                tolerance,
            );
            let attempt = solved.map_err(|Diverged| HALVED).and_then(|stages| {
                let Stages {
                    g, displacement, ..
                } = stages;
                let [moved, gained, sixth, seventh] = plan.end(simd, g, state.rate);
                // A Legendre series that falls geometrically reaches at degree 16, the first that
                // is integrated wrongly, the square of what it has at degree 8, by its size.
                let tail = sixth.abs() + seventh.abs();
                let swing = largest::<S>(displacement);
                let size = square * largest::<S>(g).max(slope.abs() * swing);
                let allowed = NEGLECTED_WITH_PLAN * end_tolerance * scale;
                let error = tail * tail / (size * allowed).max(f64::MIN_POSITIVE);
                if error <= 1.0 {
                    Ok((stages, [moved, gained, swing], error))
                } else {
                    Err(shortened(error, ORDER))
                }
            });
            let (stages, [moved, gained, swing], error) = match attempt {
                Ok(solved) => solved,
                Err(factor) => {
                    self.length = Some(factor * length);
                    self.seen = Seen::NOTHING;
                    self.iterations += 1;
                    break None;
                }
            };
            let Stages {
                g,
                displacement,
                change,
                last_change,
                ..
            } = stages;
            if !stays_between::<S>(way.bounds, state.position, moved, swing, displacement) {
                break Some(End::Blocked);
            }
            // One fewer next time, if that would have done.
            self.iterations = stages.iterations;
            let before_last = IterationTolerance {
                error: 0.3 * tolerance.error,
                rounding: 0.0,
            };
            if stages.iterations > LEAST_ITERATIONS
                && before_last.is_met(last_change, f64::INFINITY, [change, last_change])
            {
                self.iterations -= 1;
            }
            // A change that is nothing but rounding tells nothing of the contraction.
            if change > tolerance.rounding {
                self.seen.contraction = self.seen.contraction.max(change / last_change);
            }
            self.seen.error = self.seen.error.max(error);
            self.seen.steps += 1;
            state.position += moved;
            state.rate += gained;
            last = Some((g, displacement, moved));
            taken += 1.0;
            left -= 1.0;
            let another = self.seen.another_length(length, wanted);
            self.length = another.or(self.length);
            if left == 0.0 {
                break Some(End::Reached);
            }
            if another.is_some() {
                self.iterations += 1;
                break None;
            }
            if taken == RENEWED {
                way.now = way.now.add(Double::new(length).scale(taken));
                taken = 0.0;
                local = equation.at(&way.time());
                let positions = shifted(displacement, state.position - moved);
                (self.slope, self.states) =
                    averaged(simd, &local, state.rate, positions, self.slope, self.states);
                if let Some([_, angle]) = local.harmonic() {
                    phase = sine_and_cosine(simd, angle);
                }
            } else if alternates {
                phase = plan.turned(phase);
            }
            guess = plan.ahead(simd, g, moved);
        };
        self.iterations = self.iterations.min(MOST_ITERATIONS);
        if let Some((g, displacement, moved)) = last {
            self.before = Some(Before {
                half,
                product,
                moved,
                g: unpair(g),
                displacement: unpair(displacement),
            });
        } else if end.is_none() {
            // A guess that leads nowhere is not made again.
            self.before = None;
        }
        way.state = state;
        way.now = way.now.add(Double::new(length).scale(taken));
        if end == Some(End::Reached) {
            way.round_off(equation);
        }
        end
    }

    /// half²·J of the plan of `count` steps from here.
    #[inline(always)]
    fn product<S: Simd, L: LocalEquation>(
        &mut self,
        simd: S,
        local: &L,
        state: State,
        half: f64,
        count: f64,
    ) -> f64 {
        let of_this_length = self.before.is_some_and(|before| before.half == half);
        if self.states == 0.0 || !of_this_length {
            let positions = match &self.before {
                Some(before) => shifted(
                    pair(simd, &before.displacement),
                    state.position - before.moved,
                ),
                None => [f64x4::splat(simd, state.position); 2],
            };
            (self.slope, self.states) =
                averaged(simd, local, state.rate, positions, self.slope, self.states);
        }
        let wanted = (half * half * self.slope).clamp(-STEEPEST, 0.0);
        match self.before {
            // Matrices that are there serve another length too, with a slope that fits it.
            Some(before) if (before.product - wanted).abs() < SLOPE_OFF => before.product,
            _ if wanted > -SLOPE_OFF || !of_this_length && count < FEW => 0.0,
            _ => wanted,
        }
    }
}
