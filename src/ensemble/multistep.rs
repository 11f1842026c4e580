//! The multistep method of the ensemble: V. M. Falkner's (Phil. Mag. 21 (1936) 624–640) for
//! x'' = f, x and x' both carried along, predicted, evaluated and corrected with one evaluation of
//! f a step.
//!
//! With σ counted in steps from the present, f is interpolated at σ = 0, −1, … and integrated
//! once and twice over 0 ≤ σ ≤ 1. What f then is at σ = 1 differs from the continued polynomial:
//! this *miss*, times a constant, is the correction, and it estimates the error.
//!
//! The miss is the highest difference of f. What the correction adds to a step is therefore a sum
//! over the same values of f as the next prediction, and one sum with one value more does both:
//! a block carries the predicted x and x' along, and corrects them at its end.
//!
//! Gain over a collocation step in each lane, which needs seven evaluations of f for each unit of
//! time where this method needs three: see `benchmark/records`, `ensemble.csv`.

use fearless_simd::Simd;

use super::{LANES, Packed, PerLane};
use crate::arithmetic::lanes::Lanes;
use crate::solver::extremes::Extremes;
use crate::solver::limits::Limits;

/// Values of f that are kept from the steps before a block.
pub const HISTORY: usize = 16;

/// Steps that are taken between two looks at the lanes: pairs of them, and a multiple of [`ESTIMATED`].
pub const BLOCK: usize = 32;

/// By which factor (ωh)² may become larger than where the formula is stable.
pub const STIFFER: f64 = 1.2;

/// Steps from one estimate of the error to the next.
const ESTIMATED: usize = 4;

/// The most values of f that a formula looks back on.
const MOST_POINTS: usize = 10;

/// Falkner's formula by the number of values of f that it looks back on.
pub struct Falkner<const POINTS: usize> {
    /// Weights of h²f for hx'.
    once: [f64; POINTS],
    /// Weights of h²f for x, beside x + hx'.
    twice: [f64; POINTS],
    /// Weights of h²f in its highest difference, the miss.
    miss: [f64; POINTS],
    /// What the miss corrects hx' by.
    miss_once: f64,
    /// What the miss corrects x by.
    miss_twice: f64,
}

/// 27720 is divisible by each of 1 to 12.
const DENOMINATOR: i128 = 27_720;

