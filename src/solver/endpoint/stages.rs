//! The stages of one step, iterated on a plan.

use std::hint::black_box;

use fearless_simd::{Simd, SimdBase, f64x4};

use super::plan::{Pair, Plan, largest, shifted};
use crate::arithmetic::lanes::Lanes;
use crate::solver::iteration::{Diverged, IterationTolerance};
use crate::solver::{LocalEquation, State};

/// The stages of a step, as far as they have been iterated.
pub struct Stages<S: Simd> {
    /// g of the plan at the nodes.
    pub g: Pair<S>,
    /// x − x_0 there.
    pub displacement: Pair<S>,
    /// How often they were iterated.
    pub iterations: u32,
    /// By how much the last iteration moved the end.
    pub change: f64,
    /// By how much the one before did.
    pub last_change: f64,
}

/// Iterates the stages of a step from a guess of g, `planned` times at least.
///
/// # Errors
/// [`Diverged`]: a shorter step will do.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "in registers, each by its name")]
pub fn solve<S: Simd, L: LocalEquation>(
    simd: S,
    plan: &Plan,
    local: &L,
    loads: [L::Load<f64x4<S>>; 2],
    state: State,
    guess: Pair<S>,
    planned: u32,
    tolerance: IterationTolerance,
) -> Result<Stages<S>, Diverged> {
    let [drift, gain] = plan.free(simd, state.rate);
    let free = [shifted(drift, state.position), gain];
    let slope = f64x4::splat(simd, -plan.slope);
    // g moves the end by no more than this.
    let reach = 2.0 * plan.half * plan.half;
    let [mut g, mut last] = [guess; 2];
    let mut iterations = 0;
    loop {
        // Or its matrices would be copied to the stack before the loop: they are more than registers.
        let plan = black_box(plan);
        let [position, rate] = plan.stages(simd, g, free);
        // What the position is rounded by is in both parts of g, which makes up for most of it.
        let displacement = shifted(position, -state.position);
        let before_last = last;
        last = g;
        for k in 0..2 {
            let linear = displacement[k] * slope;
            g[k] = local.acceleration_and(loads[k], position[k], rate[k], linear);
        }
        iterations += 1;
        // What follows would be waited for.
        if iterations < planned {
            continue;
        }
        let change = reach * largest::<S>([g[0] - last[0], g[1] - last[1]]);
        let last_change =
            reach * largest::<S>([last[0] - before_last[0], last[1] - before_last[1]]);
        let rate = [change, last_change];
        if tolerance.has_converged(iterations, change, last_change, rate)? {
            return Ok(Stages {
                g,
                displacement,
                iterations,
                change,
                last_change,
            });
        }
    }
}

/// (Δu)²/8 of the two nodes in the middle, the farthest from each other, and a third more, since f may be
/// larger between the nodes: x goes beyond both by this part of half²·|f| at most.
const BETWEEN_NODES: f64 = 0.0224;

/// Whether a step stays between these positions that moves by `moved` in all and by `swing` at the nodes,
/// and where half²·|f| is no more than `bend`.
#[inline(always)]
pub fn stays_between<S: Simd>(
    (lowest, highest): (f64, f64),
    position: f64,
    moved: f64,
    swing: f64,
    bend: f64,
    [low, high]: Pair<S>,
) -> bool {
    let beyond = BETWEEN_NODES * bend;
    let far = swing.max(moved.abs()) + beyond;
    if position - far > lowest && position + far < highest {
        return true;
    }
    let up = Lanes::<S, 4>::max(low, high).largest().max(moved).max(0.0);
    let down = Lanes::<S, 4>::min(low, high).smallest().min(moved).min(0.0);
    position + down - beyond > lowest && position + up + beyond < highest
}
