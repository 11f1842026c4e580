//! The multistep method of the ensemble: V. M. Falkner's (Phil. Mag. 21 (1936) 624–640) of order
//! 10 for x'' = f, x and x' both carried along, predicted, evaluated and corrected with one
//! evaluation of f a step.
//!
//! With σ counted in steps from the present, f is interpolated at σ = 0, −1, … −9 and integrated
//! once and twice over 0 ≤ σ ≤ 1. What f then is at σ = 1 differs from the continued polynomial:
//! this *miss*, times a constant, is the correction, and it estimates the error.
//!
//! The steps must be equal. A motion whose step has to change is started anew.
//!
//! Gain over a collocation step in each lane, which needs seven evaluations of f for each unit of
//! time where this method needs three: see `benchmark/records`, sweep.

use fearless_simd::Simd;

use super::{LANES, Packed, Row};
use crate::arithmetic::lanes::Lanes;

/// Values of f that the method looks back on.
pub const ORDER: usize = 10;

/// Steps that are taken between two looks at the lanes.
pub const BLOCK: usize = 16;

/// Above this angle of the natural motion in a step the method is unstable (0.13 by experiment).
pub const STABLE: f64 = 0.12;

/// Integral weights of the interpolated f, and its continuation by a step.
struct Weights {
    /// ∫₀¹ L_j(σ) dσ, for x'.
    once: [f64; ORDER],
    /// ∫₀¹ (1 − σ) L_j(σ) dσ, for x.
    twice: [f64; ORDER],
    /// L_j(1).
    continued: [f64; ORDER],
    /// ∫₀¹ M(σ) dσ of what the miss adds, M = σ(σ+1)…(σ+9)/10!, for x'.
    miss_once: f64,
    /// ∫₀¹ (1 − σ) M(σ) dσ, for x.
    miss_twice: f64,
}

static WEIGHTS: Weights = weights();

/// 27720 is divisible by each of 1 to 12.
const DENOMINATOR: i128 = 27_720;

/// The coefficients of Π (σ + i) over i from 0 to before `points`, without `left_out`, by powers of σ.
pub const fn product(points: usize, left_out: usize) -> [i128; ORDER + 1] {
    let mut coefficients = [0; ORDER + 1];
    coefficients[0] = 1;
    let mut i = 0;
    while i < points {
        if i != left_out {
            let mut k = ORDER;
            while k > 0 {
                coefficients[k] = coefficients[k] * i as i128 + coefficients[k - 1];
                k -= 1;
            }
            coefficients[0] *= i as i128;
        }
        i += 1;
    }
    coefficients
}

/// ∫₀¹ p dσ and ∫₀¹ (1 − σ) p dσ over `scale`, exact until the quotients.
const fn integrals(p: [i128; ORDER + 1], scale: i128) -> (f64, f64) {
    let (mut once, mut moment) = (0, 0);
    let mut k = 0;
    while k <= ORDER {
        once += p[k] * (DENOMINATOR / (k as i128 + 1));
        moment += p[k] * (DENOMINATOR / (k as i128 + 2));
        k += 1;
    }
    let scale = (scale * DENOMINATOR) as f64;
    (once as f64 / scale, (once - moment) as f64 / scale)
}

/// Π (i − j) over the same i other than j: the value of the product above at its own node.
pub const fn own(points: usize, j: usize) -> i128 {
    let (mut value, mut i) = (1, 0);
    while i < points {
        if i != j {
            value *= i as i128 - j as i128;
        }
        i += 1;
    }
    value
}

const fn weights() -> Weights {
    let mut weights = Weights {
        once: [0.0; ORDER],
        twice: [0.0; ORDER],
        continued: [0.0; ORDER],
        miss_once: 0.0,
        miss_twice: 0.0,
    };
    let mut j = 0;
    while j < ORDER {
        let p = product(ORDER, j);
        (weights.once[j], weights.twice[j]) = integrals(p, own(ORDER, j));
        let (mut at_one, mut k) = (0, 0);
        while k <= ORDER {
            at_one += p[k];
            k += 1;
        }
        weights.continued[j] = (at_one / own(ORDER, j)) as f64;
        j += 1;
    }
    let all = product(ORDER, ORDER);
    let (mut factorial, mut i) = (1, 2);
    while i <= ORDER as i128 {
        factorial *= i;
        i += 1;
    }
    (weights.miss_once, weights.miss_twice) = integrals(all, factorial);
    weights
}

