//! Long steps of which only the end is asked for.
//!
//! Between communication points that lie farther apart than a substep, nothing
//! of a substep is needed but its end, which superconverges: 8 nodes reach
//! order 16 there, 16 nodes order 32. The last stride ends at the communication
//! point itself.

use fearless_simd::Level;
use serde::{Deserialize, Serialize};

use super::collocation::{Diverged, Guess, Series, Substep, Task, solve_by_8, solve_by_16};
use super::double::Double;
use super::endpoint::{End, Way};
use super::step_control::{StepControl, Verdict};
use super::{Equation, LocalEquation};

/// Node pairs of a stride at a tight one.
const MOST_PAIRS: usize = super::segment::PAIRS;

/// The end of a stride misses less than this part of the estimate below: 16 to
/// 26 000 times less on an AC motion near resonance, 2000 times in the mean.
const NEGLECTED: f64 = 1000.0;

/// A stride shorter than this part of what it was to be cannot go on.
const SHORTEST: f64 = 1e-12;

/// Strides that take no longer than to look for an orbit.
const FEW: f64 = 4.0;

/// By how much the contraction may be larger than in the stride before.
const GROWTH: f64 = 1.2;

/// A contraction below this is rounding.
const LEAST: f64 = 1e-3;

/// What strides leave behind for the next one.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Strides {
    /// Length of the next one, where it is free.
    length: Option<f64>,
    /// Half the length of the last one and its series, even and odd, as far as it has one.
    before: Option<(f64, [f64; MOST_PAIRS], [f64; MOST_PAIRS])>,
    /// The contraction to be expected by the square of the length.
    contraction: f64,
}

impl Strides {
    /// No stride yet.
    pub const NONE: Strides = Strides {
        length: None,
        before: None,
        contraction: f64::MAX,
    };

    /// Whether the way to go is longer than a stride.
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

    /// Whether the numbers can be those of strides.
    pub fn are_sound(&self) -> bool {
        let positive = |number: f64| number > 0.0 && number.is_finite();
        let before = self.before.is_none_or(|(half, even, odd)| {
            positive(half) && even.iter().chain(&odd).all(|number| number.is_finite())
        });
        before && self.length.is_none_or(positive) && self.contraction >= 0.0
    }

    /// Goes the way as far as strides of 8 nodes can.
    pub fn go<E: Equation>(
        &mut self,
        level: Level,
        equation: &E,
        control: StepControl,
        way: &mut Way,
    ) -> End {
        self.go_with(equation, control, way, |local, task| {
            solve_by_8(level, local, task)
        })
    }

    /// The same with 16 nodes. Either kind may follow the other: both guess by
    /// Legendre series, of which one is the shorter.
    pub fn go_finely<E: Equation>(
        &mut self,
        level: Level,
        equation: &E,
        control: StepControl,
        way: &mut Way,
    ) -> End {
        self.go_with(equation, control, way, |local, task| {
            solve_by_16(level, local, task)
        })
    }

    fn go_with<E: Equation, const P: usize>(
        &mut self,
        equation: &E,
        control: StepControl,
        way: &mut Way,
        method: impl Fn(&E::Local<'_>, &Task<P>) -> Result<Substep<P>, Diverged>,
    ) -> End {
        loop {
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
            let last = rest < 2.0 * free;
            let length = share(rest, free);
            let (substep, factor) =
                match self.solve(&local, control, way, [length, wanted], &method) {
                    Ok(solved) => solved,
                    Err(end) => return end,
                };
            let (lowest, highest) = way.clear;
            let reach = substep.reach();
            if !(*reach.start() > lowest && *reach.end() < highest) {
                return End::Blocked;
            }
            let Series { half, even, odd } = substep.series;
            let length = 2.0 * half;
            let (mut all_even, mut all_odd) = ([0.0; MOST_PAIRS], [0.0; MOST_PAIRS]);
            all_even[..P].copy_from_slice(&even);
            all_odd[..P].copy_from_slice(&odd);
            self.before = Some((half, all_even, all_odd));
            // A stride that was cut short says little about the next one.
            let next = factor * length;
            if last {
                self.length = Some(next.max(wanted));
            } else {
                self.length = Some(next);
                self.contraction = expected(substep.contraction) / (length * length);
            }
            way.state = substep.end;
            if length == rest {
                way.now = way.target;
                return End::Reached;
            }
            way.now = way.now.plus(length);
        }
    }

    /// Solves one stride of the given `length`, where `wanted` would do if more were
    /// asked for, or, where that is too long, a shorter one; returns by which factor the next one may be longer.
    fn solve<L: LocalEquation, const P: usize>(
        &mut self,
        local: &L,
        control: StepControl,
        way: &mut Way,
        [mut length, wanted]: [f64; 2],
        method: impl Fn(&L, &Task<P>) -> Result<Substep<P>, Diverged>,
    ) -> Result<(Substep<P>, f64), End> {
        let scale = way.state.position.abs();
        let shortest = SHORTEST * length;
        loop {
            if way.budget == 0 {
                return Err(End::TooMany);
            }
            way.budget -= 1;
            if length.is_nan() || length <= shortest {
                return Err(End::Blocked);
            }
            let before = self.before.map(|(half, even, odd)| Series {
                half,
                even: std::array::from_fn(|k| even[k]),
                odd: std::array::from_fn(|k| odd[k]),
            });
            let task = Task {
                start: way.state,
                length,
                closeness: control.closeness(scale, length / wanted),
                guess: match &before {
                    Some(before) => Guess::Before(before),
                    None => Guess::Begin(local.acceleration_from(way.state)),
                },
                contraction: (self.contraction * length * length).min(1.0),
            };
            let solved = method(local, &task);
            let factor = match solved {
                Ok(substep) => {
                    let error = end_error(&substep) / scale;
                    match control.judge_stride::<P>(error, substep.contraction) {
                        Verdict::Accept(factor) => return Ok((substep, factor)),
                        Verdict::Reject(factor) => factor,
                    }
                }
                Err(Diverged) => 0.5,
            };
            length *= factor;
            // What is known comes from a stride that looked too far.
            self.length = Some(length);
            self.restart();
        }
    }
}

/// The length of the next stride, where it may be as long as `free` and `rest` is
/// to go: the last two share what is left.
#[inline(always)]
pub fn share(rest: f64, free: f64) -> f64 {
    match rest {
        _ if rest <= free => rest,
        _ if rest < 2.0 * free => 0.5 * rest,
        _ => free,
    }
}

/// The contraction to be expected after this one.
#[inline(always)]
pub fn expected(contraction: f64) -> f64 {
    GROWTH * contraction.max(LEAST)
}

/// Estimate of the error at the end of a stride. A Legendre series that falls
/// geometrically reaches at degree 4P, the first that is integrated wrongly,
/// the square of what it has at degree 2P, by its size.
#[inline(always)]
pub fn end_error<const P: usize>(substep: &Substep<P>) -> f64 {
    let Series { even, odd, .. } = &substep.series;
    let size = even[0].abs() + odd[0].abs() + even[1].abs();
    let tail = substep.tail();
    // Nothing at all where f vanishes.
    tail * tail / size.max(f64::MIN_POSITIVE) / NEGLECTED
}
