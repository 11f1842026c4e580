//! The stages of one step, iterated on a plan.

use std::hint::black_box;

use fearless_simd::{Simd, SimdBase, f64x4};

use super::plan::{Pair, Plan, largest, shifted};
use super::relaxation::{Change, Relaxation};
use super::system::{LocalSystem, in_lanes};
use crate::arithmetic::lanes::Lanes;
use crate::arithmetic::number::Number;
use crate::solver::coupled::Stage;
use crate::solver::iteration::{Diverged, IterationTolerance};

/// The stages of a step, as far as they have been iterated.
#[derive(Clone, Copy)]
pub struct Stages<S: Simd, const K: usize> {
    /// g of the plan at the nodes, and x − x_0 there.
    pub motion: Course<S>,
    /// The same of the first-order states.
    pub internal: [Course<S>; K],
    /// How often they were iterated.
    pub iterations: u32,
    /// By how much the last iteration moved the end.
    pub change: f64,
    /// By how much the one before did.
    pub last_change: f64,
}

/// One of them over the nodes.
#[derive(Clone, Copy)]
pub struct Course<S: Simd> {
    /// g of its plan.
    pub g: Pair<S>,
    /// How far it is from where it began.
    pub displacement: Pair<S>,
}

/// The plans of the position and of the first-order states.
#[derive(Clone, Debug)]
pub struct Plans<const K: usize> {
    pub motion: Plan,
    pub internal: [Relaxation; K],
}

impl<const K: usize> Default for Plans<K> {
    fn default() -> Plans<K> {
        Plans {
            motion: Plan::NONE,
            internal: [Relaxation::NONE; K],
        }
    }
}

/// A guess of g, of the position and of the first-order states.
#[derive(Clone, Copy)]
pub struct Guess<S: Simd, const K: usize> {
    pub motion: Pair<S>,
    pub internal: [Pair<S>; K],
}

/// Iterates the stages of a step from a guess of g, `planned` times at least. A change of a first-order state counts as
/// one of the position by as many times as the `weights` say.
///
/// # Errors
/// [`Diverged`]: a shorter step will do.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "in registers, each by its name")]
pub fn solve<S: Simd, const K: usize, L: LocalSystem<K>>(
    simd: S,
    plans: &Plans<K>,
    local: &L,
    loads: [L::Load<f64x4<S>>; 2],
    state: Stage<f64, K>,
    guess: Guess<S, K>,
    weights: [f64; K],
    planned: u32,
    tolerance: IterationTolerance,
) -> Result<Stages<S, K>, Diverged> {
    let plan = &plans.motion;
    let states = local.states();
    let [drift, gain] = plan.free(simd, state.rate);
    let free = [shifted(drift, state.position), gain];
    let slope = f64x4::splat(simd, -plan.slope);
    // g moves the end by no more than this.
    let reach = 2.0 * plan.half * plan.half;
    let [mut g, mut last] = [guess.motion; 2];
    let none = [f64x4::splat(simd, 0.0); 2];
    let mut internal = [Course {
        g: none,
        displacement: none,
    }; K];
    let start = in_lanes(simd, &state);
    let mut at = [start; 2];
    for k in 0..K {
        if k < states {
            let displacement = plans.internal[k].displacement(simd, guess.internal[k]);
            internal[k] = Course {
                g: guess.internal[k],
                displacement,
            };
            for r in 0..2 {
                at[r].internal[k] = start.internal[k] + displacement[r];
            }
        }
    }
    let mut moved = none;
    let mut iterations = 0;
    loop {
        // Or its matrices would be copied to the stack before the loop: they are more than registers.
        let plans = black_box(plans);
        let [position, rate] = plans.motion.stages(simd, g, free);
        // What the position is rounded by is in both parts of g, which makes up for most of it.
        let displacement = shifted(position, -state.position);
        let mut geometry = [local.geometry(position[0]); 2];
        geometry[1] = local.geometry(position[1]);
        for r in 0..2 {
            at[r].position = position[r];
            at[r].rate = rate[r];
        }
        let last_moved = std::mem::replace(&mut moved, none);
        for k in 0..K {
            if k < states {
                let plan = &plans.internal[k];
                let rate = f64x4::splat(simd, plan.rate);
                let weight = f64x4::splat(simd, weights[k]);
                let mut new = none;
                for r in 0..2 {
                    let slope = local.slope(k, loads[r], &geometry[r], &at[r]).value;
                    new[r] = internal[k].displacement[r].mul_add(rate, slope);
                    let change = Lanes::<S, 4>::abs(new[r] - internal[k].g[r]) * weight;
                    moved[r] = Lanes::<S, 4>::max(moved[r], change);
                }
                let displacement = plan.displacement(simd, new);
                internal[k] = Course {
                    g: new,
                    displacement,
                };
                for r in 0..2 {
                    at[r].internal[k] = start.internal[k] + displacement[r];
                }
            }
        }
        let before_last = last;
        last = g;
        for r in 0..2 {
            let linear = displacement[r] * slope;
            g[r] = local.acceleration_and(loads[r], &geometry[r], &at[r], linear);
        }
        iterations += 1;
        // What follows would be waited for.
        if iterations < planned {
            continue;
        }
        let mut change = reach * largest::<S>([g[0] - last[0], g[1] - last[1]]);
        let mut last_change =
            reach * largest::<S>([last[0] - before_last[0], last[1] - before_last[1]]);
        if states > 0 && !change.is_nan() {
            change = change.max(largest::<S>(moved));
            last_change = last_change.max(largest::<S>(last_moved));
        }
        let rate = [change, last_change];
        if tolerance.has_converged(iterations, change, last_change, rate)? {
            return Ok(Stages {
                motion: Course { g, displacement },
                internal,
                iterations,
                change,
                last_change,
            });
        }
    }
}

