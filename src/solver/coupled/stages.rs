//! One step of collocation of a coupled system, with 8 or 16 nodes.
//!
//! Unknown are the slopes K_k of each first-order state and f = x'' at the nodes. Each iteration first
//! takes the slopes of the states as they are with the position held, then f:
//!
//! ```text
//! K_k ← K_k + B_k⁻¹ (z_k' − K_k),   f ← f + S⁻¹ (x'' − f)
//! ```
//!
//! Where nothing is stiff, B_k and S are 1: fixed-point (Picard) iteration, on Gauss nodes. Else they
//! are those of Newton's method (module `newton`), on Radau nodes. The slopes are solved
//! for, not the states: where a state relaxes fast, its equation would lose the digits of z'.

use fearless_simd::{Level, Simd, dispatch};

use super::newton::Newton;
use super::nodes::Nodes;
use super::polynomials::{LegendreCoefficients, TERMS};
use super::stage_values::{StageValues, series};
use super::{FullState, LocalCoupledEquation, MOST_INTEGRALS, MOST_STATES, Sizes, Stage};
use crate::solver::State;
use crate::solver::iteration::{Convergence, Diverged, IterationTolerance};
use crate::solver::step_control::StepControl;
use crate::solver::tables::{GAUSS_8, GAUSS_16, RADAU_8, RADAU_16, Rule};

/// Matrices that let an iteration shrink its change by less than this factor are made anew.
const REFRESHED: f64 = 0.4;

/// The work of all matrices, and of those of the first-order states, in iterations.
const NEWTON_WORK: u32 = 10;
const STATES_WORK: u32 = 4;

/// Least ratio of the first two changes: the first change may be that of a state that is found at once, the
/// second one of another that is not.
const UNKNOWN_RATE: f64 = 0.1;

/// The first guess bends the motion by no more than this part of its size.
const FARTHEST_GUESS: f64 = 0.5;

/// Slopes over a step by their Legendre coefficients.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slopes {
    /// Half the length of the step.
    pub half: f64,
    /// x''.
    pub motion: LegendreCoefficients,
    /// z'.
    pub internal: [LegendreCoefficients; MOST_STATES],
}

/// What is asked of all steps of a motion.
#[derive(Debug)]
pub(super) struct Demands {
    /// The number of first-order states.
    pub states: usize,
    /// The number of integrals.
    pub integrals: usize,
    /// Whether 8 nodes are to be enough.
    pub few: bool,
    /// What a step may miss.
    pub control: StepControl,
}

/// What a step is asked for.
#[derive(Debug)]
pub(super) struct Task<'a> {
    /// The state at its begin.
    pub start: &'a FullState,
    /// Its length.
    pub length: f64,
    /// What is asked of all steps.
    pub demands: &'a Demands,
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
    pub powers: [LegendreCoefficients; MOST_INTEGRALS],
    /// Number of nodes.
    pub nodes: usize,
    /// Whether they are Radau nodes.
    pub stiff: bool,
    /// Smallest and largest position at a node.
    pub range: [f64; 2],
    /// By how much an iteration shrank the change of the one before.
    pub contraction: f64,
}

impl Step {
    /// The largest error between begin and end in units of the sizes: the part of a slope after
    /// its last coefficient, once or twice integrated. On Gauss nodes the coefficients are taken to go on falling
    /// as they do up to there; on Radau nodes what follows fast is no more accurate than its last
    /// coefficient, and neither is a slope that `bends`.
    pub fn error(&self, sizes: &Sizes, integrals: usize, bends: bool) -> f64 {
        let half = self.series.half;
        let degree = 2.0 * self.nodes as f64;
        let once = half / degree;
        let motion = self.neglected(&self.series.motion, bends);
        let mut error =
            (once * motion / sizes.rate).max(once * half / degree * motion / sizes.position);
        for (series, size) in self.series.internal.iter().zip(sizes.internal) {
            if size > 0.0 {
                error = error.max(once * self.neglected(series, bends) / size);
            }
        }
        if sizes.integrals > 0.0 {
            for series in &self.powers[..integrals] {
                error = error.max(once * self.neglected(series, bends) / sizes.integrals);
            }
        }
        error
    }

