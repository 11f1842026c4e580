//! One stride in each lane.

use fearless_simd::Simd;

use super::{Abreast, Fleet, LANES, Lane, Row};
use crate::solver::State;
use crate::solver::collocation::{self, Series, Substep};
use crate::solver::double::Double;
use crate::solver::lanes::Lanes;
use crate::solver::step_control::StepControl;
use crate::solver::stride::{self, PAIRS};
use crate::solver::tables::GAUSS_8;

/// Sweeps after which a lane that still moves takes a shorter stride.
const MOST_SWEEPS: u32 = 12;

/// Corrections of a position by less than this part of it are rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// A stride in each lane: what is asked for, and what came out.
#[derive(Clone, Debug)]
pub struct Round {
    position: Row,
    rate: Row,
    /// Half their lengths; 0 where none is taken.
    pub half: Row,
    /// By how much the stride is longer than the one before.
    ratio: Row,
    /// The series before by half the square of its length, by degree.
    before: [Row; 2 * PAIRS],
    settled: Row,
    expected: Row,
    end_position: Row,
    end_rate: Row,
    highest: Row,
    lowest: Row,
    contraction: Row,
    /// The series of the stride, by degree.
    series: [Row; 2 * PAIRS],
    /// The rates at its nodes, in the order of time.
    rates: [Row; 2 * PAIRS],
    /// Above 0 where the iteration has not ended.
    pub excess: Row,
}

impl Round {
    /// Nothing to do in any lane: all rest at 1.
    pub const IDLE: Round = Round {
        position: [1.0; LANES],
        rate: [0.0; LANES],
        half: [0.0; LANES],
        ratio: [0.0; LANES],
        before: [[0.0; LANES]; 2 * PAIRS],
        settled: [1.0; LANES],
        expected: [0.0; LANES],
        end_position: [1.0; LANES],
        end_rate: [0.0; LANES],
        highest: [1.0; LANES],
        lowest: [1.0; LANES],
        contraction: [0.0; LANES],
        series: [[0.0; LANES]; 2 * PAIRS],
        rates: [[0.0; LANES]; 2 * PAIRS],
        excess: [0.0; LANES],
    };

    /// Asks for the next stride of a lane, or for none.
    pub fn ask(&mut self, index: usize, lane: Option<&Lane>, end: Double, control: StepControl) {
        let Some(lane) = lane else {
            self.half[index] = 0.0;
            return;
        };
        let rest = end.since(lane.time);
        let length = stride::share(rest, lane.free);
        self.position[index] = lane.state.position;
        self.rate[index] = lane.state.rate;
        self.half[index] = 0.5 * length;
        self.settled[index] = control.settled() * lane.state.position.abs();
        self.expected[index] = (lane.contraction * length * length).min(1.0);
        let Series { half, even, odd } = lane.before;
        self.ratio[index] = 0.5 * length / half;
        let size = 1.0 / (half * half);
        for k in 0..PAIRS {
            self.before[2 * k][index] = even[k] * size;
            self.before[2 * k + 1][index] = odd[k] * size;
        }
    }

