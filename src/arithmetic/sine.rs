//! The sine of angles in SIMD lanes.

use super::number::Number;

/// π in 33 bits, so that small multiples are exact, and the rest.
const PI_HIGH: f64 = 3.141_592_653_468_251_2;
const PI_LOW: f64 = 1.215_420_101_301_238_4e-10;

/// Number of terms: the next one is below 2e-18 at π/2.
const TERMS: usize = 10;

/// (−1)ᵏ/(2k+1)! for k = 1 to 10: sin r = r + r³ · Σ r²ᵏ⁻² (−1)ᵏ/(2k+1)!.
const SINE: [f64; TERMS] = {
    let mut terms = [0.0; TERMS];
    let mut factorial = 1.0;
    let mut k = 1;
    while k <= TERMS {
        factorial *= -((2 * k * (2 * k + 1)) as f64);
        terms[k - 1] = 1.0 / factorial;
        k += 1;
    }
    terms
};

/// The sine of the sum of two angles from the sine and cosine of each.
#[inline(always)]
pub fn sine_of_sum<N: Number>([sine, cosine]: [N; 2], [by_sine, by_cosine]: [N; 2]) -> N {
    by_cosine.mul_add(sine, by_sine * cosine)
}

/// Sine and cosine of the sum of two angles from those of each.
#[inline(always)]
pub fn turned([sine, cosine]: [f64; 2], [by_sine, by_cosine]: [f64; 2]) -> [f64; 2] {
    [
        sine * by_cosine + cosine * by_sine,
        cosine * by_cosine - sine * by_sine,
    ]
}

/// The sine by its Taylor series after taking out multiples of π. Exact reduction below 1e6 radians;
/// absolute error below 3e-16.
#[inline(always)]
pub fn sine<N: Number>(angle: N) -> N {
    let number = |value: f64| angle.same(value);
    let half_turns = (angle * number(std::f64::consts::FRAC_1_PI)).whole();
    let most = half_turns.mul_add(number(-PI_HIGH), angle);
    let rest = half_turns.mul_add(number(-PI_LOW), most);
    let square = rest * rest;
    // −1 for an odd number of half turns, of which 1 or −1 is left.
    let turns = (half_turns * number(0.5)).whole();
    let odd = turns.mul_add(number(-2.0), half_turns);
    let sign = (odd * odd).mul_add(number(-2.0), number(1.0));
    let turned = rest * sign;
    // By pairs of terms (Estrin): in Horner's scheme each operation depends on the last.
    let pair = |k: usize| number(SINE[k + 1]).mul_add(square, number(SINE[k]));
    let fourth = square * square;
    let eighth = fourth * fourth;
    let low = pair(2).mul_add(fourth, pair(0));
    let high = pair(6).mul_add(fourth, pair(4));
    let high = pair(8).mul_add(eighth, high);
    let sum = high.mul_add(eighth, low);
    (turned * square).mul_add(sum, turned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, SimdFrom, dispatch, f64x8};

    #[test]
    fn the_sine_of_lanes_is_that_of_single_numbers() {
        for step in 0..4000 {
            let angles: [f64; 8] =
                std::array::from_fn(|lane| -20.0 + 0.01 * f64::from(step) + 0.001 * lane as f64);
            let sine = dispatch!(Level::new(), simd => {
                <[f64; 8]>::from(Number::sin(f64x8::simd_from(simd, angles)))
            });
            for lane in 0..8 {
                let error = (sine[lane] - angles[lane].sin()).abs();
                assert!(error < 3e-16, "sin {}: {error}", angles[lane]);
            }
        }
    }
}
