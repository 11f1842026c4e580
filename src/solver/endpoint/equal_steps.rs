//! Equal steps, one after another, until their length should change.

use fearless_simd::{Simd, SimdBase, f64x4};

use super::before::{LastPlan, LastStep};
use super::length::{ORDER, Seen};
use super::plan::{pair, shifted, sine_and_cosine, unpair};
use super::stages::{Course, Guess, solve};
use super::system::{LocalSystem, System, in_lanes};
use super::way::{End, Way};
use super::{EndpointSteps, LEAST_ITERATIONS, STEEPEST, longest};
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::lanes::Lanes;
use crate::solver::coupled::Stage;
use crate::solver::iteration::{Diverged, IterationTolerance, MOST_ITERATIONS};
use crate::solver::step_control::{HALVED, accept};

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

/// Fewer steps do not pay for the matrices of a slope, unless they come again.
const FEW: f64 = 3.0;

/// The rate of a state, times half the step, is taken anew where it is off by more than this and this part of it.
const RATE_OFF: f64 = 0.04;
const PART_OFF: f64 = 0.1;

/// A state that relaxes faster than this, in units of the motion's time scale, is left to Radau nodes, and so is a rate
/// that is damped so strongly (a damping ratio of 0.8).
const FAST_STATE: f64 = 4.0;
const STRONG_DAMPING: f64 = 1.6;

