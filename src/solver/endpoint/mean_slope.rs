//! ∂f/∂x of late, from which a plan takes its slope.

use fearless_simd::{Level, Simd, SimdBase, dispatch, f64x4};
use serde::{Deserialize, Serialize};

use super::plan::{NODES, pair};
use super::system::{LocalSystem, in_lanes};
use crate::arithmetic::lanes::Lanes;
use crate::solver::coupled::Stage;

/// States over which it is averaged.
const AVERAGED: f64 = 16.0;

/// Of fewer states it may be far from the mean of a motion between two turning points.
const FEW: f64 = 4.0;

/// ∂f/∂x over the last states, and over how many.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct MeanSlope {
    pub value: f64,
    /// By how much the states differ from it, in the mean.
    pub spread: f64,
    states: f64,
}

impl MeanSlope {
    /// Of no state yet.
    pub const UNKNOWN: MeanSlope = MeanSlope {
        value: 0.0,
        spread: 0.0,
        states: 0.0,
    };

    /// Whether it is still one of few states.
    pub fn is_vague(&self) -> bool {
        self.states < FEW
    }

    /// Whether the numbers can be those of states.
    pub fn is_valid(&self) -> bool {
        self.value.is_finite()
            && (0.0..f64::INFINITY).contains(&self.spread)
            && (0.0..=AVERAGED).contains(&self.states)
    }

    /// Takes these positions too, at the origin of time, where the alternating part of the load has this
    /// sine; in a function of its own, since it is long and not hot.
    #[inline(never)]
    pub fn include<const K: usize, L: LocalSystem<K>>(
        &mut self,
        level: Level,
        local: &L,
        sine: f64,
        state: &Stage<f64, K>,
        positions: &[f64; NODES],
    ) {
        let slope = dispatch!(level, simd => {
            let load = local.load_with_sine(f64x4::splat(simd, 0.0), f64x4::splat(simd, sine));
            let [low, high] = pair(simd, positions);
            let sum = slope(simd, local, load, state, low) + slope(simd, local, load, state, high);
            Lanes::<_, 4>::store(sum).iter().sum::<f64>() * 0.125
        });
        self.states = (self.states + 1.0).min(AVERAGED);
        if self.states > 1.0 {
            let off = (slope - self.value).abs();
            let next = self.spread + (off - self.spread) / self.states;
            self.spread = if next.is_finite() { next } else { 0.0 };
        }
        let next = self.value + (slope - self.value) / self.states;
        // The first one counts alone.
        let next = if self.states == 1.0 { slope } else { next };
        self.value = if next.is_finite() { next } else { 0.0 };
    }
}

/// ∂f/∂x under this load at these positions, the rest as in `state`; its last digits do not matter.
#[inline(always)]
fn slope<S: Simd, const K: usize, L: LocalSystem<K>>(
    simd: S,
    local: &L,
    load: L::Load<f64x4<S>>,
    state: &Stage<f64, K>,
    position: f64x4<S>,
) -> f64x4<S> {
    let mut at = in_lanes(simd, state);
    let shift = position * f64x4::splat(simd, 1e-4);
    at.position = position + shift;
    let above = local.acceleration(load, &local.geometry(at.position), &at);
    at.position = position - shift;
    let below = local.acceleration(load, &local.geometry(at.position), &at);
    (above - below) / (shift + shift)
}