/// The coefficients of Π (σ + i) over i from 0 to before `points`, without `left_out`, by powers of σ.
pub const fn product(points: usize, left_out: usize) -> [i128; MOST_POINTS] {
    let mut coefficients = [0; MOST_POINTS];
    coefficients[0] = 1;
    let mut i = 0;
    while i < points {
        if i != left_out {
            let mut k = MOST_POINTS - 1;
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
const fn integrals(p: [i128; MOST_POINTS], scale: i128) -> (f64, f64) {
    let (mut once, mut moment) = (0, 0);
    let mut k = 0;
    while k < MOST_POINTS {
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

impl<const POINTS: usize> Falkner<POINTS> {
    /// The formula, worked out by the compiler.
    pub const WEIGHTS: Falkner<POINTS> = Falkner::new();

    /// The correction falls with the step like its power of this order.
    pub const FALL: f64 = (POINTS + 1) as f64;

    /// The largest correction of a position in a step, over the tolerance and the position. What is corrected is the
    /// method's error by one order less: the error that stays is smaller. Of 2500 motions near escape, the worst
    /// misses 1.2 tolerances times its amplification by 9 values, 5.1 by 10.
    pub const CORRECTION: f64 = match POINTS {
        ..=9 => 0.05,
        _ => 0.02,
    };

    /// The angle of the natural motion in a step up to which the method is used. It is stable a tenth
    /// beyond, where the roots of its recurrence are smaller than 1.
    pub const STABLE: f64 = match POINTS {
        ..=9 => 0.2,
        _ => 0.14,
    };

    const fn new() -> Falkner<POINTS> {
        let mut factorial = 1;
        let mut i = 2;
        while i < POINTS as i128 {
            factorial *= i;
            i += 1;
        }
        // Of M = σ(σ+1)…/(POINTS − 1)!, by which the miss adds to the polynomial.
        let (miss_once, miss_twice) = integrals(product(POINTS - 1, POINTS), factorial);
        let mut formula = Falkner {
            once: [0.0; POINTS],
            twice: [0.0; POINTS],
            miss: [0.0; POINTS],
            miss_once,
            miss_twice,
        };
        let mut j = 0;
        while j < POINTS {
            let own = own(POINTS, j);
            let (once, twice) = integrals(product(POINTS, j), own);
            let miss = (factorial / own) as f64;
            formula.once[j] = once;
            // With the correction of x' before.
            formula.twice[j] = twice + miss_once * miss;
            formula.miss[j] = miss;
            j += 1;
        }
        formula
    }

    /// The miss by the values of h²f, the oldest first.
    #[inline(always)]
    fn miss<S: Simd, V: Lanes<S, LANES>>(simd: S, f: &[PerLane]) -> V {
        let weights = &Self::WEIGHTS.miss;
        let mut sum = V::load(simd, &f[0]) * V::fill(simd, weights[POINTS - 1]);
        for j in (0..POINTS - 1).rev() {
            sum = V::load(simd, &f[POINTS - 1 - j]).mul_add(V::fill(simd, weights[j]), sum);
        }
        sum
    }
}

/// The motions of all lanes, each with steps of its own length, and what a block of steps leaves. A row
/// that crossed a cache line would be loaded in two parts.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub struct LaneStates {
    pub position: PerLane,
    pub rate: PerLane,
    /// Length of a step h; 0 where the lane is free.
    pub step: PerLane,
    /// 1/h; 0 where the lane is free.
    pub inverse: PerLane,
    /// h²f at the places of the last steps, the oldest first; the block's own behind them.
    pub f: [PerLane; HISTORY + BLOCK],
    /// x and hx' at the ends of the block's steps.
    pub positions: [PerLane; BLOCK],
    pub ways: [PerLane; BLOCK],
    /// The limits of the position.
    pub limits: [PerLane; 2],
    /// The extremes before the block.
    pub extremes: [PerLane; 2],
    /// The range that holds the motion in the block: between the ends of two steps it goes beyond
    /// both by less than |f| h²/8.
    pub range: [PerLane; 2],
    /// The largest correction of a position by the miss, over what is allowed.
    pub correction: PerLane,
    /// (ωh)² at the block's end over that up to which the method is stable, or more.
    pub stiffness: PerLane,
    /// The largest of each since they were set to 0.
    pub largest: [PerLane; 2],
    /// Negative or NaN where a lane has to be looked at: the step is too long, or the motion may have
    /// come to a limit or beyond its extremes.
    pub margin: PerLane,
}

impl LaneStates {
    /// All lanes rest at 1.
    pub const IDLE: LaneStates = LaneStates {
        position: [1.0; LANES],
        rate: [0.0; LANES],
        step: [0.0; LANES],
        inverse: [0.0; LANES],
        f: [[0.0; LANES]; HISTORY + BLOCK],
        positions: [[1.0; LANES]; BLOCK],
        ways: [[0.0; LANES]; BLOCK],
        limits: [[0.0; LANES], [2.0; LANES]],
        extremes: [[1.0; LANES]; 2],
        range: [[1.0; LANES]; 2],
        correction: [0.0; LANES],
        stiffness: [0.0; LANES],
        largest: [[0.0; LANES]; 2],
        margin: [0.0; LANES],
    };

    /// Takes a block of steps in each lane; `allowed` is the largest correction of a position, over the position.
    #[inline(always)]
    pub fn go<const POINTS: usize, S: Simd, V: Lanes<S, LANES>, P: Packed<V>>(
        &mut self,
        simd: S,
        packed: &mut P,
        allowed: f64,
    ) {
        let formula = &Falkner::<POINTS>::WEIGHTS;
        let fill = |value: f64| V::fill(simd, value);
        let load = |numbers: &PerLane| V::load(simd, numbers);
        let step = load(&self.step);
        let inverse = load(&self.inverse);
        let square = step * step;
        let begin = load(&self.position);
        let mut miss: V = Falkner::<POINTS>::miss(simd, &self.f[HISTORY - POINTS..]);
        // Those predicted, x and hx'.
        let mut position = begin - miss * fill(formula.miss_twice);
        let mut way = load(&self.rate) * step - miss * fill(formula.miss_once);
        let mut f = load(&self.f[HISTORY - 1]);
        // Two steps share what they load, and nothing else is done here, for which registers would be too few: 0.68 to
        // 0.8 of the time on AVX2.
        for i in (0..BLOCK).step_by(2) {
            let mut sums = [[fill(0.0); 2]; 2];
            for back in (0..POINTS).rev() {
                let f = load(&self.f[HISTORY - 1 + i - back]);
                // What depends on the last step comes last: a sum of all in turn would be waited for.
                for (sums, weight) in sums.iter_mut().zip(back..) {
                    if (1..POINTS).contains(&weight) {
                        let [twice, once] = *sums;
                        *sums = [
                            f.mul_add(fill(formula.twice[weight]), twice),
                            f.mul_add(fill(formula.once[weight]), once),
                        ];
                    }
                }
            }
            for (i, [twice, once]) in (i..).zip(sums) {
                position = f.mul_add(fill(formula.twice[0]), (position + way) + twice);
                way = f.mul_add(fill(formula.once[0]), way + once);
                packed.turn();
                f = packed.acceleration(position, way, step, inverse);
                self.f[HISTORY + i] = f.store();
                self.positions[i] = position.store();
                self.ways[i] = way.store();
            }
        }
        let (mut range, mut largest) = ([begin; 2], fill(0.0));
        for i in 0..BLOCK {
            let position = load(&self.positions[i]);
            range = [range[0].min(position), range[1].max(position)];
            largest = largest.max(load(&self.f[HISTORY + i]).abs());
        }
        let mut worst = fill(0.0);
        for end in (ESTIMATED..=BLOCK).step_by(ESTIMATED) {
            miss = Falkner::<POINTS>::miss(simd, &self.f[HISTORY + end - POINTS..]);
            worst = worst.max(miss.abs());
        }
        let position = miss.mul_add(fill(formula.miss_twice), position);
        let rate = miss.mul_add(fill(formula.miss_once), way) * inverse;
        self.position = position.store();
        self.rate = rate.store();
        let beyond = largest * fill(0.125);
        let [low, high] = [range[0] - beyond, range[1] + beyond];
        self.range = [low.store(), high.store()];
        let correction = worst * fill(formula.miss_twice / allowed) / begin.abs();
        let angle = Falkner::<POINTS>::STABLE;
        let stiffness = packed.stiffness(position) * square * fill(1.0 / (angle * angle));
        self.correction = correction.store();
        self.stiffness = stiffness.store();
        self.largest = [
            load(&self.largest[0]).max(correction).store(),
            load(&self.largest[1]).max(stiffness).store(),
        ];
        let margin = (fill(1.0) - correction)
            .min(fill(STIFFER) - stiffness)
            .min(low - load(&self.limits[0]))
            .min(load(&self.limits[1]) - high)
            .min(low - load(&self.extremes[0]))
            .min(load(&self.extremes[1]) - high);
        // NaN where the position is no number.
        self.margin = position.mul_add(fill(0.0), margin).store();
    }

    /// Takes a motion into a lane that has swung this far and may go to the limits.
    pub fn begin_with(&mut self, index: usize, extremes: Extremes, limits: Limits) {
        self.limits[0][index] = limits.lower;
        self.limits[1][index] = limits.upper;
        self.set_extremes(index, extremes);
    }

    /// Notes how far the motion of a lane has swung.
    pub fn set_extremes(&mut self, index: usize, extremes: Extremes) {
        self.extremes[0][index] = extremes.lowest;
        self.extremes[1][index] = extremes.highest;
    }

    /// How far the motion of a lane has swung.
    pub fn extremes_of(&self, index: usize) -> Extremes {
        Extremes {
            lowest: self.extremes[0][index],
            highest: self.extremes[1][index],
        }
    }

    /// Gives a lane steps of this length.
    pub fn set_step(&mut self, index: usize, step: f64) {
        self.step[index] = step;
        self.inverse[index] = 1.0 / step;
        self.largest_since(index);
    }

    /// The largest correction and stiffness of a lane since they were last asked for.
    pub fn largest_since(&mut self, index: usize) -> [f64; 2] {
        let largest = self.largest.map(|row| row[index]);
        self.largest.iter_mut().for_each(|row| row[index] = 0.0);
        largest
    }

    /// Lets a lane rest at 1.
    pub fn set_idle(&mut self, index: usize) {
        self.step[index] = 0.0;
        self.inverse[index] = 0.0;
        self.position[index] = 1.0;
        self.rate[index] = 0.0;
        self.f.iter_mut().for_each(|row| row[index] = 0.0);
    }

    /// Makes the values of f at the block's end those that the next block looks back on.
    pub fn go_on(&mut self) {
        self.f.copy_within(BLOCK.., 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first weight is that of the Adams–Bashforth formula of order 10, and polynomials up to degree 9 are
    /// integrated exactly, the correction included.
    #[test]
    fn the_weights_are_those_of_the_interpolation() {
        let formula = &Falkner::<10>::WEIGHTS;
        assert!((formula.once.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert_eq!(formula.once[0], 30_277_247.0 / 7_257_600.0);
        for degree in 0..10 {
            let f = |sigma: f64| sigma.powi(degree);
            let at = |weights: &[f64; 10]| -> f64 {
                let terms = weights.iter().enumerate();
                terms.map(|(j, weight)| weight * f(-(j as f64))).sum()
            };
            let size = 10_f64.powi(degree);
            let exact = 1.0 / f64::from(degree + 1);
            assert!((at(&formula.once) - exact).abs() < 1e-12 * size);
            // The ninth difference of σ⁹ is 9!.
            let miss = if degree == 9 { 362_880.0 } else { 0.0 };
            assert!((at(&formula.miss) - miss).abs() < 1e-12 * size);
            let twice = 1.0 / f64::from((degree + 1) * (degree + 2)) + formula.miss_once * miss;
            assert!((at(&formula.twice) - twice).abs() < 1e-12 * size);
        }
    }
}
