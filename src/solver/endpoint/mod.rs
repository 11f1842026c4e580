//! Long steps of which only the end is asked for.
//!
//! Between communication points that lie farther apart than a step, nothing of it is needed
//! but its end, which superconverges: 8 nodes reach order 16 there. Steps are equal as long as
//! their error allows, so that a [`Plan`] serves many of them, and share the way to the
//! communication point evenly.
//!
//! What they gain beside steps of 16 nodes with dense output stands in the table of what is skipped
//! (docs/performance.md).

use fearless_simd::{Level, Simd, SimdBase, dispatch, f64x4};
use serde::{Deserialize, Serialize};

use super::iteration::{Diverged, IterationTolerance, MOST_ITERATIONS};
use super::step_control::{HALVED, SHORTEST, accept, first_accepted};
use super::{Equation, LocalEquation, State};
use crate::arithmetic::double_double::DoubleDouble;

mod before;
mod continuation;
mod length;
mod matrix;
mod mean_slope;
mod plan;
mod stages;
mod table;
mod way;

use before::Before;
use length::{ORDER, Seen};
use mean_slope::MeanSlope;
use plan::{Plan, largest, pair, shifted, sine_and_cosine, unpair};
use stages::{Stages, solve, stays_between};
pub use way::{End, Way};

/// The end of a step misses less than this part of the estimate below. Measured on driven motions of
/// all kinds, near escape too (`tests/stress`): the error of a whole motion stays below half a
/// tolerance times what the motion makes of it.
const NEGLECTED_WITH_PLAN: f64 = 2e4;

/// What the iteration of the stages may leave, as a multiple of what a step may miss: it adds up from
/// step to step less than that.
const LEFT: f64 = 10.0;

/// A change by less than this part of the position's rounding tells nothing of the contraction: what is
/// iterated is the displacement, whose rounding is smaller. At a tolerance of 1e-14 the larger changes
/// keep steps short enough that the energy drifts by 3e-13 in 1e6 units of time, in place of 2e-12.
const ROUNDED: f64 = 0.25;

/// Steps after which the load and its phase are taken anew from the time.
const RENEWED: f64 = 16.0;

/// Steps whose sum is off by less than this part of one are those of the last plan.
const SAME: f64 = 1e-9;

/// A slope is replaced that is off by more than this, over the square of half the length, and more than
/// this many times what it differs by from step to step: there an exact mean is of little use, and of less
/// for a length that may not come again.
const SLOPE_OFF: f64 = 0.04;
const SPREADS_OFF: f64 = 1.0;
const SPREADS_OFF_ONCE: f64 = 2.0;

/// A step with dense output takes as much time as so many that have an end only, without a restart.
const TIME_OF_DENSE: f64 = 3.0;

/// How many times as long it is where that is not known, and at least: one that was taken long ago tells little.
/// Measured: 0.8 at a tolerance of 1e-4, 1.2 at 1e-9, 2.3 at 1e-12, 3 to 5 at 1e-14.
const LENGTH_OF_DENSE: f64 = 2.0;
const LEAST_LENGTH_OF_DENSE: f64 = 0.75;

/// Fewer steps do not pay for the matrices of a slope, unless they come again.
const FEW: f64 = 3.0;

/// A load whose period is less than this part of the time scale is left to 16 nodes, which need
/// half as many steps.
const FAST: f64 = 0.1;

/// The slope of a plan is bounded so that its matrices are well conditioned.
const STEEPEST: f64 = 8.0;

const FIRST_ITERATIONS: u32 = 4;
const LEAST_ITERATIONS: u32 = 2;

/// What steps leave behind for the next ones. Plans are not stored: they follow from the rest.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EndpointSteps {
    /// Length of the next one, where it is free.
    length: Option<f64>,
    /// Half the length of the last one and half²·J of its plan, 0 where there was none.
    half: f64,
    product: f64,
    before: Option<Before>,
    /// The equation has changed since the last one: f jumps at its end.
    restarted: bool,
    /// How often the stages are iterated before it is looked whether that was enough.
    iterations: u32,
    seen: Seen,
    slope: MeanSlope,
    #[serde(skip)]
    plan: Option<Box<Plan>>,
}

/// The longest step under this load, half of what 16 nodes can do: a period.
#[inline(always)]
fn longest<L: LocalEquation>(local: &L) -> f64 {
    0.5 * local.longest_substep()
}

impl EndpointSteps {
    /// No step yet.
    pub fn none() -> EndpointSteps {
        EndpointSteps {
            length: None,
            half: 0.0,
            product: 0.0,
            before: None,
            restarted: false,
            iterations: FIRST_ITERATIONS,
            seen: Seen::BEGIN,
            slope: MeanSlope::UNKNOWN,
            plan: Some(Box::default()),
        }
    }

    /// Whether ways of this length take less time than with dense output, one step of which serves as many as
    /// fit into it: the next one would be this long, as far as is known.
    pub fn are_faster(&self, rest: f64, dense: Option<f64>) -> bool {
        self.length.is_none_or(|length| {
            let dense = dense.unwrap_or(LENGTH_OF_DENSE * length);
            dense.max(LEAST_LENGTH_OF_DENSE * length) < TIME_OF_DENSE * rest.min(length)
        })
    }

