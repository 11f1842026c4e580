//! What the last of equal steps leaves for the next one.

use fearless_simd::{Simd, SimdBase, f64x4};
use serde::{Deserialize, Serialize};

use super::plan::{NODES, Pair, Plan, pair, shifted};
use crate::arithmetic::number::Number;

/// The last step.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Before {
    /// By how much the position has moved.
    pub moved: f64,
    /// x'' at its end.
    pub acceleration: f64,
    /// g of its plan, and the displacement since its begin, at the nodes.
    pub g: [f64; NODES],
    pub displacement: [f64; NODES],
}

impl Before {
    /// Whether the numbers can be those of a step.
    pub fn is_valid(&self) -> bool {
        let of_nodes = self.g.iter().chain(&self.displacement);
        of_nodes
            .chain([&self.moved, &self.acceleration])
            .all(|number| number.is_finite())
    }

    /// g of the step after on its plan, where this one had half the length `half` and half²·J `product`.
    #[inline(always)]
    pub fn continued<S: Simd>(&self, simd: S, plan: &Plan, half: f64, product: f64) -> Pair<S> {
        let slope = product / (half * half);
        let change = f64x4::splat(simd, slope - plan.slope);
        let [low, high] = pair(simd, &self.g);
        let displacement = pair(simd, &self.displacement);
        let g = [
            displacement[0].mul_add(change, low),
            displacement[1].mul_add(change, high),
        ];
        if half == plan.half {
            return plan.ahead(simd, g, self.moved);
        }
        shifted(
            plan.resampled(simd, g, half, product),
            plan.slope * self.moved,
        )
    }
}
