//! The first guess of a step: the step before, continued.
//!
//! The polynomial through the 8 values of the step before would grow like u⁷ beyond it,
//! which a motion does not that turns more than once in a step: what is continued is a polynomial times a bell,
//! (1 + b·u²)⁻⁸, u being −1 at the begin of the step before and 1 at its end.

use fearless_simd::{Simd, SimdBase, f64x4};

use super::plan::{NODES, Pair, both_permuted, multiply, pair, unpair};
use super::table::TABLE;
use crate::arithmetic::lanes::rolled_if_narrow;
use crate::arithmetic::legendre;
use crate::arithmetic::number::Number;

/// The bend of the bell for each half²·J, and at least. In the mean over the benchmark's motions the error of the first
/// guess is a quarter of that of the polynomial alone at a tolerance of 1e-6, two fifths at 1e-9, two thirds at 1e-12;
/// it is larger where the bend is half as large or twice as large.
const BEND: f64 = 0.025;
const LEAST_BEND: f64 = 0.003;

/// The bell of steps of one length and slope.
#[derive(Clone, Copy, Debug)]
pub struct Bell {
    /// Its inverse at the nodes.
    inverse: [f64; NODES],
    /// The bell at those of the step after.
    ahead: [f64; NODES],
}

impl Bell {
    /// That of no step.
    pub const NONE: Bell = Bell {
        inverse: [0.0; NODES],
        ahead: [0.0; NODES],
    };

    /// That of steps whose half²·J is `product`.
    #[inline(always)]
    pub fn of<S: Simd>(simd: S, product: f64) -> Bell {
        let bend = bend_of(product);
        let one = f64x4::splat(simd, 1.0);
        let [mut here, mut ahead] = [pair(simd, &TABLE.place); 2];
        for k in 0..2 {
            here[k] = inverse_bell(bend, here[k] - one);
            ahead[k] = one / inverse_bell(bend, ahead[k] + one);
        }
        Bell {
            inverse: unpair(here),
            ahead: unpair(ahead),
        }
    }

    /// Values at the nodes continued to those of the next step, if that has the same length, plus `shift`.
    #[inline(always)]
    pub fn ahead<S: Simd>(&self, simd: S, values: Pair<S>, shift: f64) -> Pair<S> {
        let by = pair(simd, &self.inverse);
        let values = both_permuted([values[0] * by[0], values[1] * by[1]]);
        let none = [f64x4::splat(simd, 0.0); 2];
        let same = multiply(simd, &TABLE.ahead, &values, none);
        let by = pair(simd, &self.ahead);
        // The shift comes late and is added last.
        let shift = f64x4::splat(simd, shift);
        [same[0].mul_add(by[0], shift), same[1].mul_add(by[1], shift)]
    }
}

/// Values at the nodes of a step of half the length `before`, half²·J being `product`, continued to these times after
/// its end.
#[inline(always)]
pub fn resampled<S: Simd>(
    simd: S,
    mut g: Pair<S>,
    before: f64,
    product: f64,
    times: Pair<S>,
) -> Pair<S> {
    let bend = bend_of(product);
    let places = pair(simd, &TABLE.place);
    for k in 0..2 {
        g[k] *= inverse_bell(bend, places[k] - places[k].same(1.0));
    }
    let g = unpair(g);
    let mut series = [f64x4::splat(simd, 0.0); 2];
    for j in rolled_if_narrow::<S, NODES>() {
        let value = f64x4::splat(simd, g[j]);
        let [low, high] = pair(simd, &TABLE.series[j]);
        series = [
            low.mul_add(value, series[0]),
            high.mul_add(value, series[1]),
        ];
    }
    let series = unpair(series);
    let inverse = f64x4::splat(simd, 1.0 / before);
    let one = f64x4::splat(simd, 1.0);
    let mut values = times;
    for k in 0..2 {
        let u = values[k].mul_add(inverse, one);
        values[k] =
            legendre::sum(u, NODES, |degree| u.same(series[degree])) / inverse_bell(bend, u);
    }
    values
}

/// By how much the bell of a step is bent, whose half²·J is `product`: it is as wide as some radians of the
/// motion's own oscillation.
#[inline(always)]
fn bend_of(product: f64) -> f64 {
    (-BEND * product).max(LEAST_BEND)
}

/// (1 + bend·u²)⁸.
#[inline(always)]
fn inverse_bell<N: Number>(bend: f64, u: N) -> N {
    let first = (u * u).mul_add(u.same(bend), u.same(1.0));
    let square = first * first;
    let fourth = square * square;
    fourth * fourth
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;
    use crate::solver::endpoint::plan::Plan;

    /// An oscillation of 2 rad in a half step, by equal steps and by shorter ones. The polynomial alone misses 14 and 0.6.
    #[test]
    fn the_first_guess_goes_on_as_a_motion_that_turns_in_a_step() {
        let (half, product) = (2.0, -1.6);
        let g = |u: f64| (2.0 * u + 0.3).cos();
        let before = TABLE.place.map(|place| g(place - 1.0));
        let mut plan = Plan::NONE;
        let [ahead, shorter] = dispatch!(Level::new(), simd => {
            plan.prepare(simd, half, product, 0.0);
            let ahead = unpair(plan.ahead(simd, pair(simd, &before), 0.0));
            plan.prepare(simd, 0.5 * half, 0.25 * product, 0.0);
            [ahead, unpair(plan.resampled(simd, pair(simd, &before), half, product))]
        });
        for i in 0..NODES {
            let place = TABLE.place[i];
            let error = (ahead[i] - g(1.0 + place)).abs();
            assert!(error < 1.0, "{place}: {error}");
            let error = (shorter[i] - g(1.0 + 0.5 * place)).abs();
            assert!(error < 0.05, "{place}: {error}");
        }
    }
}
