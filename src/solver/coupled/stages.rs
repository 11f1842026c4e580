//! One step of collocation of a coupled system, with 8 or 16 nodes.
//!
//! Each iteration first solves the first-order states one by one, with the position held, then
//! the rate, then the position. A state y with y' = s − J (y − y_last) at the nodes, s and J from
//! the last iteration, has the slopes K of the linear system
//!
//! ```text
//! (1 + h diag(J) A) K = s + J (y_last − y_begin)
//! ```
//!
//! where hA integrates from the begin of the step. The slopes are solved for, not the states:
//! where J is large, y' = s − J y would lose the digits that h J has. Where h J is small the
//! plain iteration K = s does as well.

use fearless_simd::{Level, Simd, dispatch, f64x8};
use nalgebra::{Const, DimMin, ToTypenum};

use super::polynomials::{Coefficients, TERMS};
use super::rule::{GAUSS_8, GAUSS_16, RADAU_8, RADAU_16, Rule};
use super::stage_values::{Row, StageValues, largest_change, load, product, series, store};
use super::{FullState, LocalCoupledEquation, MOST_INTEGRALS, MOST_STATES, Sizes, Slope, Stage};
use crate::solver::State;
use crate::solver::iteration::{Diverged, IterationTolerance};
use crate::solver::lanes::Lanes;

/// Slopes over a step by their Legendre coefficients.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slopes {
    /// Half the length of the step.
    pub half: f64,
    /// x''.
    pub motion: Coefficients,
    /// z'.
    pub internal: [Coefficients; MOST_STATES],
}

/// What a step is asked for.
#[derive(Debug)]
pub(super) struct Task<'a> {
    /// The state at its begin.
    pub start: &'a FullState,
    /// Its length.
    pub length: f64,
    /// The number of first-order states.
    pub states: usize,
    /// The number of integrals.
    pub integrals: usize,
    /// What errors are compared to.
    pub sizes: &'a Sizes,
    /// When the iteration ends, in units of the sizes.
    pub tolerance: IterationTolerance,
    /// The step before, where the slopes go on from it.
    pub before: Option<&'a Slopes>,
}

/// A step that has been solved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    /// The state at its end.
    pub end: FullState,
    /// The slopes over it.
    pub series: Slopes,
    /// The derivatives of the integrals.
    pub powers: [Coefficients; MOST_INTEGRALS],
    /// Number of nodes.
    pub nodes: usize,
    /// Smallest and largest position at a node.
    pub range: [f64; 2],
    /// By how much an iteration shrank the change of the one before.
    pub contraction: f64,
}

impl Step {
    /// The largest error between begin and end in units of the sizes: the part of a slope after
    /// its last coefficient, taken to go on falling as it does up to there, once or twice
    /// integrated.
    pub fn error(&self, sizes: &Sizes, integrals: usize) -> f64 {
        let half = self.series.half;
        let degree = 2.0 * self.nodes as f64;
        let once = half / degree;
        let motion = self.neglected(&self.series.motion);
        let mut error =
            (once * motion / sizes.rate).max(once * half / degree * motion / sizes.position);
        for (series, size) in self.series.internal.iter().zip(sizes.internal) {
            if size > 0.0 {
                error = error.max(once * self.neglected(series) / size);
            }
        }
        if sizes.integrals > 0.0 {
            for series in &self.powers[..integrals] {
                error = error.max(once * self.neglected(series) / sizes.integrals);
            }
        }
        error
    }

    fn neglected(&self, series: &Coefficients) -> f64 {
        let n = self.nodes;
        let last = series[n - 1].abs() + series[n - 2].abs();
        let before = series[n - 3].abs() + series[n - 4].abs();
        if last == 0.0 {
            return 0.0;
        }
        // NaN where both vanish was excluded; a rising series is as large as its last terms.
        last * (last / before).min(1.0)
    }
}

/// Solves a step of a system, with Radau nodes where it is stiff and Gauss nodes else, with 16
/// of them or 8.
///
/// # Errors
/// [`Diverged`] where the iteration does not converge or leaves the range of the equation; a
/// shorter step will do.
#[inline(never)]
pub(super) fn solve<L: LocalCoupledEquation>(
    level: Level,
    local: &L,
    task: &Task,
    [stiff, few]: [bool; 2],
) -> Result<Step, Diverged> {
    match (stiff, few) {
        (false, false) => solve_by::<L, 2, 16>(level, &GAUSS_16, local, task),
        (false, true) => solve_by::<L, 1, 8>(level, &GAUSS_8, local, task),
        (true, false) => solve_by::<L, 2, 16>(level, &RADAU_16, local, task),
        (true, true) => solve_by::<L, 1, 8>(level, &RADAU_8, local, task),
    }
}

/// Rows of eight nodes gain by AVX-512 also where it is not dispatched to otherwise.
fn solve_by<L: LocalCoupledEquation, const R: usize, const N: usize>(
    level: Level,
    rule: &Rule<N>,
    local: &L,
    task: &Task,
) -> Result<Step, Diverged>
where
    Const<N>: ToTypenum + DimMin<Const<N>, Output = Const<N>>,
{
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = level.as_avx512() {
        return avx512.vectorize(
            #[inline(always)]
            || by::<_, L, R, N>(avx512, rule, local, task),
        );
    }
    dispatch!(level, simd => by::<_, L, R, N>(simd, rule, local, task))
}

