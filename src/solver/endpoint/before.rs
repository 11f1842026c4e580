//! What the last of equal steps leaves for the next one.

use fearless_simd::{Simd, SimdBase, f64x4};
use serde::{Deserialize, Serialize};

use super::plan::{NODES, Pair, Plan, pair, shifted, unpair};
use crate::solver::number::Number;

/// The slope of a plan is bounded so that its matrices are well conditioned.
pub const STEEPEST: f64 = 8.0;

/// The last step.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Before {
    pub half: f64,
    /// half²·J of its plan.
    pub product: f64,
    /// By how much the position has moved.
    pub moved: f64,
    /// g of its plan, and the displacement since its begin, at the nodes.
    pub g: [f64; NODES],
    pub displacement: [f64; NODES],
}

impl Before {
    /// Whether the numbers can be those of a step.
    pub fn is_valid(&self) -> bool {
        let numbers = self.g.iter().chain(&self.displacement);
        self.half > 0.0
            && self.half.is_finite()
            && (-STEEPEST..=0.0).contains(&self.product)
            && numbers
                .chain([&self.moved])
                .all(|number| number.is_finite())
    }

    /// g of the step after, on its plan.
    #[inline(always)]
    pub fn continued<S: Simd>(&self, simd: S, plan: &Plan) -> Pair<S> {
        let slope = self.product / (self.half * self.half);
        let change = f64x4::splat(simd, slope - plan.slope);
        let [low, high] = pair(simd, &self.g);
        let displacement = pair(simd, &self.displacement);
        let g = [
            displacement[0].mul_add(change, low),
            displacement[1].mul_add(change, high),
        ];
        if self.half == plan.half {
            return plan.ahead(simd, g, self.moved);
        }
        shifted(
            plan.resampled(simd, &unpair(g), self.half),
            plan.slope * self.moved,
        )
    }
}
