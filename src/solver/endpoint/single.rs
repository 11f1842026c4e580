//! Endpoint-only steps over a single way, after which the equation changes: each is solved alone.
//!
//! A plan of equal steps would serve once only. What is gained by none, where the voltage changes at each
//! communication point: with plans, ways of up to three time scales take 1.3 to 2.6 times the instructions, ways of six
//! 1.05 to 1.5 times. Only ways of some twenty time scales at loose tolerances take fewer, by a fifth at 1e-6.

use fearless_simd::Level;
use serde::{Deserialize, Serialize};

use super::{End, Way};
use crate::solver::collocation::{Guess, Series, Substep, Task, solve_by_8, solve_by_16};
use crate::solver::dense_output::PAIRS as MOST_PAIRS;
use crate::solver::double::Double;
use crate::solver::iteration::Diverged;
use crate::solver::step_control::{Accepted, HALVED, SHORTEST, StepControl, first_accepted};
use crate::solver::{Equation, LocalEquation};

/// The end of a step misses less than this part of the estimate below: 16 to 26 000 times less on
/// an AC motion near resonance, 2000 times in the mean.
const NEGLECTED_WITHOUT_PLAN: f64 = 1000.0;

/// Steps that take no longer than to look for an orbit.
const FEW: f64 = 4.0;

/// By how much the contraction may be larger than in the step before.
const GROWTH: f64 = 1.2;

/// A contraction below this is rounding.
const LEAST: f64 = 1e-3;

/// What steps leave behind for the next one.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct SingleSteps {
    /// Length of the next one, where it is free.
    length: Option<f64>,
    /// Half the length of the last one and its series, even and odd, as far as it has one.
    before: Option<(f64, [f64; MOST_PAIRS], [f64; MOST_PAIRS])>,
    /// The contraction to be expected by the square of the length.
    contraction: f64,
}

impl SingleSteps {
    /// No step yet.
    pub const NONE: SingleSteps = SingleSteps {
        length: None,
        before: None,
        contraction: f64::MAX,
    };

    /// Whether the way to go is longer than a step.
    pub fn are_shorter_than(&self, rest: f64) -> bool {
        self.length.is_none_or(|length| length < rest)
    }

    /// Whether few of them reach so far.
    pub fn reach(&self, rest: f64) -> bool {
        self.length.is_none_or(|length| rest < FEW * length)
    }

    /// The equation has changed: f does not go on where it was.
    pub fn restart(&mut self) {
        self.before = None;
        self.contraction = f64::MAX;
    }

    /// Whether the numbers can be those of steps.
    pub fn are_valid(&self) -> bool {
        let positive = |number: f64| number > 0.0 && number.is_finite();
        let before = self.before.is_none_or(|(half, even, odd)| {
            positive(half) && even.iter().chain(&odd).all(|number| number.is_finite())
        });
        before && self.length.is_none_or(positive) && self.contraction >= 0.0
    }

    /// Goes the way as far as it can, with 16 nodes where that takes fewer steps.
    pub fn go<E: Equation>(
        &mut self,
        level: Level,
        equation: &E,
        control: StepControl,
        way: &mut Way,
    ) -> End {
        let local = equation.seen_from(&way.begin);
        // A single step takes longer with 16 nodes.
        let single = way.target.since(Double::ZERO) < local.time_scale(way.state);
        if control.is_loose() || single {
            self.go_by(equation, control, way, |local, task| {
                solve_by_8(level, local, task)
            })
        } else {
            self.go_by(equation, control, way, |local, task| {
                solve_by_16(level, local, task)
            })
        }
    }