    /// Whether so many of them, as far as is known, reach so far.
    pub fn reach(&self, rest: f64, steps: f64) -> bool {
        self.length.is_none_or(|length| rest <= steps * length)
    }

    /// Whether so many as long as the last one, which the load may have bounded, reach so far.
    #[inline]
    pub fn surely_reach(&self, rest: f64, steps: f64) -> bool {
        let last = 2.0 * self.half;
        self.length
            .is_some_and(|length| rest <= steps * length.min(last))
    }

    /// The equation has changed: f does not go on where it was.
    #[inline]
    pub fn restart(&mut self) {
        self.restarted = true;
    }

    /// Whether the numbers can be those of steps.
    pub fn are_valid(&self) -> bool {
        let positive = |number: f64| number > 0.0 && number.is_finite();
        self.before
            .is_none_or(|before| before.is_valid() && self.half > 0.0)
            && (0.0..f64::INFINITY).contains(&self.half)
            && (-STEEPEST..=0.0).contains(&self.product)
            && self.length.is_none_or(positive)
            && (LEAST_ITERATIONS..=MOST_ITERATIONS).contains(&self.iterations)
            && self.seen.is_valid()
            && self.slope.is_valid()
    }

    /// Goes the way as far as it can.
    #[inline(never)]
    pub fn go<E: Equation>(&mut self, level: Level, equation: &E, way: &mut Way) -> End {
        dispatch!(level, simd => self.go_with(simd, equation, way))
    }

    #[inline(always)]
    fn go_with<S: Simd, E: Equation>(&mut self, simd: S, equation: &E, way: &mut Way) -> End {
        loop {
            let mut local = equation.at(&way.time());
            let time_scale = 1.0 / local.natural_frequency(way.state);
            let first = || length::first(time_scale, way.control);
            let wanted = *self.length.get_or_insert_with(first);
            if longest(&local) < FAST * time_scale {
                return End::Blocked;
            }
            let shortest = SHORTEST * way.rest().min(time_scale);
            let steps = first_accepted(
                wanted,
                shortest,
                #[inline(always)]
                |length| self.equal_steps(simd, equation, way, &mut local, time_scale, length),
            );
            match steps {
                Ok(None) => {}
                Ok(Some(end)) => return end,
                Err(_) => return End::Blocked,
            }
        }
    }