/// The motions of all lanes, each with steps of its own length, and what a block of steps leaves.
#[derive(Clone, Debug)]
pub struct LaneStates {
    pub position: Row,
    pub rate: Row,
    /// Length of a step; 0 where the lane is free.
    pub step: Row,
    /// f at the places of the last steps, the oldest first; the block's own behind them.
    pub f: [Row; ORDER + BLOCK],
    /// Positions and rates at the ends of the block's steps.
    pub positions: [Row; BLOCK],
    pub rates: [Row; BLOCK],
    /// The range that holds the motion in the block: between the ends of two steps it goes beyond
    /// both by less than |f| h²/8.
    pub lowest: Row,
    pub highest: Row,
    /// The largest correction of a position by the miss.
    pub correction: Row,
    /// The largest natural frequency at the block's end, squared.
    pub stiffness: Row,
}

impl LaneStates {
    /// All lanes rest at 1.
    pub const IDLE: LaneStates = LaneStates {
        position: [1.0; LANES],
        rate: [0.0; LANES],
        step: [0.0; LANES],
        f: [[0.0; LANES]; ORDER + BLOCK],
        positions: [[1.0; LANES]; BLOCK],
        rates: [[0.0; LANES]; BLOCK],
        lowest: [1.0; LANES],
        highest: [1.0; LANES],
        correction: [0.0; LANES],
        stiffness: [0.0; LANES],
    };

    /// Takes a block of steps in each lane.
    #[inline(always)]
    pub fn go<S: Simd, V: Lanes<S, LANES>, P: Packed<V>>(&mut self, simd: S, packed: &mut P) {
        let fill = |value: f64| V::fill(simd, value);
        let step = V::load(simd, &self.step);
        let square = step * step;
        let mut position = V::load(simd, &self.position);
        let mut rate = V::load(simd, &self.rate);
        let (mut lowest, mut highest) = (position, position);
        let (mut worst, mut largest) = (fill(0.0), fill(0.0));
        for i in 0..BLOCK {
            let mut once = V::load(simd, &self.f[i]) * fill(WEIGHTS.once[ORDER - 1]);
            let mut twice = V::load(simd, &self.f[i]) * fill(WEIGHTS.twice[ORDER - 1]);
            let mut continued = V::load(simd, &self.f[i]) * fill(WEIGHTS.continued[ORDER - 1]);
            for j in (0..ORDER - 1).rev() {
                let f = V::load(simd, &self.f[i + ORDER - 1 - j]);
                once = f.mul_add(fill(WEIGHTS.once[j]), once);
                twice = f.mul_add(fill(WEIGHTS.twice[j]), twice);
                continued = f.mul_add(fill(WEIGHTS.continued[j]), continued);
            }
            packed.turn();
            let drift = rate.mul_add(step, twice * square);
            let predicted = (position + drift, once.mul_add(step, rate));
            let f = packed.acceleration(predicted.0, predicted.1);
            let miss = f - continued;
            let corrected = miss * fill(WEIGHTS.miss_twice);
            position = corrected.mul_add(square, predicted.0);
            rate = (miss * fill(WEIGHTS.miss_once)).mul_add(step, predicted.1);
            worst = worst.max(corrected.abs());
            largest = largest.max(f.abs());
            lowest = lowest.min(position);
            highest = highest.max(position);
            self.f[i + ORDER] = f.store();
            self.positions[i] = position.store();
            self.rates[i] = rate.store();
        }
        self.position = position.store();
        self.rate = rate.store();
        let beyond = largest * (square * fill(0.125));
        self.lowest = (lowest - beyond).store();
        self.highest = (highest + beyond).store();
        self.correction = (worst * square).store();
        self.stiffness = packed.stiffness(position).store();
    }

    /// Makes the values of f at the block's end those that the next block looks back on.
    pub fn go_on(&mut self) {
        self.f.copy_within(BLOCK.., 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The classical coefficients of the Adams–Bashforth formula of order 10 sum up to 1, those of
    /// the double integral to 1/2, and a polynomial of degree 9 is continued exactly.
    #[test]
    fn the_weights_are_those_of_the_interpolation() {
        assert!((WEIGHTS.once.iter().sum::<f64>() - 1.0).abs() < 1e-13);
        assert!((WEIGHTS.twice.iter().sum::<f64>() - 0.5).abs() < 1e-13);
        assert_eq!(WEIGHTS.once[0], 30_277_247.0 / 7_257_600.0);
        for degree in 0..ORDER as i32 {
            let f = |sigma: f64| sigma.powi(degree);
            let at = |weights: &[f64; ORDER]| -> f64 {
                let terms = weights.iter().enumerate();
                terms.map(|(j, weight)| weight * f(-(j as f64))).sum()
            };
            let (degree, size) = (f64::from(degree), 9_f64.powi(degree));
            assert!((at(&WEIGHTS.once) - 1.0 / (degree + 1.0)).abs() < 1e-13 * size);
            let twice = 1.0 / ((degree + 1.0) * (degree + 2.0));
            assert!((at(&WEIGHTS.twice) - twice).abs() < 1e-13 * size);
            assert!((at(&WEIGHTS.continued) - 1.0).abs() < 1e-12 * size);
        }
    }
}
