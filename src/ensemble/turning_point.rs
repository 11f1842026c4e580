//! Where a motion turns between two steps of the multistep method.

use super::multistep::{BLOCK, LaneStates, ORDER, own, product};

/// Values of f through which the polynomial goes.
const POINTS: usize = 8;

/// Newton's iterations; the first guess is good to the second order.
const MOST_ITERATIONS: u32 = 6;

/// Row k: by the values of f at σ = 0, −1, …, the coefficient of σᵏ of the polynomial through them.
static POWERS: [[f64; POINTS]; POINTS] = powers();

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

/// The positions at which the motion of a lane turns in the block that has been taken, which
/// began at `rate`.
pub fn turns(motions: &LaneStates, lane: usize, rate: f64) -> impl Iterator<Item = f64> + '_ {
    (0..BLOCK).filter_map(move |i| {
        let before = if i == 0 {
            rate
        } else {
            motions.rates[i - 1][lane]
        };
        (before * motions.rates[i][lane] < 0.0).then(|| turn(motions, lane, i))
    })
}

/// The position at which the motion of a lane turns in step `i` of the block.
fn turn(motions: &LaneStates, lane: usize, i: usize) -> f64 {
    let step = motions.step[lane];
    let value = |j: usize| motions.f[i + ORDER - j][lane];
    let f: [f64; POINTS] = std::array::from_fn(|k| {
        let terms = POWERS[k].iter().enumerate();
        terms.map(|(j, weight)| weight * value(j)).sum()
    });
    let (position, rate) = (motions.positions[i][lane], motions.rates[i][lane]);
    let horner = |sigma: f64, weight: fn(f64) -> f64| {
        let terms = f.iter().enumerate().rev();
        terms.fold(0.0, |sum, (k, f)| sum * sigma + f * weight(k as f64))
    };
    let mut sigma = 0.0;
    for _ in 0..MOST_ITERATIONS {
        let slope = rate + step * sigma * horner(sigma, |k| 1.0 / (k + 1.0));
        let change = slope / (step * horner(sigma, |_| 1.0));
        sigma -= change;
        if change.abs() < 1e-9 {
            break;
        }
    }
    // Bounded, where the motion hardly turns at all.
    let sigma = sigma.clamp(-1.0, 0.0);
    let bend = horner(sigma, |k| 1.0 / ((k + 1.0) * (k + 2.0)));
    position + step * sigma * (rate + step * sigma * bend)
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
        let begin = std::f64::consts::PI - 7.3 * step;
        let time = |i: usize| begin + (i + 1) as f64 * step;
        for i in 0..BLOCK {
            motions.positions[i] = [time(i).cos(); LANES];
            motions.rates[i] = [-time(i).sin(); LANES];
        }
        for k in 0..ORDER + BLOCK {
            let t = begin + (k as f64 - ORDER as f64 + 1.0) * step;
            motions.f[k] = [-t.cos(); LANES];
        }
        let found: Vec<f64> = turns(&motions, 3, -begin.sin()).collect();
        assert_eq!(found.len(), 1);
        // The polynomial misses the eighth difference of f, 1e-8, by some 1e-5 of it.
        assert!((found[0] + 1.0).abs() < 1e-12, "{}", found[0]);
    }
}