    fn neglected(&self, series: &LegendreCoefficients, bends: bool) -> f64 {
        let n = self.nodes;
        let last = series[n - 1].abs() + series[n - 2].abs();
        let before = series[n - 3].abs() + series[n - 4].abs();
        if last == 0.0 || self.stiff || bends {
            return last;
        }
        // NaN where both vanish was excluded; a rising series is as large as its last terms.
        last * (last / before).min(1.0)
    }
}

/// How the stages of a step are iterated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Iteration {
    /// By fixed-point iteration on Gauss nodes.
    FixedPoint,
    /// By Newton's method for each of the first-order states, on Radau nodes.
    States,
    /// By Newton's method for everything, on Radau nodes.
    Newton,
}

/// Solves a step of a system with 8 nodes, if those are enough, or 16, and counts the iterations into `work`.
///
/// # Errors
/// [`Diverged`] where the iteration does not converge or leaves the range of the equation; a
/// shorter step will do.
#[inline(never)]
pub(super) fn solve<L: LocalCoupledEquation>(
    level: Level,
    local: &L,
    task: &Task,
    iteration: Iteration,
    work: &mut u32,
) -> Result<Step, Diverged> {
    match (iteration != Iteration::FixedPoint, task.demands.few) {
        (false, false) => solve_by::<L, 2, 16>(level, &GAUSS_16, local, task, iteration, work),
        (false, true) => solve_by::<L, 1, 8>(level, &GAUSS_8, local, task, iteration, work),
        (true, false) => solve_by::<L, 2, 16>(level, &RADAU_16, local, task, iteration, work),
        (true, true) => solve_by::<L, 1, 8>(level, &RADAU_8, local, task, iteration, work),
    }
}

/// Rows of eight nodes gain by AVX-512 also where it is not dispatched to otherwise.
fn solve_by<L: LocalCoupledEquation, const R: usize, const N: usize>(
    level: Level,
    rule: &Rule<N>,
    local: &L,
    task: &Task,
    iteration: Iteration,
    work: &mut u32,
) -> Result<Step, Diverged> {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = level.as_avx512() {
        return avx512.vectorize(
            #[inline(always)]
            || by::<_, L, R, N>(avx512, rule, local, task, iteration, work),
        );
    }
    dispatch!(level, simd => by::<_, L, R, N>(simd, rule, local, task, iteration, work))
}

