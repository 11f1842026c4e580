//! Where a motion turns between two steps of the multistep method.

use super::multistep::{BLOCK, HISTORY, LaneStates, own, product};
use crate::solver::State;

/// Values of f through which the polynomial goes.
const POINTS: usize = 8;

/// Newton's iterations; the first guess is good to the second order.
const MOST_ITERATIONS: u32 = 6;

/// How far the motion may go from the nearer end of a step until it turns, over the square of its way hx' over
/// h²f. It would be a half if f were constant.
const FARTHEST: f64 = 0.6;

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

/// The positions at which the motion of a lane turns in the block that has been taken, which began at
/// `state`: all those that are beyond its extremes, and perhaps some others.
pub fn turns_beyond_extremes(
    motions: &LaneStates,
    lane: usize,
    state: State,
) -> impl Iterator<Item = f64> + '_ {
    let extremes = motions.extremes_of(lane);
    let first = [state.position, motions.step[lane] * state.rate];
    (0..BLOCK).filter_map(move |i| {
        let end = |i: usize| [motions.positions[i][lane], motions.ways[i][lane]];
        let (before, after) = (if i == 0 { first } else { end(i - 1) }, end(i));
        if before[1] * after[1] >= 0.0 {
            return None;
        }
        let ([position, way], f) = if before[1].abs() < after[1].abs() {
            (before, motions.f[i + HISTORY - 1][lane])
        } else {
            (after, motions.f[i + HISTORY][lane])
        };
        let reach = FARTHEST * (way * way / f).abs();
        (position - reach < extremes.lowest || position + reach > extremes.highest)
            .then(|| turn(motions, lane, i, before[1]))
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
    use crate::solver::extremes::Extremes;

    /// x = cos t, sampled every 0.1, turns at −1 between two of the samples. It is not looked for where the
    /// motion went farther before.
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
        let state = State {
            position: begin.cos(),
            rate: -begin.sin(),
        };
        let found = |motions: &LaneStates| -> Vec<f64> {
            turns_beyond_extremes(motions, 3, state).collect()
        };
        motions.set_extremes(3, Extremes::at(1.0));
        let turns = found(&motions);
        assert_eq!(turns.len(), 1);
        // The polynomial misses the eighth difference of f, 1e-8, by some 1e-5 of it.
        assert!((turns[0] + 1.0).abs() < 1e-12, "{}", turns[0]);
        let farther = Extremes {
            lowest: -1.001,
            highest: 1.0,
        };
        motions.set_extremes(3, farther);
        assert!(found(&motions).is_empty());
    }
}
