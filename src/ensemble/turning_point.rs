//! Where a motion turns between two steps of the multistep method.

use super::multistep::{BLOCK, HISTORY, LaneStates, own, product};

/// Values of f through which the polynomial goes.
const POINTS: usize = 8;

/// Newton's iterations; the first guess is good to the second order.
const MOST_ITERATIONS: u32 = 6;

/// Row k: by the values of f at σ = 0, −1, …, the coefficient of σᵏ of the polynomial through them.
static POWERS: [[f64; POINTS]; POINTS] = powers();

/// 1/(k + 1) and 1/(k + 2).
static ONE_MORE: [f64; POINTS] = reciprocals(1);
static TWO_MORE: [f64; POINTS] = reciprocals(2);

const fn powers() -> [[f64; POINTS]; POINTS] {
    let mut table = [[0.0; POINTS]; POINTS];
    let mut j = 0;
    while j < POINTS {
        // Π (σ + i)/(i − j) over i other than j.
        let (coefficients, own) = (product(POINTS, j), own(POINTS, j));
        let mut k = 0;
        while k < POINTS {
            table[k][j] = coefficients[k] as f64 / own as f64;
            k += 1;
        }
        j += 1;
    }
    table
}

const fn reciprocals(more: usize) -> [f64; POINTS] {
    let mut reciprocals = [0.0; POINTS];
    let mut k = 0;
    while k < POINTS {
        reciprocals[k] = 1.0 / (k + more) as f64;
        k += 1;
    }
    reciprocals
}

/// The positions at which the motion of a lane turns in the block that has been taken, which
/// began at `rate`.
pub fn turns(motions: &LaneStates, lane: usize, rate: f64) -> impl Iterator<Item = f64> + '_ {
    let first = motions.step[lane] * rate;
    (0..BLOCK).filter_map(move |i| {
        let before = if i == 0 {
            first
        } else {
            motions.ways[i - 1][lane]
        };
        (before * motions.ways[i][lane] < 0.0).then(|| turn(motions, lane, i, before))
    })
}

/// The position at which the motion of a lane turns in step `i` of the block, at whose begin hx' was
/// `before`.
fn turn(motions: &LaneStates, lane: usize, i: usize, before: f64) -> f64 {
    let values: [f64; POINTS] = std::array::from_fn(|j| motions.f[i + HISTORY - j][lane]);
    let way = motions.ways[i][lane];
    let f = POWERS.each_ref().map(|row| {
        let terms = row.iter().zip(&values);
        terms.fold(0.0, |sum, (weight, value)| sum + weight * value)
    });
    // Of the integrals.
    let once: [f64; POINTS] = std::array::from_fn(|k| f[k] * ONE_MORE[k]);
    let twice: [f64; POINTS] = std::array::from_fn(|k| once[k] * TWO_MORE[k]);
    let horner = |coefficients: &[f64; POINTS], sigma: f64| {
        let terms = coefficients.iter().rev();
        terms.fold(0.0, |sum, term| sum * sigma + term)
    };
    let mut sigma = way / (before - way);
    for _ in 0..MOST_ITERATIONS {
        let change = (way + sigma * horner(&once, sigma)) / horner(&f, sigma);
        sigma -= change;
        // Squared by the next iteration, and once more in the position.
        if change.abs() < 1e-4 {
            break;
        }
    }
    // Bounded, where the motion hardly turns at all.
    let sigma = sigma.clamp(-1.0, 0.0);
    motions.positions[i][lane] + sigma * (way + sigma * horner(&twice, sigma))
}

#[cfg(test)]
mod tests {
    use super::super::LANES;
    use super::*;

    /// x = cos t, sampled every 0.1, turns at −1 between two of the samples.
    #[test]
    fn the_turn_of_a_cosine_is_found() {
        let step = 0.1;
        let mut motions = LaneStates::IDLE;
        motions.step = [step; LANES];
        motions.inverse = [1.0 / step; LANES];
        let begin = std::f64::consts::PI - 7.3 * step;
        let time = |i: usize| begin + (i + 1) as f64 * step;
        for i in 0..BLOCK {
            motions.positions[i] = [time(i).cos(); LANES];
            motions.ways[i] = [-step * time(i).sin(); LANES];
        }
        for k in 0..HISTORY + BLOCK {
            let t = begin + (k as f64 - HISTORY as f64 + 1.0) * step;
            motions.f[k] = [-step * step * t.cos(); LANES];
        }
        let found: Vec<f64> = turns(&motions, 3, -begin.sin()).collect();
        assert_eq!(found.len(), 1);
        // The polynomial misses the eighth difference of f, 1e-8, by some 1e-5 of it.
        assert!((found[0] + 1.0).abs() < 1e-12, "{}", found[0]);
    }
}