/// The end of a step misses less than this part of the estimate below. Measured on driven motions of
/// all kinds, near escape too (`tests/stress`): the error of a whole motion stays below half a
/// tolerance times what the motion makes of it.
const NEGLECTED_WITH_PLAN: f64 = 2e4;

/// (Δu)²/8 of the two nodes in the middle, the farthest from each other, and a third more, since f may be
/// larger between the nodes: x goes beyond both by this part of half²·|f| at most.
const BETWEEN_NODES: f64 = 0.0224;

/// The end of a step.
#[derive(Clone, Copy)]
pub struct Ends<const K: usize> {
    /// By how much the position has moved, and the rate.
    pub moved: f64,
    gained: f64,
    /// How far the position is from its begin at the nodes, at most.
    swing: f64,
    /// half²·|f| is no more than this.
    bend: f64,
    /// half² times the last two Legendre coefficients of f, and its size.
    tail: f64,
    size: f64,
    /// The first-order states.
    pub internal: [Change; K],
}

impl<S: Simd, const K: usize> Stages<S, K> {
    /// The end of the step, which had this rate at its begin.
    #[inline(always)]
    pub fn ends(&self, simd: S, plans: &Plans<K>, states: usize, rate: f64) -> Ends<K> {
        let plan = &plans.motion;
        let square = plan.half * plan.half;
        let Course { g, displacement } = self.motion;
        let [moved, gained, sixth, seventh] = plan.end(simd, g, rate);
        let swing = largest::<S>(displacement);
        let parts = [largest::<S>(g), plan.slope.abs() * swing].map(|part| square * part);
        let mut internal = [Change::NONE; K];
        for k in 0..K {
            if k < states {
                let Course { g, displacement } = self.internal[k];
                internal[k] = plans.internal[k].end(simd, g, displacement);
            }
        }
        Ends {
            moved,
            gained,
            swing,
            bend: parts[0] + parts[1],
            tail: sixth.abs() + seventh.abs(),
            size: parts[0].max(parts[1]),
            internal,
        }
    }
}

impl<const K: usize> Ends<K> {
    /// The error as a part of what is allowed, where the position has this `scale` and the first-order states have
    /// these sizes. A Legendre series that falls geometrically reaches at degree 16, the first that is integrated
    /// wrongly, the square of what it has at degree 8, by its size.
    #[inline(always)]
    pub fn error(&self, end_tolerance: f64, scale: f64, sizes: &[f64; K]) -> f64 {
        let part = |tail: f64, size: f64, scale: f64| {
            let allowed = NEGLECTED_WITH_PLAN * end_tolerance * scale;
            tail * tail / (size * allowed).max(f64::MIN_POSITIVE)
        };
        let mut error = part(self.tail, self.size, scale);
        for k in 0..K {
            let Change { tail, size, .. } = self.internal[k];
            let own = part(tail, size, sizes[k]);
            // NaN is refused.
            error = if own <= error { error } else { own };
        }
        error
    }

    /// The state at the end of a step from `start`.
    #[inline(always)]
    pub fn after(&self, start: &Stage<f64, K>) -> Stage<f64, K> {
        let mut end = *start;
        end.position += self.moved;
        end.rate += self.gained;
        for k in 0..K {
            end.internal[k] += self.internal[k].moved;
        }
        end
    }

    /// Whether a step from `position` stays between these, with this displacement at the nodes.
    #[inline(always)]
    pub fn stays_between<S: Simd>(
        &self,
        (lowest, highest): (f64, f64),
        position: f64,
        [low, high]: Pair<S>,
    ) -> bool {
        let beyond = BETWEEN_NODES * self.bend;
        let far = self.swing.max(self.moved.abs()) + beyond;
        if position - far > lowest && position + far < highest {
            return true;
        }
        let (largest, smallest) = (
            Lanes::<S, 4>::max(low, high).largest(),
            Lanes::<S, 4>::min(low, high).smallest(),
        );
        let up = largest.max(self.moved).max(0.0);
        let down = smallest.min(self.moved).min(0.0);
        position + down - beyond > lowest && position + up + beyond < highest
    }
}
