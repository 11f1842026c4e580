//! What the last of equal steps leaves for the next one.

use fearless_simd::{Simd, SimdBase, f64x4};
use serde::{Deserialize, Serialize};

use super::plan::{NODES, Pair, Plan, last, pair, shifted, unpair};
use super::stages::{Course, Ends, Guess, Plans, Stages};
use crate::arithmetic::number::Number;

/// The last step: of the position, and of each first-order state.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(bound(
    serialize = "[Before; K]: Serialize",
    deserialize = "[Before; K]: Deserialize<'de>"
))]
pub struct LastStep<const K: usize> {
    pub motion: Before,
    pub internal: [Before; K],
}

/// The last step of one of them.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Before {
    /// By how much it has moved.
    pub moved: f64,
    /// x'' or z' at its end.
    pub derivative: f64,
    /// g of its plan, and the displacement since its begin, at the nodes.
    pub g: [f64; NODES],
    pub displacement: [f64; NODES],
}

/// What the plans of the last step follow from.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(bound(
    serialize = "[f64; K]: Serialize",
    deserialize = "[f64; K]: Deserialize<'de>"
))]
pub struct LastPlan<const K: usize> {
    /// Half the length of the step, 0 where there was none.
    pub half: f64,
    /// half²·J.
    pub product: f64,
    /// half·r of the first-order states.
    pub relaxations: [f64; K],
}

impl<const K: usize> LastStep<K> {
    /// What a step leaves whose stages are these.
    #[inline(always)]
    pub fn of<S: Simd>(
        simd: S,
        plans: &Plans<K>,
        states: usize,
        stages: &Stages<S, K>,
        ends: &Ends<K>,
    ) -> LastStep<K> {
        let mut step = LastStep {
            motion: Before::of(simd, stages.motion, plans.motion.slope, ends.moved),
            internal: [Before::NONE; K],
        };
        for k in 0..K {
            if k < states {
                let (slope, moved) = (-plans.internal[k].rate, ends.internal[k].moved);
                step.internal[k] = Before::of(simd, stages.internal[k], slope, moved);
            }
        }
        step
    }

    /// g of the next step, as it goes on from this one. Where the equation has changed, x'' and z' at the begin of the
    /// next step are given: each g jumps there, and goes on as it did.
    #[inline(always)]
    pub fn guess<S: Simd>(
        &self,
        simd: S,
        plans: &Plans<K>,
        states: usize,
        last: &LastPlan<K>,
        jump: Option<(f64x4<S>, [f64; K])>,
    ) -> Guess<S, K> {
        let none = f64x4::splat(simd, 0.0);
        let plan = &plans.motion;
        let slopes = [last.product / (last.half * last.half), plan.slope];
        let by = match jump {
            Some((first, _)) => first - f64x4::splat(simd, self.motion.derivative),
            None => none,
        };
        let [low, high] = self.motion.continued(simd, plan, last, slopes);
        let mut guess = Guess {
            motion: [low + by, high + by],
            internal: [[none; 2]; K],
        };
        for k in 0..K {
            if k < states {
                let before = &self.internal[k];
                let slopes = [-last.relaxations[k] / last.half, -plans.internal[k].rate];
                let by = match jump {
                    Some((_, first)) => f64x4::splat(simd, first[k] - before.derivative),
                    None => none,
                };
                let [low, high] = before.continued(simd, plan, last, slopes);
                guess.internal[k] = [low + by, high + by];
            }
        }
        guess
    }

    /// Whether the numbers can be those of a step.
    pub fn is_valid(&self) -> bool {
        self.motion.is_valid() && self.internal.iter().all(Before::is_valid)
    }
}

impl Before {
    /// That of a state which a system does not have.
    pub const NONE: Before = Before {
        moved: 0.0,
        derivative: 0.0,
        g: [0.0; NODES],
        displacement: [0.0; NODES],
    };

    #[inline(always)]
    fn of<S: Simd>(simd: S, course: Course<S>, slope: f64, moved: f64) -> Before {
        Before {
            moved,
            derivative: last(simd, course.g) + slope * moved,
            g: unpair(course.g),
            displacement: unpair(course.displacement),
        }
    }

    fn is_valid(&self) -> bool {
        let of_nodes = self.g.iter().chain(&self.displacement);
        of_nodes
            .chain([&self.moved, &self.derivative])
            .all(|number| number.is_finite())
    }

    /// g of the step after on its plan. Both slopes are given that are taken out of g: that of this step, and that of
    /// the next one.
    #[inline(always)]
    fn continued<S: Simd, const K: usize>(
        &self,
        simd: S,
        plan: &Plan,
        last: &LastPlan<K>,
        [slope, next]: [f64; 2],
    ) -> Pair<S> {
        let change = f64x4::splat(simd, slope - next);
        let [low, high] = pair(simd, &self.g);
        let displacement = pair(simd, &self.displacement);
        let g = [
            displacement[0].mul_add(change, low),
            displacement[1].mul_add(change, high),
        ];
        let shift = next * self.moved;
        if last.half == plan.half {
            return plan.ahead(simd, g, shift);
        }
        shifted(plan.resampled(simd, g, last.half, last.product), shift)
    }
}