    /// How often the motion turns in the stride of a lane, and about when, since
    /// its begin, it does so the last time.
    pub fn turns(&self, index: usize, begin: f64, end: f64) -> (usize, f64) {
        let half = self.half[index];
        let place = |k: usize| match k {
            _ if k < PAIRS => half * (1.0 - GAUSS_8.node[PAIRS - 1 - k]),
            _ if k < 2 * PAIRS => half * (1.0 + GAUSS_8.node[k - PAIRS]),
            _ => 2.0 * half,
        };
        let inside = self.rates.iter().map(|row| row[index]);
        let (mut count, mut about) = (0, 0.0);
        let mut before = (0.0, begin);
        for (k, rate) in inside.chain([end]).enumerate() {
            let now = (place(k), rate);
            if now.1 * before.1 < 0.0 {
                count += 1;
                about = before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1);
            }
            before = now;
        }
        (count, about)
    }

    /// The stride of a lane.
    pub fn substep(&self, index: usize) -> Substep<PAIRS> {
        Substep {
            end: State {
                position: self.end_position[index],
                rate: self.end_rate[index],
            },
            series: Series {
                half: self.half[index],
                even: std::array::from_fn(|k| self.series[2 * k][index]),
                odd: std::array::from_fn(|k| self.series[2 * k + 1][index]),
            },
            highest: self.highest[index],
            lowest: self.lowest[index],
            contraction: self.contraction[index],
        }
    }

    /// Solves the strides: `collocation::solve` with motions in the lanes in place
    /// of nodes.
    #[inline(always)]
    pub fn solve<S: Simd, V: Lanes<S, LANES>, F: Fleet>(&mut self, simd: S, fleet: &F) {
        let round = self;
        let tables = &GAUSS_8;
        let equation = fleet.abreast::<S, V>(simd);
        let fill = |value: f64| V::fill(simd, value);
        let position = V::load(simd, &round.position);
        let rate = V::load(simd, &round.rate);
        let half = V::load(simd, &round.half);
        let ratio = V::load(simd, &round.ratio);
        let square = half * half;
        let step = half * rate;
        let middle = position + step;
        let zero = fill(0.0);

        let mut loads = [[equation.load(half); 2]; PAIRS];
        let mut f = [[zero; 2]; PAIRS];
        for i in 0..PAIRS {
            let shift = half * fill(tables.node[i]);
            loads[i] = [equation.load(half + shift), equation.load(half - shift)];
            let from = fill(1.0) + ratio;
            let reach = ratio * fill(tables.node[i]);
            f[i] = [
                continued(simd, &round.before, from + reach),
                continued(simd, &round.before, from - reach),
            ];
        }
        let settled = V::load(simd, &round.settled);
        let expected = V::load(simd, &round.expected);
        let rounding = fill(ROUNDING) * position.abs();
        let mut old = [[zero; 2]; PAIRS];
        let mut contraction = zero;
        let mut last_change = zero;
        let mut sweeps = 0;
        loop {
            sweeps += 1;
            let mut sums = [zero; PAIRS];
            let mut differences = [zero; PAIRS];
            let (mut mean, mut tilt) = (zero, zero);
            for j in 0..PAIRS {
                sums[j] = f[j][0] + f[j][1];
                differences[j] = f[j][0] - f[j][1];
                mean = sums[j].mul_add(fill(tables.mean[j]), mean);
                tilt = differences[j].mul_add(fill(tables.tilt[j]), tilt);
            }
            let mut change = zero;
            let mut highest = fill(f64::NEG_INFINITY);
            let mut lowest = fill(f64::INFINITY);
            let mut new = [[(zero, zero); 2]; PAIRS];
            for i in 0..PAIRS {
                let (mut once_odd, mut once_even) = (zero, mean);
                let (mut twice_even, mut twice_odd) = (zero - tilt, fill(tables.node[i]) * mean);
                for j in 0..PAIRS {
                    once_odd = sums[j].mul_add(fill(tables.once_from_sums[j][i]), once_odd);
                    once_even =
                        differences[j].mul_add(fill(tables.once_from_differences[j][i]), once_even);
                    twice_even = sums[j].mul_add(fill(tables.twice_from_sums[j][i]), twice_even);
                    twice_odd = differences[j]
                        .mul_add(fill(tables.twice_from_differences[j][i]), twice_odd);
                }
                let even = twice_even.mul_add(square, middle);
                let odd = twice_odd.mul_add(square, fill(tables.node[i]) * step);
                let rate_even = once_even.mul_add(half, rate);
                let rate_odd = once_odd * half;
                new[i] = [
                    (even + odd, rate_even + rate_odd),
                    (even - odd, rate_even - rate_odd),
                ];
                for side in 0..2 {
                    let place = new[i][side].0;
                    change = change.max((place - old[i][side]).abs());
                    highest = highest.max(place);
                    lowest = lowest.min(place);
                    old[i][side] = place;
                }
            }
            if sweeps > 1 {
                let observed = if sweeps == 2 {
                    expected
                } else {
                    // What is rounding shrinks no more.
                    (change - rounding).max(zero) / last_change.max(fill(f64::MIN_POSITIVE))
                };
                contraction = contraction.max(observed);
                // The error left is the change times the rate of convergence.
                let left = change * contraction - settled * (fill(1.0) - contraction);
                let excess = left.min(change - rounding);
                if excess.largest() <= 0.0 || sweeps == MOST_SWEEPS {
                    let end =
                        (mean - tilt).mul_add(fill(2.0) * square, position + fill(2.0) * step);
                    round.end_position = end.store();
                    round.end_rate = mean.mul_add(fill(2.0) * half, rate).store();
                    round.highest = highest.store();
                    round.lowest = lowest.store();
                    round.contraction = contraction.store();
                    if sweeps == 2 {
                        // A change that is nothing but rounding tells nothing of it.
                        let (change, rounding) = (change.store(), rounding.store());
                        for (index, contraction) in round.contraction.iter_mut().enumerate() {
                            if change[index] <= rounding[index] {
                                *contraction = 0.0;
                            }
                        }
                    }
                    round.excess = excess.store();
                    for (k, [right, left]) in new.into_iter().enumerate() {
                        round.rates[PAIRS + k] = right.1.store();
                        round.rates[PAIRS - 1 - k] = left.1.store();
                        let (mut even, mut odd) = (zero, zero);
                        for j in 0..PAIRS {
                            even = sums[j].mul_add(fill(tables.series_from_sums[j][k]), even);
                            odd = differences[j]
                                .mul_add(fill(tables.series_from_differences[j][k]), odd);
                        }
                        round.series[2 * k] = (even * square).store();
                        round.series[2 * k + 1] = (odd * square).store();
                    }
                    return;
                }
                if sweeps == 2 {
                    contraction = zero;
                }
            }
            last_change = change;
            for i in 0..PAIRS {
                for side in 0..2 {
                    let (place, speed) = new[i][side];
                    f[i][side] = equation.acceleration(loads[i][side], place, speed);
                }
            }
        }
    }
}

/// f of the strides before, continued to u in each lane.
#[inline(always)]
fn continued<S: Simd, V: Lanes<S, LANES>>(simd: S, series: &[Row; 2 * PAIRS], u: V) -> V {
    collocation::clenshaw::<V, PAIRS>(u, |degree| V::load(simd, &series[degree]))
}