    /// Takes equal steps toward the target, no longer than `length`, until their length should change.
    ///
    /// # Errors
    /// By which factor to shorten them, where the first one is refused.
    #[inline(always)]
    fn equal_steps<'a, S: Simd, E: Equation>(
        &mut self,
        simd: S,
        equation: &'a E,
        way: &mut Way,
        local: &mut E::Local<'a>,
        time_scale: f64,
        length: &mut f64,
    ) -> Result<Option<End>, f64> {
        let (wanted, rest) = (*length, way.rest());
        let free = wanted.min(longest(local));
        let count = (rest / free - 1e-9).ceil().max(1.0);
        *length = rest / count;
        // The host's times are rounded: steps that only differ by that share a plan.
        if (rest - 2.0 * self.half * count).abs() < SAME * *length {
            *length = 2.0 * self.half;
        }
        let length = *length;
        let half = 0.5 * length;
        let square = half * half;
        let [frequency, angle] = local.harmonic().unwrap_or_default();
        let alternates = frequency != 0.0;
        let mut phase = match alternates {
            true => sine_and_cosine(simd, angle),
            false => [0.0; 2],
        };
        let splat = |value: f64| f64x4::splat(simd, value);
        let load = local.load_with_sine(splat(0.0), splat(phase[0]));
        let last_product = self.product;
        let product = if square < SLOPE_OFF * time_scale * time_scale {
            0.0
        } else {
            self.product(simd, local, phase[0], way.state, half, count)
        };
        // Made anew after a state was restored.
        let plan = self.plan.get_or_insert_default();
        plan.prepare(simd, half, product, frequency);
        let plan = &**plan;
        let slope = plan.slope;
        let first = match &self.before {
            Some(_) if !self.restarted => splat(0.0),
            _ => {
                let State { position, rate } = way.state;
                local.acceleration(load, splat(position), splat(rate))
            }
        };
        let mut guess = match &self.before {
            Some(before) if !self.restarted || half == self.half => {
                let [low, high] = before.continued(simd, plan, self.half, last_product);
                // Where f jumps, it goes on from there as it did.
                let jump = if self.restarted {
                    first - splat(before.acceleration)
                } else {
                    first
                };
                [low + jump, high + jump]
            }
            _ => [first; 2],
        };
        self.restarted = false;
        // Of the rate as of the position, in the motion's own units.
        let end_tolerance = (half / time_scale).min(1.0) * way.control.end_tolerance();
        let mut state = way.state;
        let mut left = count;
        // Steps since the load was taken.
        let mut taken = 0.0;
        let mut last = None;
        let end = loop {
            if way.budget == 0 {
                break Ok(Some(End::TooMany));
            }
            way.budget -= 1;
            let scale = state.position.abs();
            let tolerance = IterationTolerance::new(LEFT * end_tolerance * scale, scale);
            let offset = plan.offset(simd, taken * length);
            let sine = match alternates {
                true => plan.sine(simd, phase),
                false => [splat(0.0); 2],
            };
            let loads = [
                local.load_with_sine(offset[0], sine[0]),
                local.load_with_sine(offset[1], sine[1]),
            ];
            let solved = solve(
                simd,
                plan,
                local,
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
                let parts = [largest::<S>(g), slope.abs() * swing].map(|part| square * part);
                let size = parts[0].max(parts[1]);
                let allowed = NEGLECTED_WITH_PLAN * end_tolerance * scale;
                let error = tail * tail / (size * allowed).max(f64::MIN_POSITIVE);
                accept(error, ORDER)?;
                Ok((stages, [moved, gained, swing, parts[0] + parts[1]], error))
            });
            let (stages, [moved, gained, swing, bend], error) = match attempt {
                Ok(solved) => solved,
                Err(factor) => {
                    self.length = Some(factor * length);
                    self.seen = Seen::NOTHING;
                    self.iterations += 1;
                    break Err(factor);
                }
            };
            let Stages {
                g,
                displacement,
                change,
                last_change,
                ..
            } = stages;
            if !stays_between::<S>(way.bounds, state.position, moved, swing, bend, displacement) {
                break Ok(Some(End::Blocked));
            }
            // One fewer next time, or two, if that would have done: an iteration moves the end by what
            // the one before has left.
            let enough = |change: f64| u32::from(change <= tolerance.error);
            let fewer = enough(change) + enough(last_change);
            self.iterations = (stages.iterations - fewer).max(LEAST_ITERATIONS);
            if change > ROUNDED * tolerance.rounding {
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
                break Ok(Some(End::Reached));
            }
            // Unless as many steps are left of the new length as of this one.
            if another.is_some_and(|next| (left * length / next - 1e-9).ceil() != left) {
                self.iterations += 1;
                break Ok(None);
            }
            if taken == RENEWED {
                way.now = way.now.add(DoubleDouble::times(length, taken));
                taken = 0.0;
                *local = equation.at(&way.time());
                if let Some([_, angle]) = local.harmonic() {
                    phase = sine_and_cosine(simd, angle);
                }
                let positions = unpair(shifted(displacement, state.position - moved));
                self.slope
                    .include(simd.level(), local, phase[0], state.rate, &positions);
            } else if alternates {
                phase = plan.turned(phase);
            }
            guess = plan.ahead(simd, g, moved);
        };
        self.iterations = self.iterations.min(MOST_ITERATIONS);
        way.now = way.now.add(DoubleDouble::times(length, taken));
        let Some((g, displacement, moved)) = last else {
            if end.is_err() {
                // A guess that leads nowhere is not made again.
                self.before = None;
            }
            return end;
        };
        let acceleration = plan.last(simd, g) + slope * moved;
        if end == Ok(Some(End::Reached)) {
            // What rounding has left of the way.
            let rest = way.rest();
            state.position += rest * state.rate;
            state.rate += rest * acceleration;
            way.now = way.target;
        }
        (self.half, self.product) = (half, product);
        self.before = Some(Before {
            moved,
            acceleration,
            g: unpair(g),
            displacement: unpair(displacement),
        });
        way.state = state;
        // Those before one that is refused are taken.
        Ok(end.unwrap_or(None))
    }

    /// half²·J of the plan of `count` steps from here.
    #[inline(always)]
    fn product<S: Simd, L: LocalEquation>(
        &mut self,
        simd: S,
        local: &L,
        sine: f64,
        state: State,
        half: f64,
        count: f64,
    ) -> f64 {
        let of_this_length = self.half == half;
        // Where every step restarts, it is renewed when their length is looked at.
        let due = self.restarted && self.seen.steps == 0;
        if self.slope.is_vague() || self.before.is_none() || !of_this_length || due {
            let positions = match &self.before {
                Some(before) => shifted(
                    pair(simd, &before.displacement),
                    state.position - before.moved,
                ),
                None => [f64x4::splat(simd, state.position); 2],
            };
            self.slope
                .include(simd.level(), local, sine, state.rate, &unpair(positions));
        }
        let wanted = (half * half * self.slope.value).clamp(-STEEPEST, 0.0);
        let spreads = if of_this_length {
            SPREADS_OFF
        } else {
            SPREADS_OFF_ONCE
        };
        let near_enough = SLOPE_OFF + spreads * half * half * self.slope.spread;
        if (self.product - wanted).abs() < near_enough {
            // Matrices that are there serve another length too, with a slope that fits it.
            self.product
        } else if wanted > -SLOPE_OFF || !of_this_length && count < FEW {
            0.0
        } else {
            wanted
        }
    }
}