#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "the states that there are")]
fn by<S: Simd, L: LocalCoupledEquation, const R: usize, const N: usize>(
    simd: S,
    rule: &Rule<N>,
    local: &L,
    task: &Task,
    iteration: Iteration,
    work: &mut u32,
) -> Result<Step, Diverged> {
    let &Task {
        start,
        length,
        demands: &Demands {
            states, integrals, ..
        },
        sizes,
        tolerance,
        before,
    } = task;
    let half = 0.5 * length;
    let fill = |value: f64| Nodes::<S, R>::fill(simd, value);
    let place: Nodes<S, R> = Nodes::load(simd, &rule.place);
    let load = local.load(place * fill(half));
    let State { position, rate } = start.motion;
    let drift = place * fill(half * rate);

    let (first_slopes, first) = local.derivatives(states, local.load(0.0), &start.stage());
    let mut internal = [StageValues::<S, R, N>::constant(simd); MOST_STATES];
    for k in 0..states {
        let series = before.map(|last| (last.half, &last.internal[k]));
        internal[k] = StageValues::guess(simd, rule, half, first_slopes[k], series);
    }
    let series_before = before.map(|last| (last.half, &last.motion));
    let mut motion = StageValues::guess(simd, rule, half, first, series_before);
    let mut bent = Nodes::product(simd, &rule.twice, &motion.slopes) * fill(half * half);
    // A guess that leads far away may look like a solution: what Newton's method makes of it hardly moves.
    let is_near = bent.largest() <= FARTHEST_GUESS * sizes.position;
    if !is_near {
        motion = StageValues::constant(simd);
        bent = fill(0.0);
    }
    let mut at = Stage {
        position: fill(position) + (drift + bent),
        rate: fill(rate) + motion.gain,
        internal: [fill(0.0); MOST_STATES],
    };
    for k in 0..states {
        at.internal[k] = fill(start.internal[k]) + internal[k].gain;
    }

    let mut convergence = Convergence::to(tolerance, UNKNOWN_RATE);
    let mut newton: Option<Newton<S, R, N>> = None;
    loop {
        *work += 1;
        let is_slow = convergence.contraction > REFRESHED;
        if iteration != Iteration::FixedPoint && (newton.is_none() || is_slow) {
            let whole = iteration == Iteration::Newton;
            let (step, equation) = ((rule, half), (local, load, states));
            let matrices = newton.get_or_insert(Newton::NONE);
            matrices.make(simd, step, equation, &at, sizes, whole)?;
            convergence.contraction = 0.0;
            *work += if whole { NEWTON_WORK } else { STATES_WORK };
        }
        let mut change = 0.0_f64;
        let geometry = local.geometry(at.position);
        for k in 0..states {
            let mut new = local.slope(k, load, &geometry, &at).value;
            if let Some(newton) = &newton {
                new = internal[k].corrected(simd, &newton.internal[k], new);
            }
            let moved = internal[k].take(simd, rule, half, new);
            change = later(change, moved / sizes.internal[k]);
            at.internal[k] = fill(start.internal[k]) + internal[k].gain;
        }
        let mut new = local.acceleration(load, &geometry, &at).value;
        let whole = newton.as_ref().and_then(|newton| newton.whole.as_ref());
        if let Some(whole) = whole {
            new = motion.corrected(simd, &whole.motion, new);
        }
        change = later(change, motion.take(simd, rule, half, new) / sizes.rate);
        let new = Nodes::product(simd, &rule.twice, &motion.slopes) * fill(half * half);
        let moved = new - bent;
        change = later(change, moved.largest() / sizes.position);
        bent = new;
        at.position = fill(position) + (drift + bent);
        at.rate = fill(rate) + motion.gain;
        if let (Some(newton), Some(whole)) = (&newton, whole) {
            for k in 0..states {
                let answer = (whole.response[k] * moved).store();
                let more = Nodes::product(simd, &newton.internal[k], &answer);
                let slopes = Nodes::load(simd, &internal[k].slopes) + more;
                let moved = internal[k].take(simd, rule, half, slopes);
                change = later(change, moved / sizes.internal[k]);
                at.internal[k] = fill(start.internal[k]) + internal[k].gain;
            }
        }

        if convergence.is_reached_by(change)? {
            break;
        }
    }

    let positions: [f64; N] = at.position.store();
    let rates: [f64; N] = at.rate.store();
    let insides: [[f64; N]; MOST_STATES] = at.internal.map(Nodes::store);
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
    let powers: [LegendreCoefficients; MOST_INTEGRALS] = std::array::from_fn(|k| {
        if k < integrals {
            series(rule, &powers[k])
        } else {
            [0.0; TERMS]
        }
    });
    let slopes = Slopes {
        half,
        motion: series(rule, &motion.slopes),
        internal: std::array::from_fn(|k| {
            if k < states {
                series(rule, &internal[k].slopes)
            } else {
                [0.0; TERMS]
            }
        }),
    };
    let [mean, first, ..] = slopes.motion;
    let end = FullState {
        motion: start.motion.after(half, [mean, first / 3.0]),
        internal: std::array::from_fn(|k| start.internal[k] + length * slopes.internal[k][0]),
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
        series: slopes,
        powers,
        nodes: N,
        stiff: iteration != Iteration::FixedPoint,
        range,
        contraction: convergence.contraction,
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