    /// Either number of nodes may follow the other: both guess by Legendre series, of which one is
    /// the shorter.
    fn go_by<E: Equation, const P: usize>(
        &mut self,
        equation: &E,
        control: StepControl,
        way: &mut Way,
        method: impl Fn(&E::Local<'_>, &Task<P>) -> Result<Substep<P>, Diverged>,
    ) -> End {
        loop {
            if way.budget == 0 {
                return End::TooMany;
            }
            let rest = way.target.since(way.now);
            let local = equation.seen_from(&way.time());
            let longest = local.longest_substep();
            let few = P < MOST_PAIRS && way.now == Double::ZERO;
            if few && longest.is_finite() && longest < local.time_scale(way.state) {
                return End::Blocked;
            }
            let wanted = match self.length {
                Some(length) => length,
                None => local.time_scale(way.state),
            };
            let free = wanted.min(longest);
            // The last two share what is left.
            let last = rest < 2.0 * free;
            let length = match rest {
                _ if rest <= free => rest,
                _ if last => 0.5 * rest,
                _ => free,
            };
            let solved = self.solve(&local, control, way, [length, wanted], &method);
            let Accepted {
                step,
                length,
                factor,
            } = match solved {
                Ok(accepted) => accepted,
                Err(length) => {
                    self.length = Some(length);
                    self.restart();
                    return End::Blocked;
                }
            };
            let (lowest, highest) = way.bounds;
            let reach = step.reach();
            if !(*reach.start() > lowest && *reach.end() < highest) {
                return End::Blocked;
            }
            let Series { half, even, odd } = step.series;
            let (mut all_even, mut all_odd) = ([0.0; MOST_PAIRS], [0.0; MOST_PAIRS]);
            all_even[..P].copy_from_slice(&even);
            all_odd[..P].copy_from_slice(&odd);
            self.before = Some((half, all_even, all_odd));
            // A step that was cut short says little about the next one.
            let next = factor * length;
            if last {
                self.length = Some(next.max(wanted));
            } else {
                self.length = Some(next);
                let expected = GROWTH * step.contraction.max(LEAST);
                self.contraction = expected / (length * length);
            }
            way.state = step.end;
            if length == rest {
                way.now = way.target;
                return End::Reached;
            }
            way.now = way.now.plus(length);
        }
    }

    /// Solves one step of the given `length`, where `wanted` would do if more were asked for, or,
    /// where that is too long, a shorter one.
    fn solve<L: LocalEquation, const P: usize>(
        &mut self,
        local: &L,
        control: StepControl,
        way: &mut Way,
        [length, wanted]: [f64; 2],
        method: impl Fn(&L, &Task<P>) -> Result<Substep<P>, Diverged>,
    ) -> Result<Accepted<Substep<P>>, f64> {
        let scale = way.state.position.abs();
        let whole = length;
        first_accepted(length, SHORTEST * length, |length| {
            if length != whole {
                // What is known comes from a step that looked too far.
                self.length = Some(length);
                self.restart();
            }
            way.budget = way.budget.saturating_sub(1);
            let before = self.before.map(|(half, even, odd)| Series {
                half,
                even: std::array::from_fn(|k| even[k]),
                odd: std::array::from_fn(|k| odd[k]),
            });
            let task = Task {
                start: way.state,
                length,
                tolerance: control.iteration_tolerance(scale, length / wanted),
                guess: match &before {
                    Some(before) => Guess::Before(before),
                    None => Guess::Begin(local.acceleration_from(way.state)),
                },
                contraction: (self.contraction * length * length).min(1.0),
            };
            let step = method(local, &task).map_err(|Diverged| HALVED)?;
            let error = end_error(&step) / scale;
            let factor = control.judge_end::<P>(error, step.contraction)?;
            Ok((step, factor))
        })
    }
}

/// Estimate of the error at the end of a step. A Legendre series that falls geometrically reaches
/// at degree 4P, the first that is integrated wrongly, the square of what it has at degree 2P, by
/// its size.
#[inline(always)]
fn end_error<const P: usize>(step: &Substep<P>) -> f64 {
    let Series { even, odd, .. } = &step.series;
    let size = even[0].abs() + odd[0].abs() + even[1].abs();
    let tail = step.tail();
    // Nothing at all where f vanishes.
    tail * tail / size.max(f64::MIN_POSITIVE) / NEGLECTED_WITHOUT_PLAN
}