#[inline(always)]
fn by<S: Simd, L: LocalCoupledEquation, const R: usize, const N: usize>(
    simd: S,
    rule: &Rule<N>,
    local: &L,
    task: &Task,
) -> Result<Step, Diverged>
where
    Const<N>: ToTypenum + DimMin<Const<N>, Output = Const<N>>,
{
    let &Task {
        start,
        length,
        states,
        integrals,
        sizes,
        tolerance,
        before,
    } = task;
    let half = 0.5 * length;
    let fill = |value: f64| f64x8::fill(simd, value);
    let place: Row<S, R> = load(simd, &rule.place);
    let load: [L::Load<f64x8<S>>; R] = std::array::from_fn(|r| local.load(place[r] * fill(half)));
    let State { position, rate } = start.motion;
    let drift: Row<S, R> = std::array::from_fn(|r| place[r] * fill(half * rate));

    let first_stage = start.stage();
    let first_load = local.load(0.0);
    let first_slopes = local.slopes(first_load, &first_stage);
    let mut internal: [StageValues<S, R, N>; MOST_STATES] = std::array::from_fn(|k| {
        let before = before.map(|series| (series.half, &series.internal[k]));
        StageValues::guess(simd, rule, half, first_slopes[k], before)
    });
    let mut motion = StageValues::<S, R, N>::guess(
        simd,
        rule,
        half,
        local.acceleration(first_load, &first_stage),
        before.map(|series| (series.half, &series.motion)),
    );
    let bend = |slopes: &[f64; N]| -> Row<S, R> {
        product(simd, &rule.twice, slopes).map(|sum| sum * fill(half * half))
    };
    let mut bent = bend(&motion.slopes);
    let stages = |internal: &[StageValues<S, R, N>; MOST_STATES],
                  motion: &StageValues<S, R, N>,
                  bent: &Row<S, R>|
     -> [Stage<f64x8<S>>; R] {
        std::array::from_fn(|r| Stage {
            position: fill(position) + (drift[r] + bent[r]),
            rate: fill(rate) + motion.gain[r],
            internal: std::array::from_fn(|k| fill(start.internal[k]) + internal[k].gain[r]),
        })
    };

    let (mut contraction, mut last_change) = (0.0_f64, f64::NAN);
    let mut iterations = 0;
    let mut at = stages(&internal, &motion, &bent);
    loop {
        iterations += 1;
        let mut change = 0.0_f64;
        if states > 0 {
            let slopes: [[Slope<f64x8<S>>; MOST_STATES]; R] =
                std::array::from_fn(|r| local.slopes(load[r], &at[r]));
            for k in 0..states {
                let new = std::array::from_fn(|r| slopes[r][k]);
                let moved = internal[k].update(simd, rule, half, &new).ok_or(Diverged)?;
                change = later(change, moved / sizes.internal[k]);
            }
            at = stages(&internal, &motion, &bent);
        }
        let new = std::array::from_fn(|r| local.acceleration(load[r], &at[r]));
        let moved = motion.update(simd, rule, half, &new).ok_or(Diverged)?;
        let new = bend(&motion.slopes);
        change = later(change, moved / sizes.rate);
        change = later(change, largest_change(&bent, &new) / sizes.position);
        bent = new;
        at = stages(&internal, &motion, &bent);

        if iterations > 1 {
            let ratio = change / last_change;
            let expected = contraction.max(ratio);
            let done = tolerance.has_converged(iterations, change, last_change, [expected, 1.0])?;
            if iterations > 2 && !done || iterations == 2 && change > tolerance.rounding {
                contraction = expected;
            }
            if done {
                break;
            }
        }
        last_change = change;
    }

    let positions: [f64; N] = store(&std::array::from_fn::<_, R, _>(|r| at[r].position));
    let rates: [f64; N] = store(&std::array::from_fn::<_, R, _>(|r| at[r].rate));
    let insides: [[f64; N]; MOST_STATES] =
        std::array::from_fn(|k| store(&std::array::from_fn::<_, R, _>(|r| at[r].internal[k])));
    let mut powers = [[0.0; N]; MOST_INTEGRALS];
    for i in 0..N {
        let stage = Stage {
            position: positions[i],
            rate: rates[i],
            internal: std::array::from_fn(|k| insides[k][i]),
        };
        if !local.admits(&stage) {
            return Err(Diverged);
        }
        if integrals > 0 {
            let slopes = std::array::from_fn(|k| internal[k].slopes[i]);
            let power = local.powers(half * rule.place[i], &stage, &slopes);
            for k in 0..integrals {
                powers[k][i] = power[k];
            }
        }
    }
    let powers: [Coefficients; MOST_INTEGRALS] = std::array::from_fn(|k| {
        if k < integrals {
            series(simd, rule, &powers[k])
        } else {
            [0.0; TERMS]
        }
    });
    let series = Slopes {
        half,
        motion: motion.series(simd, rule),
        internal: std::array::from_fn(|k| {
            if k < states {
                internal[k].series(simd, rule)
            } else {
                [0.0; TERMS]
            }
        }),
    };
    let [mean, tilt] = [series.motion[0], series.motion[1] / 3.0];
    let end = FullState {
        motion: State {
            position: position + (length * rate + 2.0 * half * half * (mean - tilt)),
            rate: rate + length * mean,
        },
        internal: std::array::from_fn(|k| start.internal[k] + length * series.internal[k][0]),
        integrals: std::array::from_fn(|k| start.integrals[k] + length * powers[k][0]),
    };
    if !end.is_finite() || !local.admits(&end.stage()) {
        return Err(Diverged);
    }
    let range = [
        positions.iter().copied().fold(f64::INFINITY, f64::min),
        positions.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    ];
    Ok(Step {
        end,
        series,
        powers,
        nodes: N,
        range,
        contraction,
    })
}

/// The larger one; NaN stays.
#[inline(always)]
fn later(largest: f64, change: f64) -> f64 {
    if largest.is_nan() || change <= largest {
        largest
    } else {
        change
    }
}