impl<const K: usize> EndpointSteps<K> {
    /// Takes equal steps toward the target, no longer than `length`, until their length should change.
    ///
    /// # Errors
    /// By which factor to shorten them, where the first one is refused.
    #[inline(always)]
    pub(super) fn equal_steps<'a, S: Simd, E: System<K>>(
        &mut self,
        simd: S,
        equation: &'a E,
        way: &mut Way<K>,
        local: &mut E::Local<'a>,
        time_scale: f64,
        length: &mut f64,
    ) -> Result<Option<End>, f64> {
        let (wanted, rest) = (*length, way.rest());
        let free = wanted.min(longest(local));
        let count = (rest / free - 1e-9).ceil().max(1.0);
        *length = rest / count;
        // The host's times are rounded: steps that only differ by that share a plan.
        let last_length = 2.0 * self.last_plan.half;
        if (rest - last_length * count).abs() < SAME * *length {
            *length = last_length;
        }
        let length = *length;
        let half = 0.5 * length;
        let square = half * half;
        let harmonic = local.harmonic();
        let mut phase = match harmonic {
            Some([_, angle]) => sine_and_cosine(simd, angle),
            None => [0.0; 2],
        };
        // A frequency of 0 holds the phase, and with it a part of the voltage.
        let frequency = harmonic.map_or(0.0, |[frequency, _]| frequency);
        let alternates = frequency != 0.0;
        let splat = |value: f64| f64x4::splat(simd, value);
        let load = local.load_with_sine(splat(0.0), splat(phase[0]));
        let here = in_lanes(simd, &way.state);
        let geometry = local.geometry(here.position);
        let states = local.states();
        let (mut relaxations, mut first_slopes) = (self.last_plan.relaxations, [0.0; K]);
        for k in 0..K {
            if k < states {
                let slope = local.slope(k, load, &geometry, &here);
                let rate = Lanes::<S, 4>::store(slope.relaxation)[0];
                first_slopes[k] = Lanes::<S, 4>::store(slope.value)[0];
                if time_scale * rate > FAST_STATE {
                    return Ok(Some(End::Blocked));
                }
                let relaxation = half * rate;
                if (relaxation - relaxations[k]).abs() > RATE_OFF + PART_OFF * relaxation {
                    relaxations[k] = relaxation;
                }
            }
        }
        if K > 0 && time_scale * local.damping(&way.state) > STRONG_DAMPING {
            return Ok(Some(End::Blocked));
        }
        let last_plan = self.last_plan;
        let product = if square < SLOPE_OFF * time_scale * time_scale {
            0.0
        } else {
            self.product(simd, local, phase[0], &way.state, half, count)
        };
        let sizes = local.sizes(&way.state, 1.0 / time_scale);
        // Made anew after a state was restored.
        let plans = self.plans.get_or_insert_default();
        plans.motion.prepare(simd, half, product, frequency);
        for k in 0..K {
            if k < states {
                plans.internal[k].prepare(simd, half, relaxations[k]);
            }
        }
        let plans = &**plans;
        let plan = &plans.motion;
        let first = match &self.before {
            Some(_) if !self.restarted => splat(0.0),
            _ => local.acceleration(load, &geometry, &here),
        };
        let mut guess = match &self.before {
            Some(before) if !self.restarted || half == last_plan.half => {
                let jump = self.restarted.then_some((first, first_slopes));
                before.guess(simd, plans, states, &last_plan, jump)
            }
            _ => {
                let mut guess = Guess {
                    motion: [first; 2],
                    internal: [[splat(0.0); 2]; K],
                };
                for k in 0..K {
                    guess.internal[k] = [splat(first_slopes[k]); 2];
                }
                guess
            }
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
            let mut weights = [0.0; K];
            for k in 0..K {
                if k < states {
                    weights[k] = length * scale / sizes[k];
                }
            }
            let offset = plan.offset(simd, taken * length);
            let sine = match alternates {
                true => plan.sine(simd, phase),
                false => [splat(phase[0]); 2],
            };
            let loads = [
                local.load_with_sine(offset[0], sine[0]),
                local.load_with_sine(offset[1], sine[1]),
            ];
            let solved = solve(
                simd,
                plans,
                local,
                loads,
                state,
                guess,
                weights,
                self.iterations,
                tolerance,
            );
            let attempt = solved.map_err(|Diverged| HALVED).and_then(|stages| {
                let ends = stages.ends(simd, plans, states, state.rate);
                let error = ends.error(end_tolerance, scale, &sizes);
                accept(error, ORDER)?;
                Ok((stages, ends, error))
            });
            let (stages, ends, error) = match attempt {
                Ok(solved) => solved,
                Err(factor) => {
                    self.length = Some(factor * length);
                    self.seen = Seen::NOTHING;
                    self.iterations += 1;
                    break Err(factor);
                }
            };
            let (change, last_change) = (stages.change, stages.last_change);
            let Course { g, displacement } = stages.motion;
            let next = ends.after(&state);
            if !ends.stays_between(way.bounds, state.position, displacement) || !local.admits(&next)
            {
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
            state = next;
            last = Some((stages, ends));
            taken += 1.0;
            left -= 1.0;
            let another = self.seen.another_length(length, wanted, count == 1.0);
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
                let positions = unpair(shifted(displacement, state.position - ends.moved));
                self.slope
                    .include(simd.level(), local, phase[0], &state, &positions);
            } else if alternates {
                phase = plan.turned(phase);
            }
            guess.motion = plan.ahead(simd, g, plan.slope * ends.moved);
            for k in 0..K {
                if k < states {
                    let shift = -plans.internal[k].rate * ends.internal[k].moved;
                    guess.internal[k] = plan.ahead(simd, stages.internal[k].g, shift);
                }
            }
        };
        self.iterations = self.iterations.min(MOST_ITERATIONS);
        way.now = way.now.add(DoubleDouble::times(length, taken));
        let Some((stages, ends)) = last else {
            if end.is_err() {
                // A guess that leads nowhere is not made again.
                self.before = None;
            }
            return end;
        };
        let before = LastStep::of(simd, plans, states, &stages, &ends);
        if end == Ok(Some(End::Reached)) {
            // What rounding has left of the way.
            let rest = way.rest();
            state.position += rest * state.rate;
            state.rate += rest * before.motion.derivative;
            for k in 0..K {
                state.internal[k] += rest * before.internal[k].derivative;
            }
            way.now = way.target;
        }
        self.last_plan = LastPlan {
            half,
            product,
            relaxations,
        };
        self.before = Some(before);
        way.state = state;
        // Those before one that is refused are taken.
        Ok(end.unwrap_or(None))
    }

    /// half²·J of the plan of `count` steps from here.
    #[inline(always)]
    fn product<S: Simd, L: LocalSystem<K>>(
        &mut self,
        simd: S,
        local: &L,
        sine: f64,
        state: &Stage<f64, K>,
        half: f64,
        count: f64,
    ) -> f64 {
        let of_this_length = self.last_plan.half == half;
        // Where every step restarts, it is renewed when their length is looked at.
        let due = self.restarted && self.seen.steps == 0;
        if self.slope.is_vague() || self.before.is_none() || !of_this_length || due {
            let positions = match &self.before {
                Some(before) => shifted(
                    pair(simd, &before.motion.displacement),
                    state.position - before.motion.moved,
                ),
                None => [f64x4::splat(simd, state.position); 2],
            };
            self.slope
                .include(simd.level(), local, sine, state, &unpair(positions));
        }
        let wanted = (half * half * self.slope.value).clamp(-STEEPEST, 0.0);
        let spreads = if of_this_length {
            SPREADS_OFF
        } else {
            SPREADS_OFF_ONCE
        };
        let near_enough = SLOPE_OFF + spreads * half * half * self.slope.spread;
        if (self.last_plan.product - wanted).abs() < near_enough {
            // Matrices that are there serve another length too, with a slope that fits it.
            self.last_plan.product
        } else if wanted > -SLOPE_OFF || !of_this_length && count < FEW {
            0.0
        } else {
            wanted
        }
    }
}
